# SPDX-License-Identifier: Apache-2.0
"""The gatherer alone, fast and narrow: cycles a gather of `make bench-rtl`, resources and clocks of the plans of fpga/fast,
and gathers a second for 1,000 LUT-equivalents. Takes the cycles from build/bench/rtl_photon_gatherer.json, synthesizes and
routes what build/fpga does not have, and writes fpga/fast.json and the table of docs/photon_gatherer.md. Exit status 1 where
a goal of fpga/goals.toml is missed. With --check it measures nothing and tells whether the page is that of the data and of today's
RTL: rows that were routed with earlier RTL are named below the table, which --render writes."""
import argparse
import hashlib
import json
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import NotRequired, TypedDict

from flow.arguments import check_names, refuse_idle, whole
from flow.boards import LUT_EQ, Board, read_board
from flow.goals import FastGoals, fast_goals
from flow.headline.netlist import digest_now, netlist_digest
from flow.package import describe, generate, lock_of
from flow.plans.catalogue import read_catalogue
from flow.results import median, report_folder
from flow.routing import DEFAULT_PLACER, PLACERS, SPARE_SEEDS, Clock, clocks_of, place, placements, routed_name
from flow.shell import ROOT, Failure, data_lock, field, locked, read_toml, say, write_json
from flow.synthesis import Counts, synthesise
from flow.tables import between, markdown, replace_between
from flow.tools import Tools, find_tools, require_same
from flow.typed_json import checked_json, require_fields, require_rows

FAST = ROOT / "fpga" / "fast"
DATA = ROOT / "fpga" / "fast.json"
PAGE = ROOT / "docs" / "photon_gatherer.md"
CYCLES = ROOT / "build" / "bench" / "rtl_photon_gatherer.json"
UNIT = "photon_gatherer"
SHOWN = (LUT_EQ, "DP16KD", "MULT18X18D")  # resources of the table
WIDTHS = ("nodes_per_cycle", "lanes", "candidates_per_cycle", "powers_per_cycle")


class Row(TypedDict):
    """A plan. digest: of its package's design. cycles: a gather, with an ideal memory and with a slow one; mhz: of each
    seed that was routed."""
    plan: str
    k: int
    widths: list[int]
    contexts: int
    digest: str
    cycles: list[float]
    resources: Counts
    mhz: list[float]


class Data(TypedDict):
    board: str
    placer: str
    versions: dict[str, str]
    rows: list[Row]


class CycleRow(TypedDict):
    """A row of throughput_photon_gatherer's JSON."""
    plan: NotRequired[str]
    memory: str
    cycles_per_gather: float


class Bench(TypedDict):
    """The JSON of throughput_photon_gatherer."""
    photon_gatherer: list[CycleRow]


def read_data() -> Data:
    data = checked_json(DATA, Data)
    for n, row in enumerate(data["rows"]):
        require_fields(row["resources"], SHOWN, int, DATA, f"rows[{n}].resources")
        if len(row["cycles"]) != 2:
            raise Failure(f"{DATA}: rows[{n}].cycles is {row['cycles']}, expected those with an ideal memory and with a slow one")
    return data


def names() -> list[str]:
    """The plans of fpga/fast, narrow ones behind the wide one of their k."""
    found = [name.removeprefix("fast/") for name in read_catalogue().derived if name.startswith("fast/")]
    return sorted(found, key=lambda name: (int(name.split("k")[-1]), name.startswith("narrow")))


def cycles_of(rows: Sequence[CycleRow], plan_hash: str, path: Path) -> list[float]:
    """Cycles a gather of a plan, ideal memory first."""
    of_plan = {row["memory"]: row["cycles_per_gather"] for row in rows if row.get("plan") == plan_hash}
    if "ideal" not in of_plan or len(of_plan) != 2:
        raise Failure(f"{path}: has no rows of plan {plan_hash} with both memories; run 'make bench-rtl'")
    return [of_plan["ideal"], *(cycles for memory, cycles in of_plan.items() if memory != "ideal")]


def routed_before(folder: Path, top: str, seed: int, placer: str) -> float | None:
    """MHz of a placement that is there and no older than its netlist."""
    report, netlist = folder / "build" / f"{routed_name(top, seed, placer, None)}.json", folder / "build" / f"{top}.json"
    if not report.is_file() or not netlist.is_file() or report.stat().st_mtime < netlist.stat().st_mtime:
        return None
    return slowest(clocks_of(report)[0])


def there(folder: Path, top: str, seed: int, placer: str) -> list[float] | None:
    """MHz of a placement that is there; none where the seed was not tried, None where nextpnr did not end: of that the log is left alone."""
    if (before := routed_before(folder, top, seed, placer)) is not None:
        return [before]
    built, routed = folder / "build", routed_name(top, seed, placer, None)
    ended = (built / f"{routed}.log").is_file() and not (built / f"{routed}.json").is_file()
    return None if ended else []


def slowest(clocks: Mapping[str, Clock]) -> float:
    return min(clock["achieved"] for clock in clocks.values())


def measure(name: str, board: Board, tools: Tools, seeds: Sequence[int], placer: str, cycle_rows: Sequence[CycleRow],
            route: bool) -> Row:
    """One plan through synthesis and each seed; what is there already is taken."""
    facts = describe(FAST / f"{name}.toml")
    folder = report_folder(board, facts["hash"]) / UNIT
    with locked(lock_of(folder)):
        return measure_in(folder, name, facts["hash"], board, tools, seeds, placer, cycle_rows, route)


def measure_in(folder: Path, name: str, plan_hash: str, board: Board, tools: Tools, seeds: Sequence[int], placer: str,
               cycle_rows: Sequence[CycleRow], route: bool) -> Row:
    path = FAST / f"{name}.toml"
    said, cycles = read_toml(path), cycles_of(cycle_rows, plan_hash, CYCLES)
    generate(path, folder, board, UNIT, versions=tools.versions)
    of_sources = netlist_digest(folder)
    top = board.top(UNIT)
    say(f"{name}: synthesis")
    counts = synthesise(folder, board, top, UNIT, tools)

    def routed(seed: int, by: str) -> float | None:
        if (before := routed_before(folder, top, seed, by)) is not None:
            return before
        placed = place(folder, top, seed, tools, placer=by)
        return slowest(placed["clocks"]) if placed else None

    if route:
        mhz = placements(name, seeds, placer, routed)
    else:
        mhz = [before for found in placements(name, seeds, placer, lambda seed, by: there(folder, top, seed, by)) for before in found]
    return {"plan": name, "k": field(said, path, "gather.k", int, "a count"),
            "widths": [field(said, path, f"gatherer.{width}", int, "a count") for width in WIDTHS],
            "contexts": field(said, path, "gatherer.contexts", int, "a count"), "digest": of_sources,
            "cycles": cycles, "resources": counts, "mhz": mhz}


def rate(row: Row) -> float | None:
    """Gathers a second for 1,000 LUT-equivalents, with an ideal memory, at the median of the seeds; None where none is routed."""
    return median(row["mhz"]) * 1e6 / row["cycles"][0] / (row["resources"][LUT_EQ] / 1000) if row["mhz"] else None


def least_rate(row: Row, rows: Sequence[Row], goals: FastGoals) -> float | None:
    """The rate that a wide plan is to reach: of the goals, or the narrow plan's; None of a narrow plan, or where that one is
    not routed."""
    if row["plan"].startswith("narrow"):
        return None
    narrow = next((rate(r) for r in rows if r["plan"] == f"narrow_k{row['k']}"), None)
    return goals.rates.get(row["k"], narrow)


def megahertz_for(row: Row, least: float) -> float:
    """The clock at which a plan reaches a rate."""
    return least * row["cycles"][0] * row["resources"][LUT_EQ] / 1e9


def fewer(row: Row, before: Row | None) -> list[str]:
    """What is lost where a row of more seeds is replaced."""
    if not before or len(row["mhz"]) >= len(before["mhz"]):
        return []
    return [f"MISSED: {len(row['mhz'])} seeds routed, {len(before['mhz'])} in the row that this one replaces"]


def verdict(row: Row, rows: Sequence[Row], goals: FastGoals) -> list[str]:
    """What a wide plan misses; empty where it reaches all of its goals or has none."""
    if row["plan"].startswith("narrow"):
        return []
    few = [f"MISSED: {len(row['mhz'])} of {goals.seeds} seeds routed"] if len(row["mhz"]) < goals.seeds else []
    return few + (missed(row, rows, goals) if row["mhz"] else [])


def missed(row: Row, rows: Sequence[Row], goals: FastGoals) -> list[str]:
    """The goals that the seeds so far miss."""
    said, k, reached = [], row["k"], rate(row)
    if median(row["mhz"]) < goals.megahertz(k):
        said.append(f"MISSED: {median(row['mhz']):.1f} MHz, goal {goals.megahertz(k):g}")
    least = least_rate(row, rows, goals)
    if least is None:
        said.append(f"narrow_k{k} is not routed")
    elif reached is not None and reached < least:
        said.append(f"MISSED: {reached:,.0f} gathers, goal {least:,.0f}")
    return said


def stale_rows(data: Data, board: Board) -> list[str]:
    """The plans of which today's RTL makes another netlist than the one that was measured."""
    return [row["plan"] for row in data["rows"] if digest_now(FAST / f"{row['plan']}.toml", board, unit=UNIT) != row["digest"]]


def take_cycles(data: Data, stale: Collection[str], cycle_rows: Sequence[CycleRow]) -> None:
    """Today's cycles into rows of today's netlists."""
    for row in data["rows"]:
        if row["plan"] in stale:
            raise Failure(f"{DATA}: {row['plan']} was measured with earlier RTL, expected scripts/fpga-fast {row['plan']} first")
        row["cycles"] = cycles_of(cycle_rows, describe(FAST / f"{row['plan']}.toml")["hash"], CYCLES)


def page(data: Data, goals: FastGoals, stale: Collection[str]) -> str:
    """The table, what it was made of, and the rows that are of earlier RTL."""
    cells = []
    for row in data["rows"]:
        mhz, reached, least = row["mhz"], rate(row), least_rate(row, data["rows"], goals)
        narrow = row["plan"].startswith("narrow")
        said = "; ".join(verdict(row, data["rows"], goals)) or ("–" if narrow else "yes")
        cells.append([f"`{row['plan']}`", ", ".join(str(w) for w in row["widths"]), row["contexts"],
                      *(f"{c:.1f}" for c in row["cycles"]),
                      f"{min(mhz):.1f}, {median(mhz):.1f} ({len(mhz)})" if mhz else "–", f"{row['resources'][LUT_EQ]:,}",
                      *(row["resources"][name] for name in SHOWN if name != LUT_EQ),
                      f"{reached:,.0f}" if reached else "–",
                      f"{least:,.0f}, from {megahertz_for(row, least):.1f} MHz" if least else "–", said])
    of = hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()[:16]
    return (markdown(cells, ["plan", "nodes, lanes, candidates, powers", "contexts", "cycles, ideal memory", "cycles, latency 60",
                             "MHz: least, median (seeds)", "LUT-eq", "DP16KD", "MULT18X18D",
                             "gathers a second for 1,000 LUT-eq", "its goal, at which clock", "goals reached"]) +
            f"\nPlaced by nextpnr's {data['placer']} placer. Where nextpnr does not end with a seed, a further one is taken, up to {SPARE_SEEDS} "
            f"of a plan{', then the default placer' if data['placer'] != DEFAULT_PLACER else ''}. "
            f"Made of `fpga/fast.json` {of}; " + "; ".join(data["versions"].values()) + ".\n" +
            (f"\nMeasured with earlier RTL: {', '.join(f'`{plan}`' for plan in stale)}; `scripts/fpga-fast NAME` measures a plan again.\n"
             if stale else ""))


def main() -> int:
    p = argparse.ArgumentParser(prog="fpga-fast", description=__doc__)
    p.add_argument("plans", nargs="*", help="measure these again; the others stay as fpga/fast.json has them")
    p.add_argument("--seeds", type=whole(1), help="placements of each (default: those of fpga/goals.toml)")
    p.add_argument("--placer", choices=PLACERS, help="as of scripts/fpga (default: static)")
    p.add_argument("--no-route", action="store_true", help="take the placements that are there, and make none")
    only = p.add_mutually_exclusive_group()
    only.add_argument("--cycles", action="store_true", help="take the cycles of build/bench anew, and what was measured of each netlist as it is")
    only.add_argument("--render", action="store_true", help="write the table from fpga/fast.json again, nothing else")
    only.add_argument("--check", action="store_true", help="tell whether docs/photon_gatherer.md is that of fpga/fast.json and of today's RTL")
    o = p.parse_args()
    goals = fast_goals()
    check_names(p, o.plans, names(), "plan")
    if o.plans and (o.check or o.render or o.cycles):
        p.error("--check, --render and --cycles are of the whole table, expected no plans")
    if o.check or o.render or o.cycles:
        refuse_idle(p, o, ("seeds", "placer", "no_route"), "--check" if o.check else "--render" if o.render else "--cycles")
    board, placer = read_board(goals.board), o.placer or "static"
    if o.check or o.render or o.cycles:
        made = read_data()
        if o.check:
            require_rows(DATA, (row["plan"] for row in made["rows"]), names(), "scripts/fpga-fast {}")
        stale = stale_rows(made, board)
        if o.cycles:
            take_cycles(made, stale, checked_json(CYCLES, Bench)["photon_gatherer"])
        text = page(made, goals, stale)  # if that fails, both stay
        if o.cycles:
            write_json(DATA, made)
        if not o.check:
            replace_between(PAGE, "fast", text)
        elif between(PAGE, "fast") != text:
            raise Failure(f"{PAGE}: is not what {DATA} and today's RTL give; scripts/fpga-fast --render writes it")
        say("docs/photon_gatherer.md is that of fpga/fast.json" +
            (f", and says that earlier RTL was measured for {', '.join(stale)}" if stale else " and of today's RTL"))
        return 0
    measured = o.plans or names()
    kept = read_data() if DATA.is_file() else None
    old = {row["plan"]: row for row in kept["rows"]} if kept else {}
    stay = [name for name in names() if name in old and name not in measured]
    if kept and stay and kept["placer"] != placer:
        p.error(f"{DATA} is of the placer {kept['placer']}, expected --placer {kept['placer']} or all plans")
    if kept and stay and kept["board"] != board.name:
        p.error(f"{DATA} is of the board {kept['board']}, expected all plans for {board.name}")
    tools = find_tools(board)
    cycle_rows = checked_json(CYCLES, Bench)["photon_gatherer"]
    seeds = range(1, 1 + (o.seeds or goals.seeds))
    if kept and stay:
        require_same(kept["versions"], tools, DATA, "scripts/fpga-fast without plans")
    new = {name: measure(name, board, tools, seeds, placer, cycle_rows, not o.no_route) for name in names() if name in measured}
    with data_lock(DATA):
        now = {row["plan"]: row for row in read_data()["rows"]} if DATA.is_file() else {}  # another command may have written it since
        rows = [new.get(name) or now[name] for name in names() if name in new or name in now]
        data: Data = {"board": board.name, "placer": placer, "versions": tools.versions, "rows": rows}
        text = page(data, goals, stale_rows(data, board))  # if that fails, both stay
        write_json(DATA, data)
        replace_between(PAGE, "fast", text)
    faults = [f"{row['plan']}: {fault}" for row in rows for fault in fewer(row, old.get(row["plan"])) + verdict(row, rows, goals)]
    for fault in faults:
        say(fault)
    return 1 if faults else 0
