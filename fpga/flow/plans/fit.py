# SPDX-License-Identifier: Apache-2.0
"""Coefficients that predict resources from the terms of a plan, and how far off they are."""
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from operator import mul

from flow.package import UNITS
from flow.plans.catalogue import facts_of
from flow.plans.measurements import Measurement
from flow.shell import Failure

# photonloom's name of a resource -> the flow's.
RESOURCES = {"lut": "LUT-eq", "ff": "FF", "dsp": "MULT18X18D", "ebr": "DP16KD"}
Terms = Mapping[str, float]
TWIN = 0.1  # by how much of the larger one a term of two twins may differ


@dataclass(frozen=True)
class Point:
    """A resource of a plan: measured, and predicted from the plans that are not its twins."""
    plan: str
    measured: int
    predicted: float
    twins: Sequence[str] = ()


@dataclass(frozen=True)
class Fit:
    """error: relative, the largest of all points; worst: its plan."""
    coefficients: dict[str, float]
    points: list[Point]
    error: float
    worst: str


Fits = dict[str, dict[str, Fit]]  # unit -> resource


def least_squares(rows: Sequence[Terms], targets: Sequence[int]) -> dict[str, float]:
    """Coefficients that are not negative with the least sum of squared relative errors, by coordinate descent."""
    names = list(rows[0])
    scaled = [[row[n] / max(1, t) for n in names] for row, t in zip(rows, targets)]
    wanted = [1 if t > 0 else 0 for t in targets]
    norms = [sum(r[j] ** 2 for r in scaled) ** 0.5 or 1 for j in range(len(names))]
    scaled = [[x / n for x, n in zip(r, norms)] for r in scaled]
    columns = list(zip(*scaled))
    gram = [[sum(map(mul, one, other)) for other in columns] for one in columns]
    right = [sum(map(mul, column, wanted)) for column in columns]
    x = [0.0] * len(names)
    for _ in range(20000):
        moved = 0.0
        for i in range(len(names)):
            if gram[i][i] == 0:
                continue
            slope = right[i] - sum(map(mul, gram[i], x))
            new = max(0.0, x[i] + slope / (gram[i][i] + 1e-6))
            moved = max(moved, abs(new - x[i]))
            x[i] = new
        if moved < 1e-9:
            break
    return {n: value / norm for n, value, norm in zip(names, x, norms)}


def predict(coefficients: Terms, row: Terms) -> float:
    return sum(coefficients[n] * value for n, value in row.items())


def relative_error(predicted: float, measured: int) -> float:
    """Of whole numbers."""
    predicted = round(predicted)
    if measured == 0:
        return 0.0 if predicted == 0 else float("inf")
    return (predicted - measured) / measured


def are_twins(a: Mapping[str, Terms], b: Mapping[str, Terms]) -> bool:
    """Whether the prediction of a unit sees two plans as the same, or nearly so: no term of any resource differs by more than
    TWIN of the larger one. Such plans measure nearly the same, so that one of them in the fit would predict the other."""
    return all(abs(a[resource][n] - b[resource][n]) <= TWIN * max(abs(a[resource][n]), abs(b[resource][n]))
               for resource in a for n in a[resource])


def twins_of(plans: Sequence[str], terms: Mapping[str, Mapping[str, Terms]]) -> dict[str, list[str]]:
    """Plan -> its twins. terms: plan -> resource -> term -> value, of one unit."""
    return {plan: [other for other in plans if other != plan and are_twins(terms[plan], terms[other])] for plan in plans}


def fit_one(plans: Sequence[str], rows: Sequence[Terms], targets: Sequence[int], twins: Mapping[str, Sequence[str]]) -> Fit:
    """Each plan is predicted from the coefficients of all others but its twins."""
    points = []
    for out, row in enumerate(rows):
        kept = [i for i, other in enumerate(plans) if i != out and other not in twins[plans[out]]]
        if not kept:
            raise Failure(f"{plans[out]}: all other plans are its twins, expected one that differs in a term of the prediction")
        others = least_squares([rows[i] for i in kept], [targets[i] for i in kept])
        points.append(Point(plans[out], targets[out], predict(others, row), twins[plans[out]]))
    errors = [abs(relative_error(p.predicted, p.measured)) for p in points]
    return Fit(least_squares(rows, targets), points, max(errors), points[errors.index(max(errors))].plan)


def fit(measurements: Sequence[Measurement]) -> Fits:
    said = {name: facts_of(name) for name in {m["plan"] for m in measurements}}
    result: Fits = {}
    for unit in UNITS:
        of_unit = [m for m in measurements if m["unit"] == unit]
        if not of_unit:
            continue
        plans = [m["plan"] for m in of_unit]
        terms = {plan: said[plan]["resource_terms"][unit] for plan in plans}
        twins = twins_of(plans, terms)
        result[unit] = {resource: fit_one(plans, [terms[plan][resource] for plan in plans],
                                          [m["resources"][column] for m in of_unit], twins)
                        for resource, column in RESOURCES.items()}
    return result
