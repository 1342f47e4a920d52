# SPDX-License-Identifier: Apache-2.0
"""Counts and clocks of the units of the plans: fpga/plans.json, and what was measured before in build/fpga-plans."""
from collections.abc import Sequence
from pathlib import Path
from typing import TypedDict

from flow.package import digest, generate, lock_of
from flow.plans.catalogue import Catalogue, facts_of, plan_file
from flow.routing import place
from flow.shell import ROOT, Failure, beside, locked, read_text, say, write_json
from flow.synthesis import Counts, synthesise
from flow.tools import Tools
from flow.typed_json import checked_json, require_fields

DATA = ROOT / "fpga" / "plans.json"
WORK = ROOT / "build" / "fpga-plans"


class Synthesized(TypedDict):
    plan: str
    unit: str
    resources: Counts


class Measurement(Synthesized, total=False):
    """The slowest clock of one seed, where the plan is a scene's; placed_by: nextpnr's version."""
    fmax_mhz: float
    constraint_mhz: float
    placed_by: str


class Measurements(TypedDict):
    board: str
    versions: dict[str, str]
    measurements: list[Measurement]


class Kept(TypedDict, total=False):
    """What build/fpga-plans has of a job. key: of the package and the tools that it was measured with."""
    key: str
    resources: Counts
    fmax_mhz: float
    constraint_mhz: float
    placed_by: str


class Job(TypedDict):
    plan: str
    unit: str
    routed: bool


def jobs_of(catalogue: Catalogue, names: Sequence[str]) -> list[Job]:
    """Everything that is measured, or what belongs to the named plans."""
    jobs: list[Job] = [{"plan": name, "unit": unit, "routed": True}
                       for name in catalogue.scenes for unit in facts_of(name)["units"]]
    jobs += [{"plan": name, "unit": v.unit, "routed": False} for name, v in catalogue.variations.items()]
    return [job for job in jobs if not names or job["plan"] in names]


def read_data(catalogue: Catalogue) -> Measurements:
    data, family = checked_json(DATA, Measurements), catalogue.board.family
    require_fields(data["versions"], family.tools.values(), str, DATA, "versions")
    for n, m in enumerate(data["measurements"]):
        require_fields(m["resources"], [*family.cells, *(counted for counted, _ in family.equivalents.values())], int, DATA,
                       f"measurements[{n}].resources")
        if "fmax_mhz" in m:
            require_fields(m, ("constraint_mhz",), float, DATA, f"measurements[{n}]")
            require_fields(m, ("placed_by",), str, DATA, f"measurements[{n}]")
    return data


def check_complete(catalogue: Catalogue, data: Measurements, path: Path = DATA) -> None:
    """Fails where the measurements are not those of the catalogue's plans."""
    expected = {(job["plan"], job["unit"]) for job in jobs_of(catalogue, [])}
    measured = {(m["plan"], m["unit"]) for m in data["measurements"]}
    for plan, unit in sorted(expected - measured):
        raise Failure(f"{path}: has no {unit} of {plan}, which fpga/plans.toml asks for; scripts/fpga-plans {plan} --update measures it")
    for plan, unit in sorted(measured - expected):
        raise Failure(f"{path}: has {unit} of {plan}, which fpga/plans.toml does not ask for, expected no such measurement")


def measure(job: Job, catalogue: Catalogue, tools: Tools, route: bool) -> Measurement:
    """Counts and, where routed, Fmax of one unit of one plan; from build/fpga-plans where the sources are the same."""
    folder = WORK / f"{job['plan']}-{job['unit']}"
    with locked(lock_of(folder)):
        return measure_in(folder, job, catalogue, tools, route)


def measure_in(folder: Path, job: Job, catalogue: Catalogue, tools: Tools, route: bool) -> Measurement:
    name, unit, board = job["plan"], job["unit"], catalogue.board
    kept = beside(folder, ".json")
    package = generate(plan_file(name), folder, board, unit, versions=tools.versions)
    # Part, speed grade and options of the tools stand in the Makefile.
    key = digest(folder, {**tools.versions, "Makefile": read_text(folder / "Makefile")})
    found = checked_json(kept, Kept) if kept.is_file() else Kept()
    if found.get("key") != key:
        found = {"key": key}
    top = board.top(unit)
    if "resources" not in found:
        say(f"{name}: {unit}: synthesis")
        found["resources"] = synthesise(folder, board, top, unit, tools)
    if job["routed"] and route and "placed_by" not in found:  # an Fmax of who knows which nextpnr is none
        say(f"{name}: {unit}: placement")
        placed = place(folder, top, 1, tools)
        if placed is None:
            raise Failure(f"{folder}: the default placer does not end")
        found["fmax_mhz"] = min(c["achieved"] for c in placed["clocks"].values())
        found["constraint_mhz"] = package["clock_khz"] / 1000
        found["placed_by"] = tools.versions[board.family.nextpnr]
    write_json(kept, found, indent=None)
    result: Measurement = {"plan": name, "unit": unit, "resources": found["resources"]}
    if "placed_by" in found:
        result["fmax_mhz"], result["constraint_mhz"] = found["fmax_mhz"], found["constraint_mhz"]
        result["placed_by"] = found["placed_by"]
    return result


def merge(data: Measurements, measured: Sequence[Measurement], versions: dict[str, str]) -> None:
    """The committed measurements with those that are new in the place of theirs."""
    if data["versions"]["yosys"] != versions["yosys"]:
        raise Failure(f"{DATA} was measured with {data['versions']['yosys']}, expected that of {versions['yosys']}; "
                      "scripts/fpga-plans without plans measures all again")
    new = {(m["plan"], m["unit"]): m for m in measured}
    old = [(m["plan"], m["unit"]) for m in data["measurements"]]
    data["measurements"] = [new.get(key, m) for key, m in zip(old, data["measurements"])]
    data["measurements"] += [m for key, m in new.items() if key not in old]
    data["versions"] = versions
