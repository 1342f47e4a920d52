# SPDX-License-Identifier: Apache-2.0
"""What docs/headline.md is written from: fpga/headline.json, measurements without a verdict."""
from collections.abc import Sequence
from pathlib import Path
from typing import TypedDict

from flow.results import ClockSpread, Spread
from flow.shell import ROOT, read_json
from flow.synthesis import Binding

DATA = ROOT / "fpga" / "headline.json"


class Rate(TypedDict):
    """Queries a second of one core over so many interleaved runs; least and most None where they were not recorded."""
    least: float | None
    median: float
    most: float | None
    runs: int


class Cost(TypedDict):
    """Means of a query as golden counts them, and the cycles of a gatherer's busiest port."""
    nodes: float
    leaves: float
    insertions: float
    bound: float


class SdramLoad(TypedDict):
    """What a gather asks of the SDRAM. cycles: of the core, with row changes and refreshes. mhz: the clock simulated, that of
    its constraint or the one that was reached where that is slower."""
    lines: float
    line_bytes: int
    row_changes: float
    row_change_cycles: float
    cycles: float
    mhz: float
    reorder_gain: float
    reorder_goal: float


class Row(TypedDict):
    """A plan, without a radius or within the mean r^2 of its queries. rejected: why the plan is none of the headline's, "" where it is one.
    digest: of the netlist that was routed. clocks: None where only the core's was recorded. fits: resource of the part ->
    gatherers of this plan that it has room for. cores: library, or photonloom for golden -> its rate."""
    plan: str
    rejected: str
    memory: str
    k: int
    within_mean: bool
    gatherers: int
    replay_queries: int
    digest: str
    clock_mhz: float
    versions: list[str]
    processor: str
    seeds: list[int]
    fmax_mhz: Spread
    clocks: dict[str, ClockSpread] | None
    binding: Binding
    fits: dict[str, int]
    cycles_per_gather: float
    cost: Cost
    sdram: SdramLoad | None
    cores: dict[str, Rate]
    uart: float


class Replay(TypedDict):
    """What the replayer of a verilated board_core did."""
    plan: str
    digest: str
    queries: int
    passes: int
    cycles: int
    lines_per_gather: float


class Link(TypedDict):
    """Bits a second of the board's serial link; bytes a query down and up it."""
    baud: float
    down: float
    up: float


class Data(TypedDict):
    board: str
    rows: list[Row]
    replay: Replay | None
    link: Link


def read_data(path: Path = DATA) -> Data:
    data: Data = read_json(path)
    return data


def merge(rows: Sequence[Row], new: Sequence[Row]) -> list[Row]:
    """Rows in the order of their plans, those of newly measured plans in the place of the old."""
    measured = {row["plan"] for row in new}
    return sorted([row for row in rows if row["plan"] not in measured] + list(new),
                  key=lambda row: (row["rejected"] != "", row["plan"]))
