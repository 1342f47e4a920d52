# SPDX-License-Identifier: Apache-2.0
"""Gathers a second of a board beside one core of this machine, for the plans of fpga/headline.

Queries a second = routed Fmax of the board's whole top (median of the seeds of scripts/fpga) / cycles per gather, simulated
with all its gatherers at work on the shared photon memory, fill and drain included. The core: the best of nanoflann, FLANN and
CGAL, and the golden gather, on the same quantised photons and queries in the same order, timed in this run; without a radius
and within the mean r^2 of the queries. A plan that is not routed yet is routed first; cycles that the same program simulated
of the same top at the same clock before are taken from build/headline. Writes build/headline/report.json and report.md; exit
status 1 where a goal is missed: times one core, or 80 % of the bound where that is under the goal; from SDRAM also the share
of its roofline and what reordering gains, as scripts/bench-rtl gather_cluster judges them."""
import argparse
import concurrent.futures
import os
from collections.abc import Sequence
from pathlib import Path

from flow.boards import read_board
from flow.goals import headline_goals
from flow.headline.link import link_of
from flow.headline.page import radius_of, report
from flow.headline.rows import Row, measure
from flow.headline.tops import Bench, Routing, route, simulate
from flow.shell import ROOT, Failure, warn, write_json
from flow.tables import replace_between
from flow.tools import find_tools, nextpnr_is_slow

PLANS = ROOT / "fpga" / "headline"


def processor() -> str:
    """What this machine calls its processor."""
    with open("/proc/cpuinfo") as f:
        return next((line.split(":", 1)[1].strip() for line in f if line.startswith("model name")), "unknown")


def options() -> argparse.Namespace:
    p = argparse.ArgumentParser(prog="headline", description=__doc__)
    p.add_argument("plans", nargs="*", type=Path, help="plan files (default: those of fpga/headline)")
    p.add_argument("--seeds", type=int, default=1,
                   help="placements of what is not routed yet (default: 1; a headline top took 10 to 40 minutes beside another)")
    p.add_argument("--jobs", type=int, default=os.cpu_count(), help="tops routed, then simulated, at a time (default: one a core; 2 GB each)")
    p.add_argument("--clock", type=float, help="MHz of the core to route to, if not the board's default")
    p.add_argument("--route-speed", type=int, choices=(6, 7, 8),
                   help="as of scripts/fpga (default: 6, but 8 with nextpnr 0.7, which did not end at 6)")
    p.add_argument("--placer", choices=("heap", "static"), help="as of scripts/fpga (default: static, but heap with nextpnr 0.7)")
    p.add_argument("--route-again", action="store_true", help="route even what has been")
    p.add_argument("--page", action="store_true", help="put the report into docs/headline.md too")
    o = p.parse_args()
    if o.jobs < 1:
        p.error("--jobs must be at least 1")
    return o


def checked(plans: Sequence[Path]) -> Sequence[Path]:
    """The plans, each there and of a name of its own: what is simulated and timed is kept by name."""
    if not plans:
        raise Failure("fpga/headline: has no plan")
    for plan in plans:
        if not plan.is_file():
            raise Failure(f"{plan}: there is no such plan")
    names = [plan.stem for plan in plans]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice:
        raise Failure(f"there are two plans {twice}.toml, expected each name once")
    return plans


def main() -> int:
    o, goals = options(), headline_goals()
    board = read_board(goals.board)
    versions = find_tools(board).versions
    slow = nextpnr_is_slow(versions[board.family.nextpnr])
    routing = Routing(board, o.seeds, o.clock, o.route_speed or (8 if slow else 6), o.placer or ("heap" if slow else "static"),
                      o.route_again)
    bench = Bench(ROOT / "build" / "headline")
    bench.work.mkdir(parents=True, exist_ok=True)
    plans = checked(o.plans or sorted(PLANS.glob("*.toml")))
    # A top that fails does not end the others: what they reach is kept.
    with concurrent.futures.ThreadPoolExecutor(o.jobs) as pool:
        tops = list(pool.map(lambda plan: route(plan, bench.work, routing), plans))
        simulated = list(pool.map(lambda plan, top: simulate(plan, plan.stem, top[0], bench), plans, tops))
    rows: list[Row] = []
    for plan, (routed, where), of_plan in zip(plans, tops, simulated):  # one after the other: a core is timed on a quiet machine
        link = link_of(where, board, 1000 * routed["constraint_mhz"])
        for row in measure(plan.stem, bench, goals, routed, of_plan):
            row.update(uart=link.rate, baud=link.baud, uart_bytes=[link.down, link.up])
            rows.append(row)
        text = report(rows, link)
        write_json(bench.work / "report.json", rows)
        (bench.work / "report.md").write_text(text)
    print("\n" + text)
    if o.page:
        replace_between(ROOT / "docs" / "headline.md", "report",
                        f"\nOne core of: {processor()}. {'; '.join(versions.values())}.\n\n{text}\n")
    for r in rows:
        for miss in r["missed"]:
            warn(f"{r['plan']}, {radius_of(r, 'no radius')}: {miss}")
    return 1 if any(r["missed"] for r in rows) else 0
