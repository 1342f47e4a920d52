# SPDX-License-Identifier: Apache-2.0
"""Gathers a second of a board beside one core of this machine, for the plans of fpga/headline.

Queries a second = routed Fmax of the board's whole top (median of the seeds) / cycles per gather, simulated with all its
gatherers at work on the shared photon memory, fill and drain included. The core: the best of nanoflann, FLANN and CGAL, and
the golden gather, on the same quantised photons and queries in the same order, timed in this run, golden on all cores too;
without a radius and within the mean r^2 of the queries. Whole images by golden, on one core and on all, end the page.

Routed seeds and simulations are kept in build/headline by what they were made from, and are not made again; a run that was
ended goes on where it was. Writes report.json there; with --page fpga/headline.json and docs/headline.md, which --render
writes from it again and --check compares with it and with today's RTL. Exit status 1 where a row misses its multiple of one
core or a clock, its share of its own bound or what it was to gain, or where reordering gains too little; but for rejected plans. With --route-only
1 where nextpnr does not end with a seed."""
import argparse
import hashlib
import json
import os
import tempfile
from collections.abc import Sequence
from pathlib import Path

from flow.arguments import LAST_SEED, folder, made_folder, megahertz, refuse_idle, whole
from flow.boards import read_board
from flow.goals import HEADLINE, HeadlineGoals, headline_goals, headline_names
from flow.headline.data import DATA, Data, ImageTime, Link, Replay, Row, merge, of_headline, read_data
from flow.headline.images import time_images
from flow.headline.netlist import SHORT, plan_digest
from flow.headline.page import check_page, images_of, page_texts, report, stale_plans, summary, write_page
from flow.headline.plans import HeadlinePlan, check_plan_names, check_variants, find_plan, find_plans, known_names
from flow.headline.replay import BOARD_SIM, replay
from flow.headline.rows import coarse_of, gatherers_that_fit, rows_of
from flow.headline.simulation import Bench, Simulated, scene_sha256, sha256, simulate, time_core
from flow.headline.tables import radius_of
from flow.headline.tops import Routing, Top, prepare, route, route_seed
from flow.headline.verdict import judge, judge_coarse, judge_gain
from flow.jobs import each
from flow.package import PHOTONLOOM, describe
from flow.results import Entry
from flow.routing import PLACERS
from flow.shell import ROOT, Failure, data_lock, field, read_text, read_toml, say, warn, write_json
from flow.tools import find_tools, nextpnr_is_slow
from flow.typed_json import checked_json, require_rows


def processor(path: Path = Path("/proc/cpuinfo")) -> str:
    """The exact model: its name, and the numbers that tell it from others of that name."""
    lines = [line.split(":", 1) for line in read_text(path).split("\n\n")[0].splitlines() if ":" in line]
    said = {name.strip(): value.strip() for name, value in lines}
    numbers = ", ".join(f"{name.removeprefix('cpu ')} {said[name]}" for name in ("cpu family", "model", "stepping", "microcode")
                        if name in said)
    return said.get("model name", "unknown") + (f" ({numbers})" if numbers else "")


def options() -> argparse.Namespace:
    p = argparse.ArgumentParser(prog="headline", description=__doc__)
    p.add_argument("plans", nargs="*", help="names of fpga/headline or fpga/headline.toml, or files (default: all of fpga/headline)")
    p.add_argument("--seeds", type=whole(1), help="placements of each top (default: 3; a top took 10 to 40 minutes)")
    p.add_argument("--first-seed", type=whole(0, LAST_SEED), help="number of the first one (default: 1)")
    p.add_argument("--jobs", type=whole(1), help="tops routed, then simulated, at a time (default: one a core; 2 GB each)")
    p.add_argument("--clock", type=megahertz, help="MHz of the core to route to, if not what fpga/headline.toml has for the plan, or the board's default; not with --page")
    p.add_argument("--route-speed", type=int, choices=(6, 7, 8),
                   help="as of scripts/fpga (default: 6, but 8 with nextpnr 0.7, which did not end at 6)")
    p.add_argument("--placer", choices=PLACERS, help="as of scripts/fpga (default: static, but heap with nextpnr 0.7)")
    p.add_argument("--route-again", action="store_true", help="route even what is kept")
    p.add_argument("--results", type=folder,
                   help="where results are kept (default: build/headline); such folders can be copied together")
    only = p.add_mutually_exclusive_group()
    only.add_argument("--route-only", action="store_true", help="route the seeds, and leave the rest to a later run")
    only.add_argument("--replay-only", action="store_true", help="replay on the simulated board alone; with --page onto the page")
    only.add_argument("--images-only", action="store_true", help="time whole images by golden alone; with --page onto the page")
    p.add_argument("--page", action="store_true", help="put the rows into fpga/headline.json and docs/headline.md too")
    only.add_argument("--render", action="store_true", help="write docs/headline.md from fpga/headline.json, and into that what photonloom predicts of its plans today; nothing else")
    p.add_argument("--dry-run", action="store_true", help="only tell whether the arguments are right; needs no tools")
    only.add_argument("--check", action="store_true", help="tell whether docs/headline.md is that of fpga/headline.json and of today's RTL")
    o = p.parse_args()
    if nothing_routed := next((f"--{name.replace('_', '-')}" for name in ("replay_only", "images_only", "render", "check") if getattr(o, name)), None):
        refuse_idle(p, o, ("seeds", "first_seed", "jobs", "route_speed", "placer", "route_again", "clock") +
                    (("results",) if o.images_only else ()), nothing_routed)
    o.seeds, o.jobs = o.seeds or 3, o.jobs or os.cpu_count()
    o.first_seed = 1 if o.first_seed is None else o.first_seed
    if o.first_seed + o.seeds - 1 > LAST_SEED:
        p.error(f"--first-seed, --seeds: the last one is {o.first_seed + o.seeds - 1}, expected at most {LAST_SEED}")
    check_variants()
    check_plan_names(o.plans)
    of_no_plan = {"--replay-only": o.replay_only, "--images-only": o.images_only, "--render": o.render, "--check": o.check}
    if o.plans and (option := next((name for name, asked in of_no_plan.items() if asked), None)):
        p.error(f"{option} is of the whole page, expected no plans")
    if o.page and (o.route_only or o.render or o.check):
        p.error("--page is of what is measured, expected none of --route-only, --render, --check")
    if o.page and o.clock:
        p.error("--page: --clock is of a single run, expected the clock of a plan of the page in [clock] of fpga/headline.toml")
    for path in (Path(name) for name in o.plans if name not in known_names()):
        check_own_plan(p, path, o.page)
    return o


def check_own_plan(p: argparse.ArgumentParser, path: Path, page: bool) -> None:
    """What would fail after hours of routing."""
    if path.resolve().parent != HEADLINE:
        if page:
            p.error(f"--page: {path} is a plan of its own, which --check would not find again, expected plans of fpga/headline or "
                    "fpga/headline.toml")
        if path.stem in known_names():
            p.error(f"{path}: {path.stem} is a plan of the page, expected a name of its own")
    goals = headline_goals()
    try:
        said = read_toml(path)
        memory, k = field(said, path, "board.photon_memory", str, "a memory"), field(said, path, "gather.k", int, "a count")
    except Failure as failure:
        p.error(str(failure))
    try:
        goals.times_core(memory, k)
    except Failure as failure:
        p.error(f"{path}: {failure}")


def routing_of(o: argparse.Namespace, goals: HeadlineGoals) -> Routing:
    board = read_board(goals.board)
    tools = find_tools(board)
    slow = nextpnr_is_slow(tools.versions[board.family.nextpnr])
    return Routing(board, tools, o.seeds, o.first_seed, o.clock, o.route_speed or (8 if slow else 6),
                   o.placer or ("heap" if slow else "static"), o.route_again)


def plans_of(data: Data, work: Path) -> dict[str, HeadlinePlan]:
    """The plans of the data by their names."""
    known = known_names()
    for number, row in enumerate(data["rows"]):
        if row["plan"] not in known:
            raise Failure(f"{DATA}: rows[{number}].plan is {row['plan']}, expected one of {', '.join(known)}")
    return {name: find_plan(name, work) for name in {row["plan"] for row in data["rows"]}}


def digests_today(data: Data, work: Path) -> dict[str, str]:
    """Plan -> digest of its netlist, of each plan of the data; at the clock that its core is asked for today, whatever its row has."""
    board = read_board(data["board"])
    return {name: plan_digest(plan, board) for name, plan in plans_of(data, work).items()}


def predicted_today(data: Data, work: Path) -> Data:
    """The data with as many gatherers as photonloom predicts that each resource has room for: what was measured stays, but not a
    prediction of an earlier fit."""
    board = read_board(data["board"])
    facts = {name: describe(plan.path) for name, plan in plans_of(data, work).items()}
    today = data.copy()
    today["rows"] = [row.copy() for row in data["rows"]]
    for row in today["rows"]:
        row["fits"] = gatherers_that_fit(facts[row["plan"]], board)
    return today


def check_predictions(data: Data, predicted: Data) -> None:
    for row, now in zip(data["rows"], predicted["rows"]):
        if row["fits"] != now["fits"]:
            raise Failure(f"{DATA}: row {row['plan']} has room for gatherers {row['fits']}, expected {now['fits']}, which photonloom "
                          "predicts today; scripts/headline --render writes them")


def route_only(tops: list[Top], routing: Routing, jobs: int) -> int:
    """Each seed of each top, whichever is asked for; how many nextpnr does not end with."""
    seeds = range(routing.first_seed, routing.first_seed + routing.seeds)

    def one(job: tuple[Top, int]) -> bool:
        top, seed = job
        placed = route_seed(top, seed, routing.placer, routing)
        reached = (", ".join(f"{net} {c['achieved']:.1f} of {c['constraint']:g} MHz" for net, c in placed["clocks"].items())
                   if placed else "nextpnr does not end")
        say(f"{top.name}, seed {seed}: {reached}")
        return placed is not None

    return each(jobs, one, [(top, seed) for seed in seeds for top in tops]).count(False)


def play(plan: HeadlinePlan, goals: HeadlineGoals, work: Path) -> Replay:
    """The replay of a plan's board, simulated unless that of the same netlist, plan, scene and programs is kept: radii are in no netlist."""
    digest = plan_digest(plan, read_board(goals.board))
    of = [digest, sha256(plan.path), scene_sha256(goals.scene), sha256(Path(PHOTONLOOM)), sha256(BOARD_SIM)]
    kept = work / "replays" / f"{plan.name}-{hashlib.sha256(json.dumps(of).encode()).hexdigest()[:SHORT]}.json"
    if kept.is_file():
        return checked_json(kept, Replay)
    played = replay(plan, digest, goals.scene, work)
    kept.parent.mkdir(exist_ok=True)
    write_json(kept, played)
    return played


def publish(rows: list[Row], played: Replay | None, images: list[ImageTime], link: Link | None, goals: HeadlineGoals, work: Path,
            page: bool) -> Data:
    """Writes what was measured; onto the page where asked, beside what stands there of other plans. link: None where that
    of fpga/headline.json stays; images: empty where those stay."""
    with data_lock(DATA):
        before = read_data() if DATA.is_file() else None
        if not link:
            if not before:
                raise Failure(f"{DATA}: is not there, expected the rows beside which replays and images stand")
            link = before["link"]
        data: Data = {"board": goals.board, "rows": merge([], rows), "replay": played, "images": images, "link": link}
        if rows:
            write_json(work / "report.json", data)
        if page:
            whole: Data = {"board": goals.board, "rows": merge(before["rows"] if before else [], rows),
                           "replay": played or (before["replay"] if before else None),
                           "images": images or (before["images"] if before else []), "link": link}
            texts = page_texts(whole, goals, stale_plans(whole, digests_today(whole, work)))  # if that fails, both stay
            write_json(DATA, whole)
            write_page(texts)
    return data


def misses(rows: Sequence[Row], goals: HeadlineGoals) -> list[tuple[Row, str]]:
    """What the rows of a run miss; a rejected plan is known to."""
    missed = [(row, miss) for row in rows if not row["rejected"] for miss in judge(row, goals).missed]
    missed += [(row, miss) for row in rows if row["coarse"]
               for miss in judge_coarse(row, [*rows, *(read_data()["rows"] if DATA.is_file() else [])], goals.coarse).missed]
    return missed + [(row, miss) for row in rows if of_headline(row) for miss in judge_gain(row, goals.gain).missed]


def of_page(render: bool, goals: HeadlineGoals, work: Path) -> None:
    """--render, or --check. work: where plans are written."""
    data = read_data()
    today, predicted = digests_today(data, work), predicted_today(data, work)
    if render:
        data = predicted
        texts = page_texts(data, goals, stale_plans(data, today))
        write_json(DATA, data)
        write_page(texts)
    else:
        require_rows(DATA, (row["plan"] for row in data["rows"]), headline_names(), "scripts/headline {} --page")
        check_predictions(data, predicted)
    check_page(data, goals, today)
    stale = stale_plans(data, today)
    say("docs/headline.md is that of fpga/headline.json" +
        (f", and says that earlier RTL was routed for {', '.join(sorted(stale))}" if stale else " and of today's RTL"))


def main() -> int:
    o, goals = options(), headline_goals()
    if o.dry_run:
        return 0
    if o.render or o.check:
        with tempfile.TemporaryDirectory() as made:
            of_page(o.render, goals, made_folder(o.results or Path(made)).resolve())
        return 0
    work = made_folder(o.results or ROOT / "build" / "headline").resolve()
    replayed = find_plan(goals.replay, work)
    if o.replay_only:
        publish([], play(replayed, goals, work), [], None, goals, work, o.page)
        return 0
    if o.images_only:
        images = time_images(goals.images, processor())
        data = publish([], None, images, None, goals, work, o.page)
        data["rows"] = read_data()["rows"]
        print("\n" + images_of(data, goals))
        return 0
    routing = routing_of(o, goals)
    plans = find_plans(o.plans, work)
    tops = [prepare(plan, work, routing) for plan in plans]
    if o.route_only:
        return 1 if route_only(tops, routing, o.jobs) else 0
    bench = Bench(work, goals.scene)

    def engine(job: tuple[HeadlinePlan, Top]) -> tuple[Entry, Simulated]:
        plan, top = job
        entry = route(top, routing)
        return entry, simulate(plan, entry, bench)

    engines = each(o.jobs, engine, list(zip(plans, tops)))
    rows: list[Row] = []
    for plan, top, (entry, of_plan) in zip(plans, tops, engines):  # one after the other: a core is timed on a quiet machine
        rows += rows_of(plan, top, entry, of_plan, time_core(plan, of_plan, bench), routing.tools.versions, processor(), routing.board,
                        coarse_of(plan, find_plan(plan.finer, work), goals.scene, of_plan.folder) if plan.finer else None)
    played = play(replayed, goals, work) if goals.replay in [plan.name for plan in plans] else None
    # The whole page's images are timed with the whole page's rows.
    images = time_images(goals.images, processor()) if not o.plans else []
    # One link stands on the page: that of the board beside whole images, or any where there is no page yet.
    link = next((top.link for plan, top in zip(plans, tops) if plan.name == goals.images.plan), None if DATA.is_file() else tops[0].link)
    data = publish(rows, played, images, link, goals, work, o.page)
    text = summary(data, goals, []) + "\n" + report(data, goals) + (images_of(data, goals) if images else "")
    (work / "report.md").write_text(text)
    print("\n" + text)
    missed = misses(rows, goals)
    for row, miss in missed:
        warn(f"{row['plan']}, {radius_of(row, 'no radius')}: {miss}")
    return 1 if missed else 0
