# SPDX-License-Identifier: Apache-2.0
"""The report of scripts/fpga: build/fpga/BOARD-PLANHASH/report.json."""
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TypedDict

from flow.boards import Board
from flow.routing import Placement, constrained
from flow.shell import ROOT, Failure
from flow.synthesis import Binding, Counts
from flow.typed_json import checked_json

BOARD_CORE = "clk"  # the core's clock behind a board's PLL


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
    estimate, which neither meets nor misses anything; unrouted: seeds with which nextpnr did not come to an end; other_placers: the
    clocks by placers that were tried too, none where nextpnr did not end."""
    route_speed: int
    placer: str
    other_placers: dict[str, dict[str, ClockSpread]]
    clocks: dict[str, ClockSpread]
    fmax_mhz: Spread
    met: bool
    estimated: bool
    unrouted: list[int]


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
    return checked_json(report_file, Report)["entries"] if report_file.is_file() else []


def median(values: Sequence[float]) -> float:
    ordered = sorted(values)
    middle = len(ordered) // 2
    return ordered[middle] if len(ordered) % 2 else (ordered[middle - 1] + ordered[middle]) / 2


def clock_name(net: str) -> str:
    """'clk_sdram' of '$glbnet$clk_sdram'."""
    return net.rsplit("$", 1)[-1]


def core_clocks(clocks: Mapping[str, ClockSpread], mhz: float) -> set[str]:
    """The nets of a core that was asked for so many MHz: those with this constraint, of which an SDRAM's may be one beside a board's."""
    same = {net for net, clock in clocks.items() if abs(clock["constraint"] - mhz) < 0.01}
    return {net for net in same if clock_name(net) == BOARD_CORE} or same


def core_clock(clocks: Mapping[str, ClockSpread], mhz: float) -> ClockSpread | None:
    """The slowest of a core's clocks."""
    core = [clocks[net] for net in core_clocks(clocks, mhz)]
    return min(core, key=lambda c: c["median"]) if core else None


def add_placements(entry: Entry, placed: list[Placement], where: Path) -> None:
    """Puts what the seeds gave into an entry. Beside a board's core there may be a clock of the SDRAM, made by the same PLL."""
    entry["seeds"], entry["clocks"] = placed, {}
    for clock, first in placed[0]["clocks"].items():
        achieved = [p["clocks"][clock]["achieved"] for p in placed]
        entry["clocks"][clock] = {"constraint": constrained(first), "median": median(achieved), "low": min(achieved),
                                  "high": max(achieved)}
    slowest = core_clock(entry["clocks"], entry["constraint_mhz"])
    if slowest is None:
        raise Failure(f"{where}: no clock is constrained to {entry['constraint_mhz']} MHz")
    entry["fmax_mhz"] = {"median": slowest["median"], "low": slowest["low"], "high": slowest["high"]}
    if not entry.get("estimated"):
        entry["met"] = not missed_clocks(entry)


def missed(clocks: Mapping[str, ClockSpread]) -> list[tuple[str, ClockSpread]]:
    """The clocks whose median misses what they are constrained to."""
    return [(name, c) for name, c in clocks.items() if c["median"] < c["constraint"]]


def missed_clocks(entry: Entry) -> list[tuple[str, ClockSpread]]:
    """The clocks of an entry that are missed; an estimate misses nothing."""
    return [] if entry.get("estimated") else missed(entry.get("clocks", {}))
