# SPDX-License-Identifier: Apache-2.0
"""Whether the engines that `photonloom plan SCENE --board` names are routed: the whole top of each scene's plan, and its clocks
beside what they are constrained to. Scenes and options are [planned] of fpga/goals.toml. Writes fpga/planned.json and the table
of docs/planner.md, and the plans into fpga/planned; what was routed is kept in build/planned and not made again. Exit status 1 where a
clock is missed. Where nextpnr does not end with a seed, a further one is taken. With --check it measures nothing and tells whether the
page is that of the data and of today's RTL: rows that were routed with earlier RTL are named below the table, which --render writes.
--predict plans the scenes again and writes what is predicted of the same plans today; nothing is routed."""
import argparse
import hashlib
import json
import os
import shutil
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any, NotRequired, TypedDict

from flow.arguments import LAST_SEED, check_names, folder, made_folder, refuse_idle, whole
from flow.boards import LUT_EQ, Board, read_board
from flow.goals import PlannedGoals, planned_goals
from flow.headline.netlist import SHORT, digest_now
from flow.headline.plans import HeadlinePlan
from flow.headline.tops import Routing, Top, prepare, route_seeds, synthesized
from flow.jobs import each
from flow.package import PHOTONLOOM, describe
from flow.results import clock_name
from flow.routing import PLACERS, NoEnd, Placement, constrained
from flow.shell import ROOT, Failure, data_lock, field, read_toml, said_json, say, write_json
from flow.synthesis import Counts
from flow.tables import between, markdown, replace_between
from flow.tools import find_tools, nextpnr_is_slow, require_same
from flow.typed_json import checked_json, require_fields, require_rows

DATA = ROOT / "fpga" / "planned.json"
PAGE = ROOT / "docs" / "planner.md"
PLANS = ROOT / "fpga" / "planned"  # the plans of the rows
WIDTHS = ("nodes_per_cycle", "lanes", "candidates_per_cycle", "powers_per_cycle")


class PlannedClock(TypedDict):
    """MHz."""
    name: str
    achieved: float
    constraint: float


class Planned(TypedDict):
    """A scene's engine. cycles: predicted, a gather of all gatherers; clocks: of the seed, none where nextpnr ended with no seed; unrouted:
    seeds before it with which nextpnr did not end."""
    scene: str
    plan: str
    gatherers: int
    widths: list[int]
    contexts: int
    memory: str
    beat_bits: int
    cycles: float
    digest: str
    resources: Counts
    seed: int
    clocks: list[PlannedClock]
    unrouted: NotRequired[list[int]]


class Data(TypedDict):
    board: str
    options: list[str]
    versions: dict[str, str]
    rows: list[Planned]


def read_data() -> Data | None:
    """None where nothing is routed yet."""
    if not DATA.is_file():
        return None
    data = checked_json(DATA, Data)
    for n, row in enumerate(data["rows"]):
        require_fields(row["resources"], (LUT_EQ, "DP16KD"), int, DATA, f"rows[{n}].resources")
    return data


def require_planned_alike(data: Data, goals: PlannedGoals) -> None:
    """Fails where rows that stay were planned otherwise than the goals have it, for the data name one board and its options."""
    for name, then, now in (("board", data["board"], goals.board), ("options", " ".join(data["options"]), " ".join(goals.options))):
        if then != now:
            raise Failure(f"{DATA}: {name} is {then}, expected {now}, which planned.{name} of fpga/goals.toml says; scripts/plan-boards without "
                          "scenes routes all again")


def plan_scene(scene: Path, goals: PlannedGoals, work: Path) -> tuple[HeadlinePlan, dict[str, Any]]:
    """Writes the scene's plan, and gives what photonloom says of it. Not yet beside the rows: its own is not there before it is routed."""
    path = work / "plans" / f"{scene.stem}.toml"
    path.parent.mkdir(parents=True, exist_ok=True)
    said: dict[str, Any] = said_json([PHOTONLOOM, "plan", str(scene), *goals.options, "--board", goals.board, "-o", str(path), "--json"])
    return HeadlinePlan(scene.stem, path), said


def first_to_end(top: Top, routing: Routing) -> tuple[Placement | None, list[int]]:
    """Of the first seed with which nextpnr ends, and the seeds with which it did not."""
    without_end: list[int] = []
    try:
        return route_seeds(top, routing, without_end, else_default=False)[0], without_end
    except NoEnd:
        return None, without_end


def row_of(plan: HeadlinePlan, said: dict[str, Any], top: Top, resources: Counts, placed: Placement | None, without_end: Sequence[int]) -> Planned:
    lines, path = read_toml(plan.path), plan.path

    def number(line: str) -> int:
        count: int = field(lines, path, line, int, "a count")
        return count

    clocks: list[PlannedClock] = [{"name": clock_name(net), "achieved": clock["achieved"], "constraint": constrained(clock)}
                                  for net, clock in placed["clocks"].items()] if placed else []
    *unrouted, seed = [*without_end, placed["seed"]] if placed else without_end
    row: Planned = {"scene": plan.name, "plan": said["hash"], "gatherers": number("board.gatherers"),
                    "widths": [number(f"gatherer.{width}") for width in WIDTHS], "contexts": number("gatherer.contexts"),
                    "memory": field(lines, path, "board.photon_memory", str, "a memory"), "beat_bits": number("gatherer.beat_bits"),
                    "cycles": said["engine"]["cycles"], "digest": top.digest, "resources": resources, "seed": seed, "clocks": clocks}
    if unrouted:
        row["unrouted"] = unrouted
    return row


def missed(row: Planned) -> list[str]:
    """Why a row's top is not what the plan promises."""
    if not row["clocks"]:
        return ["nextpnr does not end"]
    return [f"{c['name']} reaches {c['achieved']:.1f} MHz of {c['constraint']:g}" for c in row["clocks"] if c["achieved"] < c["constraint"]]


def core_mhz(row: Planned) -> float | None:
    """The core's clock."""
    return next((c["achieved"] for c in row["clocks"] if c["name"] == "clk"), None)


def cells(row: Planned) -> list[str]:
    clocks = ", ".join(f"{c['name']} {c['achieved']:.1f} of {c['constraint']:g}" for c in row["clocks"]) or "–"
    mhz, faults = core_mhz(row), missed(row)
    seed = str(row["seed"]) + (f"; nextpnr does not end with {', '.join(map(str, row['unrouted']))}" if "unrouted" in row else "")
    return [row["scene"], str(row["gatherers"]), ", ".join(map(str, row["widths"])), str(row["contexts"]), row["memory"], str(row["beat_bits"]),
            f"{row['cycles']:.2f}", f"{row['resources'][LUT_EQ]:,}", f"{row['resources']['DP16KD']:,}", seed, clocks,
            f"{mhz / row['cycles']:.2f}" if mhz else "–", f"`{row['digest'][:SHORT]}`", "**MISSED**: " + "; ".join(faults) if faults else "yes"]


def stale_rows(data: Data, board: Board) -> list[str]:
    """The scenes whose plan's top is another with today's RTL than the one that was routed."""
    stale = []
    for row in data["rows"]:
        plan = PLANS / f"{row['scene']}.toml"
        if (found := describe(plan)["hash"]) != row["plan"]:
            raise Failure(f"{plan}: is plan {found}, expected {row['plan']}, which {DATA.name} has of it; scripts/plan-boards writes both")
        if digest_now(plan, board) != row["digest"]:
            stale.append(row["scene"])
    return stale


def page(data: Data | None, stale: Collection[str] = ()) -> str:
    """The table, what it was made of, and the rows that are of earlier RTL."""
    if data is None:
        return "Not routed yet.\n"
    of = hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()[:SHORT]
    return ("`photonloom plan SCENE " + " ".join(data["options"]) + f" --board {data['board']}`, each whole top placed and routed:\n\n" +
            markdown([cells(row) for row in data["rows"]],
                     ["scene", "gatherers", "nodes, lanes, candidates, powers", "contexts", "photons in", "bits of a beat",
                      "cycles a gather, predicted", "LUT-eq", "DP16KD", "seed", "clocks, MHz", "M gathers a second at that clock",
                      "netlist", "routed to its clocks"]) +
            f"\nMade of `fpga/planned.json` {of}; " + "; ".join(data["versions"].values()) + ".\n" +
            (f"\nRouted with earlier RTL: {', '.join(f'`{scene}`' for scene in stale)}; `scripts/plan-boards SCENE` routes an engine again.\n"
             if stale else ""))


def merged(old: Sequence[Planned], new: Sequence[Planned], scenes: Sequence[Path]) -> list[Planned]:
    """Of each scene the newer row, in the order of the goals."""
    rows = {row["scene"]: row for row in [*old, *new]}
    return [rows[scene.stem] for scene in scenes if scene.stem in rows]


def predicted(row: Planned, said: dict[str, Any]) -> Planned:
    """The row with what is predicted of its plan today."""
    if said["hash"] != row["plan"]:
        raise Failure(f"{row['scene']}: is plan {said['hash']} today, {DATA.name} has a row of {row['plan']}; scripts/plan-boards {row['scene']} routes it")
    again = row.copy()
    again["cycles"] = said["engine"]["cycles"]
    return again


def write(data: Data, scenes: Sequence[Path], work: Path, board: Board) -> None:
    """Plans, data and page; data and page stay if the page cannot be made."""
    PLANS.mkdir(exist_ok=True)
    for scene in scenes:
        shutil.copyfile(work / "plans" / f"{scene.stem}.toml", PLANS / f"{scene.stem}.toml")
    text = page(data, stale_rows(data, board))
    write_json(DATA, data)
    replace_between(PAGE, "planned", text)


def main() -> int:
    p = argparse.ArgumentParser(prog="plan-boards", description=__doc__)
    p.add_argument("scenes", nargs="*", help="names of [planned] scenes to route; the others stay as fpga/planned.json has them (default: all)")
    p.add_argument("--seed", type=whole(1, LAST_SEED), help="of the first placement (default: 1)")
    p.add_argument("--jobs", type=whole(1), help="tops routed at a time (default: one a core; 2 GB each)")
    p.add_argument("--placer", choices=PLACERS, help="as of scripts/fpga (default: static, but heap with nextpnr 0.7)")
    p.add_argument("--results", type=folder, help="where netlists and routed seeds are kept (default: build/planned)")
    p.add_argument("--render", action="store_true", help="write the table from fpga/planned.json again, nothing else")
    p.add_argument("--predict", action="store_true", help="plan the scenes again, and write what is predicted of the same plans today; nothing is routed")
    p.add_argument("--check", action="store_true", help="tell whether docs/planner.md is that of fpga/planned.json and of today's RTL")
    o = p.parse_args()
    goals = planned_goals()
    known = {scene.stem: scene for scene in goals.scenes}
    check_names(p, o.scenes, known, "scene")
    if o.scenes and (o.check or o.render):
        p.error("--check and --render are of the whole table, expected no scenes")
    if o.check + o.render + o.predict > 1:
        p.error("expected one of --check, --render and --predict")
    if o.check or o.render or o.predict:
        refuse_idle(p, o, ("seed", "placer") + (() if o.predict else ("jobs", "results")), "--check" if o.check else "--render" if o.render else "--predict")
    jobs = o.jobs or os.cpu_count() or 1
    board = read_board(goals.board)
    if o.check or o.render:
        made = read_data()
        if made and o.check:
            require_rows(DATA, (row["scene"] for row in made["rows"]), known, "scripts/plan-boards {}")
            require_planned_alike(made, goals)
        stale = stale_rows(made, board) if made else []
        text = page(made, stale)
        if o.render:
            replace_between(PAGE, "planned", text)
        elif between(PAGE, "planned") != text:
            raise Failure(f"{PAGE}: is not what {DATA} and today's RTL give; scripts/plan-boards --render writes it")
        say("docs/planner.md is that of fpga/planned.json" +
            (f", and says that earlier RTL was routed for {', '.join(stale)}" if stale else " and of today's RTL"))
        return 0
    work = made_folder((o.results or ROOT / "build" / "planned").resolve())
    scenes = [known[name] for name in o.scenes] or list(goals.scenes)
    old = read_data()
    stay = old is not None and any(row["scene"] in known and known[row["scene"]] not in scenes for row in old["rows"])
    if old and (stay or o.predict):
        require_planned_alike(old, goals)
    if o.predict:
        rows_of = {row["scene"]: row for row in old["rows"]} if old else {}
        if missing := [scene.stem for scene in scenes if scene.stem not in rows_of]:
            raise Failure(f"{DATA}: has no row of {missing[0]}; scripts/plan-boards {missing[0]} routes it")
        assert old
        again = each(jobs, lambda scene: predicted(rows_of[scene.stem], plan_scene(scene, goals, work)[1]), scenes)
        old["rows"] = merged(old["rows"], again, goals.scenes)
        write(old, scenes, work, board)
        return 0
    tools = find_tools(board)
    slow = nextpnr_is_slow(tools.versions[board.family.nextpnr])
    routing = Routing(board, tools, 1, o.seed or 1, None, 8 if slow else 6, o.placer or ("heap" if slow else "static"), False)
    if old and stay:
        require_same(old["versions"], tools, DATA, "scripts/plan-boards without scenes")

    def one(scene: Path) -> Planned:
        plan, said = plan_scene(scene, goals, work)
        top = prepare(plan, work, routing)
        resources = synthesized(top, routing)["resources"]
        return row_of(plan, said, top, resources, *first_to_end(top, routing))

    rows = each(jobs, one, scenes)
    with data_lock(DATA):
        old = read_data()  # another command may have written it since
        data: Data = {"board": board.name, "options": list(goals.options), "versions": tools.versions,
                      "rows": merged(old["rows"] if old else [], rows, goals.scenes)}
        write(data, scenes, work, board)
    faults = [f"{row['scene']}: {fault}" for row in data["rows"] for fault in missed(row)]
    for fault in faults:
        say(fault)
    return 1 if faults else 0
