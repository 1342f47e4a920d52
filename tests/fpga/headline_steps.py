# SPDX-License-Identifier: Apache-2.0
"""usage: headline_steps.py THROUGHPUT [BENCH_GATHER]: the steps of scripts/headline after routing on a few queries, by the programs
as they are built: package, simulation, timing of the cores where BENCH_GATHER is given, rows and page. Clocks are made up."""
import sys
import tempfile
from pathlib import Path

from flow.boards import LUT_EQ, read_board
from flow.goals import headline_goals
from flow.headline.data import Cores, Data, Rate, Row
from flow.headline.page import report, summary
from flow.headline.plans import find_plan, variant_names
from flow.headline.rows import rows_of
from flow.headline.simulation import Bench, Simulated, Timed, simulate, time_core
from flow.headline.tops import Routing, prepare
from flow.headline.verdict import judge
from flow.results import Entry
from flow.shell import Failure, exit_with
from flow.tools import Tools

FEW = ("--size", "8", "--samples", "1", "--gather-rays", "16")
RATE: Rate = {"least": 1.0, "median": 2.0, "most": 3.0, "runs": 7}
CORES: Cores = {"threads": 2, "share": 1.0, "rate": RATE}


def made_up(simulated: Simulated) -> dict[int | None, Timed]:
    return {row["r2_max"]: Timed({"photonloom": RATE, "CGAL": RATE}, CORES, 0, 1.0) for row in simulated.rows}


def rows(name: str, work: Path, throughput: Path, core: Path | None) -> list[Row]:
    goals = headline_goals()
    board = read_board(goals.board)
    plan = find_plan(name, work)
    top = prepare(plan, work, Routing(board, Tools([], {"yosys": "none"}), 1, 1, None, 6, "static", False))
    entry: Entry = {"name": "board", "digest": top.digest, "top": board.top(), "constraint_mhz": top.clock_mhz,
                    "resources": {LUT_EQ: 40000}, "binding": {"resource": "DP16KD", "used": 190, "of": 208},
                    "seeds": [{"seed": 1, "placer": "static", "clocks": {}, "utilization": {}, "bitstream": ""}],
                    "clocks": {"clk": {"median": 80.0, "low": 80.0, "high": 80.0, "constraint": top.clock_mhz}},
                    "fmax_mhz": {"median": 80.0, "low": 80.0, "high": 80.0}}
    bench = Bench(work, goals.scene, throughput, core or throughput, FEW)
    simulated = simulate(plan, entry, bench)
    timed = time_core(plan, simulated, bench) if core else made_up(simulated)
    return rows_of(plan, top, entry, simulated, timed, {"yosys": "none"}, "a core", board)


def main() -> int:
    throughput = Path(sys.argv[1])
    core = Path(sys.argv[2]) if len(sys.argv) > 2 else None
    goals = headline_goals()
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        made = [row for name in (goals.replay, *variant_names()) for row in rows(name, work, throughput, core)]
        data: Data = {"board": goals.board, "rows": made, "replay": None, "images": [], "link": {"baud": 2e6, "down": 1.0, "up": 1.0}}
        text = summary(data, goals, []) + report(data, goals)
    for row in made:
        if f"| {row['plan']} | {row['k']} |" not in text or not 1 < row["cycles_per_gather"] < 1000:
            raise Failure(f"{row['plan']}: {row['cycles_per_gather']} cycles a gather, expected a row of it on the page")
        if core and (row["recall"] == 1) != (row["leaf_limit"] == 0):
            raise Failure(f"{row['plan']}: recall {row['recall']} with at most {row['leaf_limit']} leaves")
        print(f"{row['plan']}, k = {row['k']}: {judge(row, goals).board / 1e6:.2f} Mquery/s, recall {row['recall']}")
    return 0


if __name__ == "__main__":
    exit_with(main)
