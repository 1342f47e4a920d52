# SPDX-License-Identifier: Apache-2.0
"""scripts/headline with programs that stand in for the simulation and for the timing of a core."""
import contextlib
import io
import json
import tempfile
import unittest
from pathlib import Path
from typing import Any

from flow.boards import read_board
from flow.goals import headline_goals
from flow.headline.link import link_of
from flow.headline.page import arithmetic, table
from flow.headline.rows import Row, measure
from flow.headline.tops import Bench, simulate
from flow.results import Entry
from flow.shell import Failure

RECORDED = Path(__file__).parent / "recorded"
SIMULATION = """#!/bin/sh
# PLAN --radius --core-mhz F --json OUT --dump FOLDER
echo run >> "$8/runs"; : > "$8/p.photons"; : > "$8/p.queries"; cp "$8/rows" "$6"
"""
CORE = """#!/bin/sh
cp "$(dirname "$1")/cores" "$1"
"""


class Headline(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = Path(folder.name)
        self.bench = Bench(self.work, self.work / "throughput", self.work / "core")
        for path, text in ((self.bench.throughput, SIMULATION), (self.bench.core, CORE)):
            path.write_text(text)
            path.chmod(0o755)

    def simulated(self, cycles: float = 10, bound: float = 16, **others: Any) -> list[Row]:
        row: Row = {"memory": "block_ram", "k": 8, "gatherers": 2, "order": "reordered", "cycles_per_gather": cycles,
                    "bound": bound, "roofline_cycles": None, "roofline_met": None, **others}
        rows: list[Row] = [{**row, "r2_max": None}, {**row, "r2_max": 7, "cycles_per_gather": bound / 2}]
        if row["memory"] == "sdram":
            rows += [{**r, "order": "pixels", "reorder_goal": 4, "reorder_gain": 5} for r in rows]
        self.write("rows", {"gather_cluster": rows})
        return rows

    def write(self, name: str, value: object) -> None:
        (self.work / name).write_text(json.dumps(value))

    def routed(self, fmax: float, digest: str = "d") -> Entry:
        spread = {"median": fmax, "low": fmax, "high": fmax}
        entry: Any = {"fmax_mhz": spread, "digest": digest, "binding": {}, "seeds": [{"seed": 1}]}
        found: Entry = entry
        return found

    def rows(self, fmax: float = 100, digest: str = "d") -> list[Row]:
        with contextlib.redirect_stdout(io.StringIO()):
            return simulate(Path("p.toml"), "p", self.routed(fmax, digest), self.bench)

    def runs(self) -> int:
        return len((self.work / "runs").read_text().splitlines())

    def test_what_was_simulated_is_kept(self) -> None:
        self.assertEqual(self.simulated(), self.rows())
        self.rows()
        self.assertEqual(self.runs(), 1)

    def test_simulates_again_what_changed(self) -> None:
        self.simulated()
        self.rows()
        self.rows(99)
        self.assertEqual(self.runs(), 2, "another clock")
        self.rows(99, "e")
        self.assertEqual(self.runs(), 3, "another top")
        self.simulated(cycles=11)  # another program, another answer
        self.bench.throughput.write_text(SIMULATION + "# changed\n")
        self.assertEqual(self.rows(99, "e")[0]["cycles_per_gather"], 11)
        (self.work / "p.queries").unlink()  # which the timing of a core needs
        self.rows(99, "e")
        self.assertEqual(self.runs(), 5)

    def measured(self, golden: float, library: float = 0.5e6, fmax: float = 100) -> list[Row]:
        """The rows beside a core of these rates."""
        rates = {"photonloom": golden, "nanoflann": library}
        self.write("cores", [{"r2_max": r, "queries_per_second": rates} for r in (None, 7)])
        with contextlib.redirect_stdout(io.StringIO()):
            rows = simulate(Path("p.toml"), "p", self.routed(fmax), self.bench)
            return measure("p", self.bench, headline_goals(), self.routed(fmax), rows)

    def missed(self, golden: float, library: float = 0.5e6, fmax: float = 100) -> object:
        """What the row without a radius misses."""
        return self.measured(golden, library, fmax)[0]["missed"]

    def test_goal_is_of_the_faster_core(self) -> None:
        self.simulated()  # 10 Mquery/s; the bound of 12.5 is above the goal in all three
        self.assertEqual(self.missed(1.25e6), [])
        over = ["7.69 times one core, goal 8; 80 % of the bound"]
        self.assertEqual(self.missed(1.3e6, library=1e6), over)
        self.assertEqual(self.missed(1e6, library=1.3e6), over)

    def test_a_bound_under_the_goal_is_to_be_reached_by_four_fifths(self) -> None:
        self.simulated()
        self.assertEqual(self.missed(2e6), [])
        self.simulated(cycles=10.1)
        self.assertEqual(self.missed(2e6, fmax=99), ["4.90 times one core, goal 8; 79 % of the bound"])

    def test_roofline_and_reordering_count_too(self) -> None:
        self.simulated(memory="sdram", roofline_cycles=9.0, roofline_met=False, roofline_verdict="too far", reorder_gain=5)
        self.assertEqual(self.missed(1e6), ["too far"])
        rows = self.simulated(memory="sdram", roofline_cycles=9.0, roofline_met=True)
        rows[2]["reorder_gain"] = 3.9
        self.write("rows", {"gather_cluster": rows})
        self.assertEqual(self.missed(1e6, fmax=101), ["reordering gains 3.90, goal 4"])

    def test_a_plan_without_a_goal(self) -> None:
        self.simulated(k=9)
        with self.assertRaisesRegex(Failure, r"goals.toml: headline.times_core.block_ram.9 is missing"):
            self.missed(1e6)

    def test_a_row_of_the_page(self) -> None:
        self.simulated(of_gatherers=0.8, nodes=12, leaves=3.5, insertions=16)
        row = self.measured(1e6)[0]
        row.update(uart=4600, binding={"resource": "DP16KD", "used": 104, "of": 208})
        self.assertEqual(table([row]).splitlines()[2],
                         "| p | 8 | none | 2 | 100.0 (seed 1) | 10.00 | 10.00 | 0.50 (nanoflann) | 1.00 | 20.0 | 10.0 | 8 | "
                         "12.50 (gatherers), 80 % | 80 % | – | – | DP16KD 104 of 208 | 4.6 |")
        self.assertEqual(arithmetic([row]), "- `p`, no radius: 12.0 nodes, 3.5 leaves, 16.0 insertions a query: 16.0 cycles of "
                                            "a gatherer; 2 x 100.0 MHz: 12.50 Mquery/s.\n")


class SerialLink(unittest.TestCase):
    def test_of_a_recorded_package(self) -> None:
        link = link_of(RECORDED / "package", read_board("ulx3s-85f"), 50000)
        self.assertEqual(link.baud, 2e6)
        # A query of 88 bits is 3 words, a result of 262 with its number 10; docs/host-link.md has the frames.
        self.assertAlmostEqual(link.down, (3 * (4 + 12 / 64) + 10 * 17 / 64) * 258 / 256)
        self.assertAlmostEqual(link.up, (10 * (4 + 16 / 64) + 3 * 16 / 64) * 258 / 256)
        self.assertAlmostEqual(link.rate, 2e5 / link.up)

    def test_what_is_not_there(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            rtl = Path(folder, "rtl")
            rtl.mkdir()
            top, package = rtl / "ulx3s_85f_top.sv", rtl / "photonloom_pkg.sv"
            top.write_text("endmodule\n")
            package.write_text("endpackage\n")
            with self.assertRaisesRegex(Failure, "^ulx3s_85f_top.sv: has no ClocksPerBit$"):
                link_of(Path(folder), read_board("ulx3s-85f"), 50000)
            top.write_text("    parameter int unsigned ClocksPerBit = 25\n")
            with self.assertRaisesRegex(Failure, "^photonloom_pkg.sv: has no GatherQueryPacketBits$"):
                link_of(Path(folder), read_board("ulx3s-85f"), 50000)


if __name__ == "__main__":
    unittest.main()
