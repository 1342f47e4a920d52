# SPDX-License-Identifier: Apache-2.0
"""What docs/headline.md is written from: fpga/headline.json, measurements without a verdict. What an earlier form of the file
does not have is None."""
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NotRequired, TypedDict

from flow.results import ClockSpread, Spread
from flow.shell import ROOT, Failure
from flow.synthesis import Binding
from flow.typed_json import checked_json, typed

DATA = ROOT / "fpga" / "headline.json"
GOLDEN = "photonloom"


class Rate(TypedDict):
    """Queries a second of one core over so many interleaved runs; least and most None where they were not recorded."""
    least: float | None
    median: float
    most: float | None
    runs: int


class Cores(TypedDict):
    """Queries a second of golden with all threads that the program may run, by the clock on the wall, in turn with one core's
    runs. share: of what the threads could have had of the cores, what they got: less than 1 where other programs ran."""
    threads: int
    share: float
    rate: Rate


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


class Coarse(TypedDict):
    """Of a row in coarser formats: the plan of the headline that it is coarser than, and of both the bytes of a photon in a line
    and the relMSE of golden arithmetic against reference arithmetic, in that plan's frame of the headline's scene."""
    finer: str
    photon_bytes: int
    relmse: float
    finer_bytes: int
    finer_relmse: float


class Row(TypedDict):
    """A plan, without a radius or within the mean r^2 of its queries. rejected: why the plan is none of the headline's, "" where
    it is one, or the user's. shows: what a variant shows, which has no goal of its own, else "". coarse: of one in coarser formats, judged beside
    the one that it is coarser than. leaf_limit: leaves that a query visits at most, 0 where the search is exact. recall: part of
    the exact k nearest that golden finds, as the libraries found them. lut_eq: LUT-equivalents of the whole top. all_cores: golden
    on the whole machine. digest: of the netlist that was routed. unrouted: seeds with which nextpnr did not come to an end. clocks:
    None where only the core's was recorded. fits: resource of the part -> gatherers of this plan that it has room for. ports_cycles:
    of the core, in which the ports of a photon memory in block RAM move a gather's lines; None before an SDRAM, and where it was not
    recorded. cores: library, or photonloom for golden -> its rate."""
    plan: str
    rejected: str
    shows: str
    coarse: Coarse | None
    leaf_limit: int | None
    recall: float | None
    lut_eq: int | None
    all_cores: Cores | None
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
    unrouted: NotRequired[list[int]]
    fmax_mhz: Spread
    clocks: dict[str, ClockSpread] | None
    binding: Binding
    fits: dict[str, int]
    cycles_per_gather: float
    cost: Cost
    ports_cycles: float | None
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


class Seconds(TypedDict):
    """Of several runs."""
    least: float
    median: float
    most: float


class FrameTime(TypedDict):
    """A frame by golden. frame: all of it but the image's file; gathers: in the gatherer and the reorder buffer; host: the
    rest. Of one thread CPU seconds, of several seconds of the clock on the wall."""
    threads: int
    runs: int
    frame: Seconds
    gathers: Seconds
    host: Seconds


class ImageTime(TypedDict):
    """A whole image of a scene in the formats of a plan of fpga/headline. queries: of the gatherer. busy: wall over CPU
    seconds of the frames of one thread, 1 on a machine that does nothing else."""
    scene: str
    plan: str
    processor: str
    width: int
    height: int
    spp: int
    gather_rays: int
    photons: int
    caustic_photons: int
    k: int
    queries: int
    busy: float
    one: FrameTime
    all: FrameTime


class Data(TypedDict):
    board: str
    rows: list[Row]
    replay: Replay | None
    images: list[ImageTime]
    link: Link


class Rows(TypedDict):
    """A file of any form."""
    rows: list[dict[str, Any]]


# What rows and files of earlier forms do not have.
NO_ROW: dict[str, Any] = {"shows": "", "coarse": None, "leaf_limit": None, "recall": None, "lut_eq": None, "all_cores": None,
                          "ports_cycles": None}
NO_FILE: dict[str, Any] = {"replay": None, "images": []}


def read_data(path: Path = DATA) -> Data:
    said = checked_json(path, Rows)
    data = typed({**NO_FILE, **said, "rows": [{**NO_ROW, **row} for row in said["rows"]]}, Data, path)
    for n, row in enumerate(data["rows"]):
        if GOLDEN not in row["cores"] or len(row["cores"]) < 2:
            raise Failure(f"{path}: rows[{n}].cores has {', '.join(row['cores']) or 'nothing'}, expected {GOLDEN} and a library")
    return data


def merge(rows: Sequence[Row], new: Sequence[Row]) -> list[Row]:
    """Rows in the order of their plans, those of newly measured plans in the place of the old."""
    measured = {row["plan"] for row in new}
    return sorted([row for row in rows if row["plan"] not in measured] + list(new),
                  key=lambda row: (row["rejected"] != "", row["shows"] != "", row["coarse"] is not None, row["plan"]))


def of_headline(row: Row) -> bool:
    """Neither rejected nor a variant nor in coarser formats: judged by a multiple of one core."""
    return not row["rejected"] and not row["shows"] and not row["coarse"]
