# SPDX-License-Identifier: Apache-2.0
"""The report of scripts/fpga: build/fpga/BOARD-PLANHASH/report.json."""
from collections.abc import Sequence
from pathlib import Path
from typing import TypedDict

from flow.boards import Board
from flow.routing import Placement, constrained
from flow.shell import ROOT, Failure, read_json
from flow.synthesis import Binding, Counts


class Spread(TypedDict):
    """MHz of several seeds."""
    median: float
    low: float
    high: float


class ClockSpread(Spread):
    constraint: float


class Measured(TypedDict):
    """An entry without a placement: what was synthesized, and of which package."""
    name: str
    digest: str
    top: str
    constraint_mhz: float
    resources: Counts
    binding: Binding
    seeds: list[Placement]


class Entry(Measured, total=False):
    """A unit, or the board. fmax_mhz: of the core's clock; met: no clock's median misses its constraint; estimated: the tool's
    estimate, which neither meets nor misses anything."""
    route_speed: int
    placer: str
    clocks: dict[str, ClockSpread]
    fmax_mhz: Spread
    met: bool
    estimated: bool


class Report(TypedDict):
    board: str
    plan: str
    versions: dict[str, str]
    entries: list[Entry]


def report_folder(board: Board, plan_hash: str) -> Path:
    """Where the packages of a plan and the report of them lie."""
    return ROOT / "build" / "fpga" / f"{board.name}-{plan_hash}"


def entries_of(report_file: Path) -> list[Entry]:
    """The entries of a report; none where there is no report yet."""
    entries: list[Entry] = read_json(report_file).get("entries", []) if report_file.is_file() else []
    return entries


def median(values: Sequence[float]) -> float:
    ordered = sorted(values)
    middle = len(ordered) // 2
    return ordered[middle] if len(ordered) % 2 else (ordered[middle - 1] + ordered[middle]) / 2


def add_placements(entry: Entry, placed: list[Placement], where: Path) -> None:
    """Puts what the seeds gave into an entry. The core's clock is the one constrained to the package's; others (the SDRAM's)
    are made by the same PLL."""
    entry["seeds"], entry["clocks"] = placed, {}
    for clock, first in placed[0]["clocks"].items():
        achieved = [p["clocks"][clock]["achieved"] for p in placed]
        entry["clocks"][clock] = {"constraint": constrained(first), "median": median(achieved), "low": min(achieved),
                                  "high": max(achieved)}
    core = [c for c in entry["clocks"].values() if abs(c["constraint"] - entry["constraint_mhz"]) < 0.01]
    if not core:
        raise Failure(f"{where}: no clock is constrained to {entry['constraint_mhz']} MHz")
    slowest = min(core, key=lambda c: c["median"])
    entry["fmax_mhz"] = {"median": slowest["median"], "low": slowest["low"], "high": slowest["high"]}
    if not entry.get("estimated"):
        entry["met"] = not missed_clocks(entry)


def missed_clocks(entry: Entry) -> list[tuple[str, ClockSpread]]:
    """The clocks whose median misses what they are constrained to; an estimate does not."""
    if entry.get("estimated"):
        return []
    return [(name, c) for name, c in entry.get("clocks", {}).items() if c["median"] < c["constraint"]]
