# SPDX-License-Identifier: Apache-2.0
"""Whether the units grew: their size on the small plan fpga/area.toml, by synth_ecp5 of the Yosys on PATH, beside
fpga/baseline.json, which has a section for each version of Yosys. The irradiance cache is of the same plan with a cache. A unit is
mapped several times, and its size is the median: how many LUTs Yosys takes for the same netlist follows the numbers that it gives
names, and any name more moves them. Exit status 1 where a resource is more than 3 % over its baseline, 77 (skipped) where this
version has none, unless it is the version that CI runs."""
import argparse
import os
import statistics
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from flow.arguments import check_names
from flow.boards import FAMILIES
from flow.goals import area_goals
from flow.jobs import each
from flow.package import PHOTONLOOM, UNITS, describe, set_options
from flow.shell import ROOT, Failure, first_line, read_text, run, say, write_json
from flow.synthesis import Counts, counts_of
from flow.tools import yosys_version
from flow.typed_json import checked_json, require_fields, typed

PLAN = ROOT / "fpga" / "area.toml"
FAMILY = FAMILIES["ecp5"]
SKIPPED = 77


def compare(unit: str, counts: Mapping[str, int], baseline: Mapping[str, int], limit: float) -> tuple[list[str], list[str]]:
    """(grown, shrunk): a sentence for each resource that is more than `limit`, a share, from its baseline."""
    grown, shrunk = [], []
    for name in FAMILY.cells:
        now, before = counts[name], baseline[name]
        if now == before:
            continue
        change = f"{unit}: {name} {before} -> {now}" + (f" ({100 * (now - before) / before:+.1f} %)" if before else "")
        if now - before > limit * before:
            grown.append(change)
        elif before - now > limit * before:
            shrunk.append(change)
    return grown, shrunk


def measure(unit: str, yosys: str, runs: int, jobs: int) -> list[Counts]:
    """Counts of one unit on the plan, of each run; of a unit that it lacks, on the plan with an irradiance cache."""
    with tempfile.TemporaryDirectory() as folder:
        package = Path(folder, "hw")
        settings = [] if unit in describe(PLAN)["units"] else ["cache.present=true"]
        run([PHOTONLOOM, "generate", str(PLAN), *set_options(settings), "--unit", unit, "-o", str(package)])
        files = " ".join(read_text(package / "files.f").split())

        def one(names: int) -> Counts:
            (package / f"names{names}.v").write_text(names_before(names))
            said = f"stat{names}.json"
            run([yosys, "-q", "-p", f"read_verilog -sv names{names}.v {files}; synth_ecp5 -top {unit}; tee -q -o {said} stat -json"],
                cwd=package)
            return counts_of(package / said, FAMILY, unit)

        return each(jobs, one, range(runs))


def names_before(names: int) -> str:
    """A module that nothing uses, with so many names of its own, to be read before the unit: those of the unit get other numbers."""
    return "module names_before;" + "".join(f" wire name_{n};" for n in range(names)) + " endmodule\n"


def median_of(runs: Sequence[Counts]) -> Counts:
    """Of each resource by itself, the lower one of two in the middle."""
    return {name: statistics.median_low(counts[name] for counts in runs) for name in runs[0]}


def ranges_of(runs: Sequence[Counts]) -> str:
    """The median of each resource, and from where to where it went."""
    said = []
    for name, median in median_of(runs).items():
        least, most = min(counts[name] for counts in runs), max(counts[name] for counts in runs)
        said.append(f"{name} {median}" + (f" ({least} to {most})" if least != most else ""))
    return ", ".join(said)


@dataclass(frozen=True)
class Section:
    """The part of a baseline that one version of Yosys measured: plan's hash, and unit -> resource -> number."""
    path: Path
    version: str
    values: dict[str, Any]

    def check(self, units: Sequence[str], yosys: str, limit: float) -> None:
        """Tells what changed; fails where a resource grew."""
        grown = []
        for unit in units:
            if unit not in self.values:
                raise Failure(f"{self.path}: has no {unit} for Yosys {self.version}")
            where = f"{self.version}.{unit}"
            require_fields(typed(self.values[unit], Counts, self.path, where), FAMILY.cells, int, self.path, where)
            more, less = compare(unit, counted(unit, yosys), self.values[unit], limit)
            for change in less:
                say(f"shrank, scripts/area-check --update keeps it: {change}")
            for change in more:
                say(f"GREW: {change}")
            grown += more
        if grown:
            raise Failure(f"{len(grown)} resources grew by more than {100 * limit:.0f} %; make them smaller, or show "
                          "the price in the same commit with scripts/area-check --update")

    def update(self, units: Sequence[str], yosys: str, plan_hash: str) -> None:
        """Measures these units; the others stay, so all are measured of a plan that is another."""
        before, others = self.values.get("plan"), [unit for unit in UNITS if unit not in units]
        if others and before != plan_hash:
            raise Failure(f"{self.path}: was made of plan {before}, but fpga/area.toml is {plan_hash}; expected --update without "
                          f"names, for {', '.join(others)} are of the old plan too")
        self.values["plan"] = plan_hash
        for unit in units:
            counts = counted(unit, yosys)
            self.values[unit] = {name: counts[name] for name in FAMILY.cells}


def counted(unit: str, yosys: str) -> Counts:
    runs = measure(unit, yosys, area_goals().runs, len(os.sched_getaffinity(0)))
    say(f"{unit}: {ranges_of(runs)}")
    return median_of(runs)


def main() -> int:
    p = argparse.ArgumentParser(prog="area-check", description=__doc__)
    p.add_argument("units", nargs="*", help="these alone (default: " + ", ".join(UNITS) + ")")
    p.add_argument("--update", action="store_true", help="write what is measured into the baseline")
    p.add_argument("--yosys", default="yosys", help="another Yosys than the one on PATH")
    p.add_argument("--baseline", type=Path, default=ROOT / "fpga" / "baseline.json")
    o = p.parse_args()
    check_names(p, o.units, UNITS, "unit")
    goals, units = area_goals(), o.units or UNITS
    version = yosys_version(first_line([o.yosys, "-V"]))
    if not version:
        raise Failure(f"{o.yosys} does not say its version, expected Yosys")
    if os.sep in o.yosys:  # it runs in other folders too
        o.yosys = os.path.abspath(o.yosys)
    baseline = checked_json(o.baseline, dict[str, dict[str, Any]])
    plan_hash = describe(PLAN)["hash"]
    if not o.update and version not in baseline:
        known = ", ".join(baseline)
        text = f"NO BASELINE for Yosys {version} (there are {known}): nothing was compared; scripts/area-check --update writes one"
        if version == goals.ci_yosys:
            raise Failure(text)
        say(text)
        return SKIPPED
    section = Section(o.baseline, version, baseline.setdefault(version, {}))
    if not o.update:
        if section.values.get("plan") != plan_hash:
            raise Failure(f"{o.baseline}: was made of plan {section.values.get('plan')}, but fpga/area.toml is {plan_hash}; "
                          "scripts/area-check --update writes it anew")
        section.check(units, o.yosys, goals.growth)
        return 0
    section.update(units, o.yosys, plan_hash)
    write_json(o.baseline, dict(sorted(baseline.items())), indent=2)
    say(f"wrote Yosys {version} into {os.path.relpath(o.baseline, ROOT)}")
    others = [v for v in baseline if v != version]
    if others:
        say(f"the sections of Yosys {', '.join(others)} are what they were: update them too where the RTL changed")
    return 0
