# SPDX-License-Identifier: Apache-2.0
"""A plan's routed top, and the simulation of it at the clock that it reaches."""
import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from flow.boards import Board
from flow.package import describe, digest, generate
from flow.results import Entry, entries_of, report_folder
from flow.shell import ROOT, Failure, read_json, run, say, warn, write_json
from flow.tools import find_tools


@dataclass(frozen=True)
class Routing:
    """What a top is routed with if it is not yet, or `again`."""
    board: Board
    seeds: int
    clock: float | None
    route_speed: int
    placer: str
    again: bool


@dataclass(frozen=True)
class Bench:
    """work: where results, logs and what is kept lie, a plan's under its name. throughput, core: the programs that simulate
    the board and that time one core."""
    work: Path
    throughput: Path = ROOT / "build" / "verilator_tb" / "throughput" / "throughput_gather_cluster"
    core: Path = ROOT / "build" / "bench" / "bench_gather"

    def file(self, name: str, end: str) -> Path:
        return self.work / (name + end)


def routed_entry(report_file: Path) -> Entry | None:
    """The board's entry of a report, if it has been routed."""
    return next((e for e in entries_of(report_file) if e["name"] == "board" and "fmax_mhz" in e), None)


def route(plan: Path, work: Path, o: Routing) -> tuple[Entry, Path]:
    """The board's entry of the report of scripts/fpga, and its folder."""
    folder = report_folder(o.board, describe(plan)["hash"])
    report, where = folder / "report.json", folder / "board"
    found = routed_entry(report)
    if found:  # of these very sources and tools?
        generate(plan, where, o.board, None, o.clock or found["constraint_mhz"])
        if found.get("digest") != digest(where, find_tools(o.board).versions):
            found = None
    if found and not o.again:
        return found, where
    say(f"routes {plan.name}, {o.seeds} seeds")
    command = [str(ROOT / "scripts" / "fpga"), str(plan), "--board", o.board.name, "--units", "board",
               "--seeds", str(o.seeds), "--route-speed", str(o.route_speed), "--placer", o.placer]
    if o.clock:
        command += ["--clock", str(o.clock)]
    log = work / f"{plan.name}.fpga.log"
    try:
        run(command, log=log)
    except Failure:
        if not routed_entry(report):
            raise
        warn(f"{plan.name} misses a clock that it is constrained to")
    found = routed_entry(report)
    if not found:
        raise Failure(f"{report}: has no routed board (log: {log})")
    return found, where


def simulate(plan: Path, name: str, routed: Entry, bench: Bench) -> list[dict[str, Any]]:
    """The rows of throughput_gather_cluster for a plan, kept while the top, its clock and the program are the same; beside
    them, photons and queries as bench_gather reads them."""
    simulated, kept = bench.file(name, ".cycles.json"), bench.file(name, ".simulated.json")
    fmax = f"{routed['fmax_mhz']['median']:.2f}"
    key = [routed["digest"], fmax, hashlib.sha256(bench.throughput.read_bytes()).hexdigest()]
    rows: list[dict[str, Any]]
    if all(path.is_file() for path in (bench.file(name, ".photons"), bench.file(name, ".queries"), kept)):
        before = read_json(kept)
        if before["key"] == key:
            rows = before["rows"]
            return rows
    for path in (simulated, kept):
        path.unlink(missing_ok=True)
    say(f"simulates {name}")
    try:
        run([str(bench.throughput), str(plan), "--radius", "--core-mhz", fmax, "--json", str(simulated), "--dump",
             str(bench.work)], log=bench.file(name, ".cycles.log"), cwd=ROOT)
    except Failure:
        if not simulated.is_file():
            raise
        warn(f"{name}: a goal of the simulation is missed, see {name}.cycles.log")
    rows = read_json(simulated)["gather_cluster"]
    simulated.unlink()
    write_json(kept, {"key": key, "rows": rows}, indent=None)
    return rows
