# SPDX-License-Identifier: Apache-2.0
"""The plans that are measured: fpga/plans.toml, and the files that it stands for."""
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from flow.boards import Board, read_board
from flow.package import PHOTONLOOM, UNITS, PlanFacts, describe, set_options
from flow.shell import ROOT, Failure, field, read_toml, run

CATALOGUE = ROOT / "fpga" / "plans.toml"
PLANS = ROOT / "fpga" / "plans"


@dataclass(frozen=True)
class Variation:
    """A plan of fpga and lines of it that change; the unit that changes by them, "" where it is not asked."""
    base: str
    settings: Sequence[str]
    unit: str = ""


@dataclass(frozen=True)
class Catalogue:
    """scenes: name -> arguments of `photonloom plan`. derived: plans beside fpga/plans."""
    board: Board
    derived: Mapping[str, Variation]
    scenes: Mapping[str, Sequence[str]]
    variations: Mapping[str, Variation]

    def names(self) -> list[str]:
        return list(self.scenes) + list(self.variations)


def read_catalogue(path: Path = CATALOGUE) -> Catalogue:
    said = read_toml(path)

    def words(name: str) -> list[str]:
        value = field(said, path, name, list, "a list of strings")
        if not all(isinstance(word, str) for word in value):
            raise Failure(f"{path}: {name} is {value!r}, expected a list of strings")
        return list(value)

    def table(name: str) -> dict[str, Any]:
        value: dict[str, Any] = field(said, path, name, dict, "a table")
        return value

    def base(name: str) -> str:
        return str(field(said, path, f"{name}.base", str, "a plan of fpga"))

    derived = {name: Variation(base(f"derived.{name}"), words(f"derived.{name}.set")) for name in table("derived")}
    common = words("scenes.common")
    scenes = {name: words(f"scenes.plans.{name}") + common for name in table("scenes.plans")}
    variations = {}
    for unit in table("variations"):
        if unit not in UNITS:
            raise Failure(f"{path}: variations.{unit} is no unit, expected some of {', '.join(UNITS)}")
        for name, value in table(f"variations.{unit}.plans").items():
            where = f"variations.{unit}.plans.{name}"
            own = isinstance(value, dict)  # a base of its own
            variations[name] = Variation(base(where if own else f"variations.{unit}"),
                                         words(f"{where}.set" if own else where), unit)
    board = read_board(field(said, path, "board", str, "a board"))
    return Catalogue(board, derived, scenes, variations)


def plan_file(name: str) -> Path:
    return PLANS / f"{name}.toml"


def variations_of(catalogue: Catalogue) -> dict[Path, Variation]:
    """Where each plan stands that follows from another one: fpga/plans, and what make fpga, fpga-fast and area-check route."""
    return ({ROOT / "fpga" / f"{name}.toml": variation for name, variation in catalogue.derived.items()} |
            {plan_file(name): variation for name, variation in catalogue.variations.items()})


def vary(variation: Variation, path: Path) -> None:
    run([PHOTONLOOM, "plan", str(ROOT / "fpga" / f"{variation.base}.toml"), "-o", str(path)] +
        set_options(variation.settings))


def write_plans(catalogue: Catalogue) -> None:
    """Every plan of the catalogue. Those of scenes are bases too, as are variations of later ones."""
    PLANS.mkdir(exist_ok=True)
    for name, arguments in catalogue.scenes.items():
        run([PHOTONLOOM, "plan", *arguments, "-o", str(plan_file(name))], cwd=ROOT)
    for path, variation in variations_of(catalogue).items():
        path.parent.mkdir(exist_ok=True)
        vary(variation, path)


def check_plans(catalogue: Catalogue) -> None:
    """Fails at a plan that is not what fpga/plans.toml makes of its base. Those of scenes are left out: they take their photons."""
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder, "plan.toml")
        for path, variation in variations_of(catalogue).items():
            vary(variation, made)
            if describe(made)["hash"] != describe(path)["hash"]:
                raise Failure(f"{path.relative_to(ROOT)} is not what fpga/plans.toml makes of fpga/{variation.base}.toml; "
                              "mend the one that is wrong; scripts/fpga-plans --plans-only writes the plans")


def facts_of(name: str) -> PlanFacts:
    """What photonloom says of a plan: its units and the terms of the prediction."""
    return describe(plan_file(name))


def line_of(name: str, line: str) -> Any:
    """A line of a plan, such as gather.k."""
    path = plan_file(name)
    return field(read_toml(path), path, line, (str, int, float), "a value")
