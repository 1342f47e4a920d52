# SPDX-License-Identifier: Apache-2.0
"""What the scripts of the FPGA flow decide, on made-up figures."""
import argparse
import contextlib
import importlib.machinery
import importlib.util
import io
import json
import os
import re
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "fpga"))
import flow  # noqa: E402


def script(name):
    """A program of scripts/ as a module."""
    loader = importlib.machinery.SourceFileLoader(name.replace("-", "_"), os.path.join(ROOT, "scripts", name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module


class AreaCheck(unittest.TestCase):
    base = {"LUT4": 1000, "FF": 500, "CCU2C": 100, "DPR16X4": 40, "DP16KD": 4, "MULT18X18D": 0}

    def check(self, **changes):
        return script("area-check").compare("unit", {**self.base, **changes}, self.base)

    def test_same_and_small_changes_pass(self):
        self.assertEqual(self.check(), ([], []))
        self.assertEqual(self.check(LUT4=1030, FF=485), ([], []))

    def test_each_resource_can_fail(self):
        for name in flow.RESOURCES:
            grown, shrunk = self.check(**{name: self.base[name] * 104 // 100 + 1})
            self.assertEqual((len(grown), shrunk), (1, []), name)
            self.assertIn(f"unit: {name}", grown[0])

    def test_growth_is_told_in_percent(self):
        self.assertEqual(self.check(LUT4=1031)[0], ["unit: LUT4 1000 -> 1031 (+3.1 %)"])

    def test_shrinking_is_told(self):
        self.assertEqual(self.check(DPR16X4=30), ([], ["unit: DPR16X4 40 -> 30 (-25.0 %)"]))


class Placements(unittest.TestCase):
    def place(self, seeds, endless):
        """The (seed, placer) that are kept where the static placer does not end with some seeds."""
        o = argparse.Namespace(first_seed=1, seeds=seeds, placer="static")
        with contextlib.redirect_stdout(io.StringIO()):
            return script("fpga").placements(o, "board", lambda seed, placer: None if placer == "static" and seed in endless
                                             else (seed, placer))

    def test_a_further_seed_stands_in(self):
        self.assertEqual(self.place(2, []), [(1, "static"), (2, "static")])
        self.assertEqual(self.place(2, [1]), [(2, "static"), (3, "static")])
        self.assertEqual(self.place(1, [1, 2]), [(3, "static")])

    def test_then_the_default_placer(self):
        self.assertEqual(self.place(2, range(1, 9)), [(3, "heap"), (4, "heap")])


class MeasuredAgain(unittest.TestCase):
    old = {"plan": "p", "unit": "u", "resources": 1}

    def merge(self, yosys):
        data = {"versions": {"yosys": "a", "nextpnr-ecp5": "b"}, "measurements": [self.old, {**self.old, "unit": "v"}]}
        script("fpga-plans").merge(data, [{**self.old, "resources": 2}, {**self.old, "plan": "q"}],
                                   {"yosys": yosys, "nextpnr-ecp5": "c"})
        return data

    def test_new_takes_the_place_of_old(self):
        data = self.merge("a")
        self.assertEqual([(m["plan"], m["unit"], m["resources"]) for m in data["measurements"]],
                         [("p", "u", 2), ("p", "v", 1), ("q", "u", 1)])
        self.assertEqual(data["versions"]["nextpnr-ecp5"], "c")

    def test_counts_of_two_yosys_do_not_mix(self):
        with self.assertRaisesRegex(flow.Failure, "was measured with a, expected that of b"):
            self.merge("b")


class BoardMemories(unittest.TestCase):
    """Block RAMs of a whole top: `photonloom plan` beside what was synthesized."""

    def predicted(self, plan):
        out = flow.run([flow.PHOTONLOOM, "plan", os.path.join(ROOT, plan), "--json"])
        return json.loads(out)["board_ebr"]["total"]

    def synthesized(self, page, row):
        """`row` of a table in `page`: the plan's name and the block RAMs that its top takes."""
        with open(os.path.join(ROOT, page)) as f:
            return dict(re.findall(row + r".*\| DP16KD (\d+) of 208 \|", f.read(), re.MULTILINE))

    def test_of_the_headline(self):
        tops = self.synthesized("docs/headline.md", r"^\| (\w+) \| \d+ \|")
        self.assertEqual(len(tops), 6)
        for plan, blocks in tops.items():
            with self.subTest(plan):
                self.assertEqual(self.predicted(f"fpga/headline/{plan}.toml"), int(blocks))

    def test_of_the_readme(self):
        tops = self.synthesized("README.md", r"^\| `(board)` \|")
        self.assertEqual(self.predicted("fpga/gatherer.toml"), int(tops["board"]))


class Run(unittest.TestCase):
    def test_a_program_that_is_not_there(self):
        with self.assertRaisesRegex(flow.Failure, "^/nowhere/program: cannot be started: No such file or directory$"):
            flow.run(["/nowhere/program"])

    def test_what_failed_carries_its_last_words(self):
        with self.assertRaisesRegex(flow.Failure, "sh -c failed: last$"):
            flow.run(["sh", "-c", "echo first; echo last >&2; exit 3"])


class Headline(unittest.TestCase):
    """make headline with programs that stand in for the simulation and for the timing of a core."""
    SIMULATION = """#!/bin/sh
# PLAN --radius --core-mhz F --json OUT --dump FOLDER
echo run >> "$8/runs"; : > "$8/p.photons"; : > "$8/p.queries"; cp "$8/rows" "$6"
"""
    CORE = """#!/bin/sh
cp "$(dirname "$1")/cores" "$1"
"""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = folder.name
        for path, text in (("build/verilator_tb/throughput/throughput_gather_cluster", self.SIMULATION),
                           ("build/bench/bench_gather", self.CORE)):
            path = os.path.join(self.work, path)
            os.makedirs(os.path.dirname(path))
            with open(path, "w") as f:
                f.write(text)
            os.chmod(path, 0o755)
        root, flow.ROOT = flow.ROOT, self.work
        self.addCleanup(setattr, flow, "ROOT", root)
        self.headline = script("headline")
        self.o = argparse.Namespace(work=self.work)

    def simulated(self, cycles=10, bound=16, **of_sdram):
        row = {"memory": "block_ram", "k": 8, "gatherers": 2, "order": "reordered", "cycles_per_gather": cycles, "bound": bound,
               "roofline_cycles": None, "roofline_met": None, **of_sdram}
        rows = [{**row, "r2_max": None}, {**row, "r2_max": 7, "cycles_per_gather": bound / 2}]
        if of_sdram:
            rows += [{**r, "order": "pixels", "reorder_goal": 4, "reorder_gain": 5} for r in rows]
        self.write("rows", {"gather_cluster": rows})
        return rows

    def write(self, name, value):
        with open(os.path.join(self.work, name), "w") as f:
            json.dump(value, f)

    def rows(self, fmax=100, digest="d"):
        with contextlib.redirect_stdout(io.StringIO()):
            return self.headline.simulate("p.toml", "p", {"fmax_mhz": {"median": fmax}, "digest": digest}, self.o)

    def runs(self):
        with open(os.path.join(self.work, "runs")) as f:
            return len(f.readlines())

    def test_what_was_simulated_is_kept(self):
        self.assertEqual(self.simulated(), self.rows())
        self.rows()
        self.assertEqual(self.runs(), 1)

    def test_simulates_again_what_changed(self):
        self.simulated()
        self.rows()
        for n, changed in enumerate(({"fmax": 99}, {"fmax": 99, "digest": "e"}), start=2):
            self.rows(**changed)
            self.assertEqual(self.runs(), n, changed)
        self.simulated(cycles=11)  # another program, another answer
        with open(os.path.join(self.work, "build/verilator_tb/throughput/throughput_gather_cluster"), "a") as f:
            f.write("# changed\n")
        self.assertEqual(self.rows(99, "e")[0]["cycles_per_gather"], 11)
        os.remove(os.path.join(self.work, "p.queries"))  # which the timing of a core needs
        self.rows(99, "e")
        self.assertEqual(self.runs(), 5)

    def missed(self, golden, library=0.5e6, fmax=100):
        """What the row without a radius misses."""
        rates = {"photonloom": golden, "nanoflann": library}
        self.write("cores", [{"r2_max": r, "queries_per_second": rates} for r in (None, 7)])
        routed = {"fmax_mhz": {"median": fmax}, "digest": "d", "binding": {}, "seeds": [{"seed": 1}]}
        with contextlib.redirect_stdout(io.StringIO()):
            rows = self.headline.simulate("p.toml", "p", routed, self.o)
            return self.headline.measure("p", self.o, routed, rows)[0]["missed"]

    def test_goal_is_of_the_faster_core(self):
        self.simulated()  # 10 Mquery/s; the bound of 12.5 is above the goal in all three
        self.assertEqual(self.missed(1.25e6), [])
        over = ["7.69 times one core, goal 8; 80 % of the bound"]
        self.assertEqual(self.missed(1.3e6, library=1e6), over)
        self.assertEqual(self.missed(1e6, library=1.3e6), over)

    def test_a_bound_under_the_goal_is_to_be_reached_by_four_fifths(self):
        self.simulated()
        self.assertEqual(self.missed(2e6), [])
        self.simulated(cycles=10.1)
        self.assertEqual(self.missed(2e6, fmax=99), ["4.90 times one core, goal 8; 79 % of the bound"])

    def test_roofline_and_reordering_count_too(self):
        self.simulated(memory="sdram", roofline_cycles=9.0, roofline_met=False, roofline_verdict="too far", reorder_gain=5)
        self.assertEqual(self.missed(1e6), ["too far"])
        rows = self.simulated(memory="sdram", roofline_cycles=9.0, roofline_met=True)
        rows[2]["reorder_gain"] = 3.9
        self.write("rows", {"gather_cluster": rows})
        self.assertEqual(self.missed(1e6, fmax=101), ["reordering gains 3.90, goal 4"])


class Counts(unittest.TestCase):
    def test_cells_are_counted_by_resource(self):
        cells = {"LUT4": 10, "CCU2C": 3, "TRELLIS_DPR16X4": 2, "TRELLIS_FF": 7, "DP16KD": 1, "PFUMX": 5}
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "stat.json")
            with open(path, "w") as f:
                json.dump({"modules": {"\\u": {"num_cells_by_type": cells}}}, f)
            counts = flow.counts_of(path, "ulx3s-85f", "u")
            with self.assertRaisesRegex(flow.Failure, "has no module v"):
                flow.counts_of(path, "ulx3s-85f", "v")
        self.assertEqual(counts, {"LUT4": 10, "FF": 7, "CCU2C": 3, "DPR16X4": 2, "DP16KD": 1, "MULT18X18D": 0,
                                  "LUT-eq": 10 + 6 + 8})

    def test_the_fullest_resource_binds(self):
        counts = {"LUT4": 10, "FF": 7, "CCU2C": 3, "DPR16X4": 2, "DP16KD": 104, "MULT18X18D": 77, "LUT-eq": 24}
        self.assertEqual(flow.binding(counts, "ulx3s-85f"), {"resource": "DP16KD", "used": 104, "of": 208})

    def test_median(self):
        self.assertEqual(flow.median([3, 1, 2]), 2)
        self.assertEqual(flow.median([4, 1, 2, 3]), 2.5)


if __name__ == "__main__":
    unittest.main()
