# SPDX-License-Identifier: Apache-2.0
"""scripts/headline: what it keeps, judges and writes, with programs that stand in for simulation, routing and the timing of
a core."""
import contextlib
import copy
import dataclasses
import io
import json
import re
import sys
import tempfile
import unittest
from pathlib import Path
from typing import Any
from unittest import mock

from flow.boards import LUT_EQ, read_board
from flow.goals import HEADLINE, GainGoals, Growth, ImageGoals, headline_goals, headline_names
from flow.headline import command, images, page, replay, tables, tops
from flow.headline.command import check_predictions, digests_today, misses, processor
from flow.headline.data import Cores, Data, ImageTime, Rate, Replay, Row, SdramLoad, merge, read_data
from flow.headline.images import ON_A_BOARD, image_time, render_options, time_images
from flow.headline.link import link_of
from flow.headline.netlist import netlist_digest, plan_digest
from flow.headline.plans import HeadlinePlan, base_of, find_plan, rejected_names, rejected_plan, variant_names, variant_plan, why_rejected
from flow.headline.rows import gatherers_that_fit, rows_of
from flow.headline.simulation import Bench, Timed, simulate, time_core
from flow.headline.tops import Routing, Top, prepare, route, route_seed
from flow.headline.verdict import Verdict, board_for_size, judge, judge_gain, own_bound
from flow.results import Entry, add_placements
from flow.routing import Placement
from flow.shell import ROOT, Failure
from flow.tools import Tools
from made_up_rows import CORE_CLOCK, SDRAM_CLOCK, MadeUp, all_cores, rate

RECORDED = Path(__file__).parent / "recorded"
SIMULATION = """#!/bin/sh
# PLAN --radius --core-mhz F [--sdram-mhz F] --json OUT --dump FOLDER --scene SCENE
here=$(dirname "$0"); echo "$*" >> "$here/runs"
while [ "$1" != --json ]; do shift; done
echo photons > "$4/p.photons"; echo queries > "$4/p.queries"; cp "$here/rows" "$2"
"""
CORE = """#!/bin/sh
echo "$*" > "$(dirname "$0")/core_options"
cp "$(dirname "$0")/cores" "$1"
"""
PLAN = "[gather]\nleaf_limit = 0\n[photon]\nbucket = 16\n"
BOX = """<scene version="3.0.0">
  <sensor type="perspective">
    <float name="fov" value="60"/>
    <transform name="to_world"><lookat origin="0, 0, 0.9" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="4"/><integer name="height" value="4"/><rfilter type="box"/></film>
  </sensor>
  <shape type="cube"><boolean name="flip_normals" value="true"/><bsdf type="diffuse"/></shape>
  <shape type="sphere"><point name="center" x="0" y="0.5" z="0"/><float name="radius" value="0.1"/>
    <emitter type="area"><rgb name="radiance" value="10"/></emitter></shape>
</scene>
"""


def placement(seed: int, core: float = 100, sdram: float | None = None) -> Placement:
    clocks: Any = {CORE_CLOCK: {"achieved": core, "constraint": 50.0}}
    if sdram:
        clocks[SDRAM_CLOCK] = {"achieved": sdram, "constraint": 100.0}
    return {"seed": seed, "placer": "static", "clocks": clocks, "utilization": {}, "bitstream": ""}


def routed(*placed: Placement, digest: str = "d") -> Entry:
    entry: Entry = {"name": "board", "digest": digest, "top": "t", "constraint_mhz": 50.0, "resources": {LUT_EQ: 20000},
                    "binding": {"resource": "DP16KD", "used": 104, "of": 208}, "seeds": []}
    add_placements(entry, list(placed), Path("there"))
    return entry


class Folder(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = Path(folder.name)
        silence = contextlib.redirect_stdout(io.StringIO())
        silence.__enter__()
        self.addCleanup(silence.__exit__, None, None, None)

    def write(self, name: str, text: str) -> Path:
        path = self.work / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path


class Simulations(Folder):
    def setUp(self) -> None:
        super().setUp()
        self.scene = self.write("scene.xml", "<scene/>")
        self.plan = HeadlinePlan("p", self.write("p.toml", PLAN))
        self.bench = Bench(self.work, self.scene, self.write("throughput", SIMULATION), self.write("core", CORE))
        for program in (self.bench.throughput, self.bench.core):
            program.chmod(0o755)
        self.rows = [{"k": 8, "r2_max": None}, {"k": 8, "r2_max": 7}]
        self.write("rows", json.dumps({"gather_cluster": self.rows}))

    def runs(self) -> list[str]:
        return (self.work / "runs").read_text().splitlines()

    def test_what_was_simulated_is_kept(self) -> None:
        for _ in range(2):
            self.assertEqual(simulate(self.plan, routed(placement(1)), self.bench).rows, self.rows)
        self.assertEqual(len(self.runs()), 1)

    def test_simulates_again_whatever_changed(self) -> None:
        def again(why: str, entry: Entry | None = None) -> None:
            before = len(self.runs()) if (self.work / "runs").is_file() else 0
            simulate(self.plan, entry or routed(placement(1)), self.bench)
            self.assertEqual(len(self.runs()), before + 1, why)

        again("the first")
        again("another clock", routed(placement(1, 99)))
        again("another netlist", routed(placement(1), digest="e"))
        again("another clock of the SDRAM", routed(placement(1, 100, 97)))
        self.scene.write_text("<scene><!-- another --></scene>")
        again("another scene")
        self.scene.write_text('<scene><string value="m.obj" name="filename"/></scene>')
        (self.work / "m.obj").write_text("a mesh")
        again("a mesh")
        (self.work / "m.obj").write_text("another mesh")
        again("another mesh")
        self.plan.path.write_text(PLAN + "# another")
        again("another plan")
        self.bench.throughput.write_text(SIMULATION + "# changed\n")
        again("another program")
        folder = simulate(self.plan, routed(placement(1)), self.bench).folder
        (folder / "p.queries").write_text("of another run")
        again("another cloud")
        (folder / "p.photons").unlink()
        again("no cloud")

    def test_the_sdrams_clock_is_the_one_reached(self) -> None:
        simulate(self.plan, routed(placement(1, 80, 97.1)), self.bench)
        self.assertIn("--core-mhz 80.00 --sdram-mhz 97.10 ", self.runs()[-1])
        simulate(self.plan, routed(placement(1, 80, 120)), self.bench)  # the chip's times are counted for 100 MHz
        self.assertIn("--sdram-mhz 100.00 ", self.runs()[-1])
        simulate(self.plan, routed(placement(1, 80)), self.bench)
        self.assertNotIn("--sdram-mhz", self.runs()[-1])

    def cores(self, runs: int, runs_of_all: int = 7) -> dict[int | None, Timed]:
        rate = {"least": 1.0, "median": 2.0, "most": 3.0, "runs": runs}
        all_cores = {**rate, "most": 5.0, "runs": runs_of_all, "threads": 2, "share": 0.9}
        self.write("cores", json.dumps([{"r2_max": r, "spread": {"photonloom": rate, "FLANN": rate}, "all_cores": all_cores,
                                         "recall": 0.75} for r in (None, 7)]))
        return time_core(self.plan, simulate(self.plan, routed(placement(1)), self.bench), self.bench)

    def test_a_core_is_timed_seven_times(self) -> None:
        self.assertEqual(self.cores(7)[7].one["FLANN"], {"least": 1, "median": 2, "most": 3, "runs": 7})
        with self.assertRaisesRegex(Failure, "core.json: photonloom was timed 6 times, expected at least 7"):
            self.cores(6)

    def test_all_cores_are_timed_seven_times(self) -> None:
        self.assertEqual(self.cores(7)[None].all_cores, {"threads": 2, "share": 0.9, "rate": {"least": 1, "median": 2, "most": 5, "runs": 7}})
        with self.assertRaisesRegex(Failure, "core.json: all cores was timed 6 times, expected at least 7"):
            self.cores(7, 6)

    def test_golden_searches_as_the_plan_says(self) -> None:
        self.assertEqual(self.cores(7)[7].leaf_limit, 0)
        self.assertTrue((self.work / "core_options").read_text().endswith(".queries -k 8 --r2-max 7\n"))
        self.plan.path.write_text(PLAN.replace("leaf_limit = 0", "leaf_limit = 4"))
        timed = self.cores(7)[7]
        self.assertEqual((timed.leaf_limit, timed.recall), (4, 0.75))
        self.assertTrue((self.work / "core_options").read_text().endswith(".queries -k 8 --r2-max 7 --leaf-limit 4 --bucket 16\n"))


class KeptSeeds(Folder):
    """Routing with a placer that counts."""

    def setUp(self) -> None:
        super().setUp()
        self.routing = Routing(read_board("ulx3s-85f"), Tools([], {"yosys": "1"}), 3, 1, None, 6, "static", False)
        self.top = Top("p", "d", self.work / "p-key", 50.0, {"baud": 2e6, "down": 1, "up": 1}, 1)
        self.write("p-key/package/build/ulx3s_85f_top.json", "{}")
        self.write("p-key/top.json", json.dumps({"digest": "d", "versions": {}, "resources": {},
                                                 "binding": {"resource": "DP16KD", "used": 1, "of": 208}}))
        self.placed: list[tuple[int, str]] = []
        self.endless: set[int] = set()
        self.enterContext(mock.patch.object(tops, "place", self.place))

    def place(self, folder: Path, top: str, seed: int, tools: Tools, route_speed: int, placer: str) -> Placement | None:
        self.placed.append((seed, placer))
        return None if placer == "static" and seed in self.endless else placement(seed, 60 + seed)

    def test_a_run_goes_on_where_it_was(self) -> None:
        route_seed(self.top, 2, "static", self.routing)
        self.assertEqual([s["seed"] for s in route(self.top, self.routing)["seeds"]], [1, 2, 3])
        self.assertEqual(self.placed, [(2, "static"), (1, "static"), (3, "static")])
        self.assertEqual(route(self.top, self.routing)["fmax_mhz"], {"median": 62, "low": 61, "high": 63})
        self.assertEqual(len(self.placed), 3)

    def test_a_seed_without_an_end_is_not_tried_again(self) -> None:
        self.endless = {2}
        for _ in range(2):
            self.assertEqual([s["seed"] for s in route(self.top, self.routing)["seeds"]], [1, 3, 4])
            self.assertEqual(route(self.top, self.routing)["unrouted"], [2])
        self.assertEqual([seed for seed, _ in self.placed], [1, 2, 3, 4])
        self.endless = set()
        self.assertNotIn("unrouted", route(self.top, dataclasses.replace(self.routing, seeds=1)))

    def test_other_tools_have_other_results(self) -> None:
        key = tops.top_key("d", "--speed 6", {"yosys": "1"})
        for other in (("d", "--speed 6", {"yosys": "2"}), ("d", "--speed 8", {"yosys": "1"}), ("e", "--speed 6", {"yosys": "1"})):
            self.assertNotEqual(key, tops.top_key(*other))

    def test_a_file_of_a_seed_that_was_cut_short(self) -> None:
        self.write("p-key/seed1-static-route6.json", "{}")
        with self.assertRaisesRegex(Failure, "seed1-static-route6.json: placed is missing, expected "):
            route_seed(self.top, 1, "static", self.routing)

    def test_seeds_alone_are_told_and_one_without_an_end_is_a_failure(self) -> None:
        self.assertEqual(command.route_only([self.top], self.routing, 1), 0)
        self.endless = {4, 6}
        self.assertEqual(command.route_only([self.top], dataclasses.replace(self.routing, first_seed=4), 1), 2)

    def test_a_top_too_large_is_not_routed(self) -> None:
        self.write("p-key/top.json", json.dumps({"digest": "d", "versions": {}, "resources": {}, "binding": {"resource": "DP16KD", "used": 223, "of": 208}}))
        with self.assertRaisesRegex(Failure, "^p: its board needs 223 DP16KD, the part has 208$"):
            route_seed(self.top, 1, "static", self.routing)


class Netlists(Folder):
    TOP = """// a top
module top (input logic clk_i, input logic [3:0] a_i, input logic [3:0] b_i, output logic [3:0] o);
  logic [3:0] sum;
  assign sum = a_i + b_i;
  register #(.Late(0)) last (.clk_i(clk_i), .in_i(sum), .out_o(o));
endmodule
"""
    REGISTER = """module register #(parameter int unsigned Late = 0)
    (input logic clk_i, input logic [3:0] in_i, output logic [3:0] out_o);
  (* ram_style = "block" *) logic [3:0] kept_q;
  always_ff @(posedge clk_i) kept_q <= in_i;
  assign out_o = kept_q;
endmodule
"""
    PLL = """module PLL #(parameter BY = "2") (input logic CLK, output logic OUT);
  assign OUT = CLK;
endmodule
"""

    def digest(self, **changed: str) -> str:
        texts = {"rtl/top.sv": self.TOP, "rtl/register.sv": self.REGISTER, "board/models/PLL.sv": self.PLL,
                 "board/b.lpf": "# pins\nLOCATE COMP \"a\" SITE \"G2\";\n", "README.md": "text",
                 "board/synth.ys": "# made\nread_verilog -sv rtl/top.sv rtl/register.sv\nsynth_ecp5 -abc9 -top top\n",
                 "files.f": "rtl/top.sv\nrtl/register.sv\n", **changed}
        with tempfile.TemporaryDirectory() as folder:
            for name, text in texts.items():
                path = Path(folder, name)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
            return netlist_digest(Path(folder))

    def replaced(self, file: str, text: str, old: str, new: str) -> str:
        self.assertIn(old, text)
        return self.digest(**{file: text.replace(old, new)})

    def test_what_is_the_same_design(self) -> None:
        for name, file, text, old, new in (
                ("comment", "rtl/top.sv", self.TOP, "// a top", "/* the top */\n"),
                ("comment of constraints", "board/b.lpf", "# pins\nLOCATE COMP \"a\" SITE \"G2\";\n", "# pins\n", ""),
                ("a file beside it", "README.md", "text", "text", "other"),
                ("order", "rtl/top.sv", self.TOP, "  assign sum = a_i + b_i;\n  register #(.Late(0)) last (.clk_i(clk_i), .in_i(sum), .out_o(o));\n",
                 "  register #(.Late(0)) last (.clk_i(clk_i), .in_i(sum), .out_o(o));\n  assign sum = a_i + b_i;\n"),
                ("a wire of another name", "rtl/top.sv", self.TOP, "  assign sum = a_i + b_i;",
                 "  logic [3:0] both;\n  assign both = a_i + b_i;\n  assign sum = both;"),
                ("a parameter", "rtl/register.sv", self.REGISTER, "Late = 0)", "Late = 0, parameter int unsigned Wide = 0)"),
                ("a block that is not generated", "rtl/register.sv", self.REGISTER, "  assign out_o = kept_q;",
                 "  if (Late != 0) begin : gen_late\n    always_ff @(posedge clk_i) out_o <= kept_q;\n  end else begin : gen_now\n"
                 "    logic [3:0] now;\n    assign now = kept_q;\n    assign out_o = now;\n  end")):
            with self.subTest(name):
                self.assertEqual(self.digest(), self.replaced(file, text, old, new))

    def test_what_is_another(self) -> None:
        for name, file, text, old, new in (
                ("operator", "rtl/top.sv", self.TOP, "a_i + b_i", "a_i - b_i"),
                ("operand", "rtl/top.sv", self.TOP, "a_i + b_i", "b_i + b_i"),
                ("width", "rtl/top.sv", self.TOP, "logic [3:0] sum", "logic [2:0] sum"),
                ("port", "rtl/top.sv", self.TOP, "a_i + b_i", "a_i + 4'(clk_i)"),
                ("register", "rtl/register.sv", self.REGISTER, "assign out_o = kept_q", "assign out_o = in_i"),
                ("attribute", "rtl/register.sv", self.REGISTER, '"block"', '"distributed"'),
                ("constraint", "board/b.lpf", "LOCATE COMP \"a\" SITE \"G2\";\n", "G2", "G3"),
                ("option", "board/synth.ys", "synth_ecp5 -abc9 -top top\n", "-abc9 ", "")):
            with self.subTest(name):
                self.assertNotEqual(self.digest(**{file: text}), self.replaced(file, text, old, new))

    def test_what_nothing_reads(self) -> None:
        """Through a module between, too."""
        between = "module between (input logic [3:0] in_i, output logic [3:0] out_o{ports});\n" \
                  "  register last (.clk_i(in_i[0]), .in_i(in_i), .out_o(out_o){pins});\nendmodule\n"

        def of(ports: str, inside: str, pins: str, outside: str, wire: str = "", more: str = "") -> str:
            return self.digest(**{
                "rtl/register.sv": self.REGISTER.replace("out_o);", f"out_o{ports});{inside}") + between.format(ports=ports, pins=pins),
                "rtl/top.sv": self.TOP.replace("logic [3:0] sum;", f"logic [3:0] sum;{wire}").replace("+ b_i", f"+ b_i{more}").replace(
                    "register #(.Late(0)) last (.clk_i(clk_i), ", "between last (").replace(".out_o(o)", f".out_o(o){outside}")})
        none = of("", "", "", "")
        ports, pins, copy = ", input logic in_2, output logic out_2", ", .in_2(in_2), .out_2(out_2)", " assign out_2 = in_2;"
        unread = " logic [1:0] two; logic unread; assign unread = &two;"
        self.assertEqual(none, of(ports, " assign out_2 = '0;", pins, ", .in_2(1'b1), .out_2()"))
        self.assertEqual(none, of(ports, copy, pins, ", .in_2(1'b1), .out_2()"))
        self.assertEqual(none, of(ports, copy, pins, ", .in_2(1'b1), .out_2(two[0])", unread))
        self.assertNotEqual(none, of(ports, copy, pins, ", .in_2(1'b1), .out_2(two[0])", unread, " + 4'(unread)"))
        self.assertNotEqual(none, of(ports, " always_ff @(posedge in_2) kept_q[0] <= 0;", pins, ", .in_2(1'b1), .out_2()"))

    def test_a_wire_that_is_read_by_the_name_of_its_block(self) -> None:
        def of(address: str) -> str:
            return self.digest(**{"rtl/top.sv": "module rom (input logic a, output logic d);\n  assign d = ~a;\nendmodule\n"
                                  "module top (input logic [1:0] a, output logic o);\n"
                                  "  for (genvar i = 0; i < 2; i++) begin : gen_rom\n    logic d;\n"
                                  f"    rom r (.a({address}), .d(d));\n  end\n"
                                  "  always_comb o = gen_rom[0].d ^ gen_rom[1].d;\nendmodule\n"})
        self.assertNotEqual(of("a[i]"), of("a[0]"))

    def test_a_pin_both_ways_is_read_from_outside(self) -> None:
        def of(value: str) -> str:
            return self.digest(**{"rtl/top.sv": f"module pad (input logic a, inout wire io);\n  assign io = {value};\nendmodule\n"
                                  "module top (input logic a, inout wire io);\n  pad p (.a(a), .io(io));\nendmodule\n"})
        self.assertNotEqual(of("a"), of("~a"))

    def test_an_output_that_goes_nowhere_but_is_read_within(self) -> None:
        def of(digit: int) -> str:
            return self.digest(**{"rtl/top.sv": "module zero (output logic z);\n" f"  assign z = 1'b{digit};\nendmodule\n"
                                  "module inner (input logic a, output logic z, output logic o);\n"
                                  "  zero zeros (.z(z));\n  assign o = a & z;\nendmodule\n"
                                  "module top (input logic a, output logic o);\n  inner i (.a(a), .z(), .o(o));\nendmodule\n"})
        self.assertNotEqual(of(0), of(1))

    def test_variables_of_one_name_in_two_blocks_are_two(self) -> None:
        """Without their scopes both designs would be the same statements."""
        def blocks(first: str, second: str) -> str:
            return self.digest(**{"rtl/top.sv": "module top (input logic a, input logic b, output logic p, output logic q);\n" + "".join(
                f"  if (1) begin : gen_{of}\n    logic x;\n    assign x = ~{of};\n    assign {to} = ~x;\n  end\n"
                for of, to in (("a", first), ("b", second))) + "endmodule\n"})
        self.assertNotEqual(blocks("p", "q"), blocks("q", "p"))

    def test_a_parameter_that_is_used(self) -> None:
        def late(value: int) -> str:
            return self.digest(**{"rtl/top.sv": self.TOP.replace(".Late(0)", f".Late({value})"),
                                  "rtl/register.sv": self.REGISTER.replace("<= in_i", "<= in_i + 4'(Late)")})
        self.assertNotEqual(late(1), late(2))

    def test_the_parameters_of_a_primitive_tell(self) -> None:
        def pll(by: str) -> str:
            return self.digest(**{"rtl/top.sv": "module top (input logic clk, output logic o);\n"
                                  f'  PLL #(.BY("{by}")) pll (.CLK(clk), .OUT(o));\nendmodule\n'})
        self.assertNotEqual(pll("2"), pll("4"))

    def test_the_plans_hash_is_left_out(self) -> None:
        def of(digit: str) -> str:
            return self.digest(**{"rtl/top.sv": f"package p;\n  localparam logic [63:0] PlanHash = 64'h{digit * 16};\nendpackage\n"
                                  "module top (output logic [63:0] o);\n  assign o = p::PlanHash;\nendmodule\n"})
        self.assertEqual(of("1"), of("2"))

    def test_a_design_that_cannot_be_elaborated(self) -> None:
        with self.assertRaisesRegex(Failure, "verilator --xml-only failed: .*Error"):
            self.digest(**{"rtl/register.sv": "module other; endmodule\n"})

    def test_no_top(self) -> None:
        with self.assertRaisesRegex(Failure, "board/synth.ys: names no top, expected -top and a module"):
            self.digest(**{"board/synth.ys": "read_verilog -sv rtl/top.sv\n"})


class Verdicts(MadeUp):
    def test_the_goal_is_of_the_faster_core(self) -> None:
        self.assertEqual(self.judge(self.row(1.25e6)).missed, [])
        over = ["7.69 times one core, goal 8"]
        self.assertEqual(self.judge(self.row(1.3e6, 1e6)).missed, over)
        self.assertEqual(self.judge(self.row(1e6, 1.3e6)).missed, over)

    def test_a_bound_under_the_goal_excuses_nothing(self) -> None:
        v = self.judge(self.row(2e6))  # 5 times one core where the bound is 6.25 times
        self.assertFalse(v.reached)
        self.assertAlmostEqual(v.share, 0.8)
        self.assertEqual(tables.goal_cell(self.row(2e6), v), "no, **missed**: 5.00 of 8")

    def test_before_an_sdram_queries_a_second_count(self) -> None:
        low = self.judge(self.sdram(cycles=5))  # half of its SDRAM's roofline, and ten times one core
        self.assertEqual((low.missed, low.bound_by), ([], "gatherers"))
        high = self.judge(self.sdram(cycles=9.9, golden=11e6))  # 99 % of it, and slower than one core
        self.assertEqual(high.missed, ["0.91 times one core, goal 1"])

    def test_the_bound_that_binds_has_the_most_cycles(self) -> None:
        self.assertEqual(own_bound(self.sdram(cycles=8.1))[1], "SDRAM")
        self.assertEqual(own_bound(self.sdram(cycles=7.9))[1], "gatherers")

    def test_the_ports_of_the_photon_memory_bind_where_they_need_more(self) -> None:
        self.assertEqual(own_bound(self.row(ports_cycles=8.5)), (100e6 / 8.5, "photon memory"))
        self.assertEqual(own_bound(self.row(ports_cycles=7.9)), (100e6 / 8, "gatherers"))
        row = self.row(ports_cycles=8.5)
        self.assertIn("| 11.76 (photon memory) | 85 % | 12.50 | 11.76 | – |", tables.bound_table([(row, self.judge(row))]))
        self.assertIn("8.50 cycles of its ports: 11.76 Mquery/s. Bound by the photon memory.", page.arithmetic([(row, self.judge(row))]))

    def test_a_clock_that_is_missed_fails_the_row(self) -> None:
        v = self.judge(self.sdram(reached=97.06))
        self.assertFalse(v.reached)
        self.assertEqual(v.missed, ["clk_sdram reaches 97.1 MHz of 100"])
        self.assertIn("| clk_sdram 97.1 (97.1 – 97.1) of 100 **missed** |", tables.top_table([(self.sdram(reached=97.06), v)]))
        slow = self.row(clocks={CORE_CLOCK: {"median": 49, "low": 48, "high": 50, "constraint": 50.0}})
        self.assertEqual(tables.goal_cell(slow, self.judge(slow)), "no, **missed**: clk reaches 49.0 MHz of 50")

    def test_a_clock_that_nobody_recorded_is_said(self) -> None:
        row = self.sdram()
        row["clocks"] = None
        self.assertEqual(tables.goal_cell(row, self.judge(row)), "yes, the SDRAM's clock not recorded")

    def test_what_reordering_gains_is_judged_apart(self) -> None:
        v = self.judge(self.sdram(gain=3.9))
        self.assertTrue(v.reached)
        self.assertEqual(v.missed, ["reordering gains 3.90, goal 4"])

    def test_a_row_from_sdram_reaches_a_share_of_what_binds_it(self) -> None:
        near = self.sdram(cycles=8.4)
        v = self.judge(near)
        self.assertEqual((v.reached, v.missed), (True, ["84 % of the bound by the SDRAM, goal 85 %"]))
        self.assertIn("| 84 % (goal 85 %) **MISSED** |", tables.bound_table([(near, v)]))
        self.assertEqual(tables.share_cell(dataclasses.replace(v, share=0.848)), "84.8 % (goal 85 %) **MISSED**")
        self.assertEqual(self.judge(self.sdram(cycles=8.6)).missed, [])
        self.assertEqual(self.judge(self.sdram(cycles=7, cycles_per_gather=10.1)).missed, ["79 % of the bound by the gatherers, goal 80 %"])
        self.assertIsNone(self.judge(self.row()).share_goal)

    def test_the_parts_bounds(self) -> None:
        v = self.judge(self.sdram())
        self.assertEqual(v.part, {"DP16KD": 18.75e6, "LUT4": 75e6, "MULT18X18D": 37.5e6, "SDRAM pins": 12.5e6})
        self.assertEqual(v.part_by, "SDRAM pins")
        self.assertEqual(self.judge(self.sdram(reached=96)).part["SDRAM pins"], 12e6)

    def test_both_rooflines_stand_on_the_page(self) -> None:
        row = self.sdram(cycles=11)  # 8 of its 11 cycles are lines
        self.assertIn("| 9.09 (SDRAM) | 110 % (goal 85 %) | 12.50 | – | 9.09 | 12.50 |", tables.bound_table([(row, self.judge(row))]))

    def test_rows_of_several_machines_are_told_apart(self) -> None:
        def judged(*rows: Row) -> list[tuple[Row, Verdict]]:
            return [(row, self.judge(row)) for row in rows]
        self.assertEqual(page.made_on(judged(self.row(), self.row(plan="q"))), "One core of: a core. Yosys 1.\n")
        self.assertEqual(page.made_on(judged(self.row(), self.row(plan="q", processor="another"), self.row(plan="r"))),
                         "One core of: a core for `p`, `r`; another for `q`. Yosys 1.\n")

    def test_rows_of_several_tools_are_told_apart(self) -> None:
        judged = [(row, self.judge(row)) for row in (self.row(), self.row(plan="q", versions=["Yosys 2", "nextpnr 3"]))]
        self.assertEqual(page.made_on(judged), "One core of: a core. Yosys 1 for `p`; Yosys 2, nextpnr 3 for `q`.\n")

    def test_what_a_row_was_to_gain(self) -> None:
        goals = GainGoals("c0ffee", {"block_ram": 1.5, "sdram": 1.2},
                          {"p": Growth(before=(5, 8), times=(2, 1.5), or_gatherers=(0, 0)),
                           "more": Growth(before=(5, 8), times=(2, 1.5), or_gatherers=(0, 2))})
        cases: list[tuple[Row, list[str], str]] = [
            (self.row(), [], "5.00 | 2.00 | 2 | 10.00 | 1.5 | yes |"),
            (self.row(within_mean=True), ["1.25 times the rate of c0ffee, goal 1.5"], "no, **MISSED**: 1.25 times the rate of c0ffee, goal 1.5 |"),
            (self.row(plan="more", within_mean=True), [], "8.00 | 1.25 | 1.5 | 10.00 | 1.5 | yes: 2 gatherers |"),
            (self.row(plan="more", within_mean=True, gatherers=1), ["1.25 times the rate of c0ffee, goal 1.5"], "**MISSED**"),
            (self.row(plan="more", cycles_per_gather=11), ["1.82 times the rate of c0ffee, goal 2"], "**MISSED**"),
            (self.row(golden=7e6), ["1.43 times golden on one core, goal 1.5"], "**MISSED**"),
            (self.sdram(plan="other", golden=8e6), [], "| – | – | – | 1.25 | 1.2 | yes |"),
            (self.sdram(plan="other", golden=9e6), ["1.11 times golden on one core, goal 1.2"], "**MISSED**"),
            (self.sdram(plan="other", reached=99), [], "no, **MISSED**: clk_sdram reaches 99.0 MHz of 100 |"),
        ]
        for row, missed, cell in cases:
            with self.subTest(cell):
                self.assertEqual(judge_gain(row, goals).missed, missed)
                self.assertIn(cell, tables.gain_table([(row, self.judge(row))], goals))

    def test_a_plan_without_a_goal(self) -> None:
        with self.assertRaisesRegex(Failure, r"goals.toml: headline.times_core.block_ram.9 is missing"):
            self.judge(self.row(k=9))

    def test_a_row_of_the_page(self) -> None:
        row = self.row()
        self.assertEqual(tables.goal_table([(row, self.judge(row))]).splitlines()[2],
                         "| p | 8 | none | 10.00 | 0.50 (0.45 – 0.55) nanoflann | 1.00 (0.90 – 1.10) | 20.00 (18.18 – 22.22) | "
                         "10.00 (9.09 – 11.11) | 8 | yes |")
        self.assertEqual(tables.top_table([(row, self.judge(row))]).splitlines()[2],
                         "| p | 2 | 100.0 (95.0 – 101.0) of 50 | – | 1, 2, 3 | `dddddddddddd` | 4.6 | DP16KD 104 of 208 |")
        row["clocks"] = {"$glbnet$clk": {"constraint": 110.0, "median": 100.0, "low": 95.0, "high": 101.0}}
        row["clock_mhz"] = 110.0
        self.assertIn("| 100.0 (95.0 – 101.0) of 110 **missed** | – |", tables.top_table([(row, self.judge(row))]))
        self.assertIn("| 1, 2, 3; not routed: 4, 6 |", tables.top_table([(self.row(unrouted=[4, 6]), self.judge(row))]))
        row = self.row()
        self.assertEqual(page.arithmetic([(row, self.judge(row))]),
                         "- `p`, no radius: 12.0 nodes, 3.5 leaves, 16.0 insertions a query: 16.0 cycles of a gatherer's lists; "
                         "2 x 100.0 MHz: 12.50 Mquery/s. Photon memory: 4.00 cycles of its ports: 25.00 Mquery/s. "
                         "Bound by the gatherers.\n")

    def test_the_port_of_a_gatherer_that_is_busiest(self) -> None:
        for bound, named in ((12.0, "tree"), (6.0, "tree, 2 a cycle"), (16.0, "lists"), (4.0, "lists, 4 a cycle"), (9.0, "sums"),
                             (4.5, "sums, 2 a cycle"), (14.0, "lanes, 4 cycles a leaf"), (7.0, "lanes, 2 cycles a leaf")):
            row = self.row()
            row["cost"]["bound"] = bound
            self.assertEqual(page.busiest_port(row), named)


class Neighbours(MadeUp):
    """All cores, size, variants and what others published."""

    def test_all_cores_and_size(self) -> None:
        row = self.row()
        self.assertEqual(board_for_size(row, self.judge(row)), 500000)
        self.assertEqual(tables.size_table([(row, self.judge(row))]).splitlines()[2],
                         "| p | none | 10.00 | 2.00 (1.80 – 2.20) | 2 | 5.00 (4.55 – 5.56) | 20,000 | 500,000 |")
        self.assertIn("Golden's threads had 99 to 99 % of them", page.share_text([(row, self.judge(row))]))

    def test_what_was_not_recorded_is_a_dash(self) -> None:
        row = self.row(lut_eq=None, all_cores=None, recall=None)
        self.assertEqual(tables.size_table([(row, self.judge(row))]).splitlines()[2], "| p | none | 10.00 | – | – | – | – | – |")
        self.assertEqual(tables.recall_cell(row), "–")
        self.assertIn("not timed for any row", page.share_text([(row, self.judge(row))]))

    def test_a_core_without_a_range_gives_a_multiple_without_one(self) -> None:
        self.assertEqual(tables.times_cell(10e6, {"least": None, "median": 2e6, "most": None, "runs": 7}), "5.00")

    def test_a_variant_has_no_goal_but_its_clocks(self) -> None:
        row = self.row(50e6, shows="something", k=1)
        v = self.judge(row)
        self.assertEqual((v.goal, v.missed, v.reached, tables.goal_cell(row, v)), (None, [], True, "none"))
        slow = self.row(k=1, shows="something", clocks={CORE_CLOCK: {"median": 49, "low": 48, "high": 50, "constraint": 50.0}})
        self.assertEqual(tables.goal_cell(slow, self.judge(slow)), "none, **missed**: clk reaches 49.0 MHz of 50")

    def test_a_row_of_a_variant(self) -> None:
        row = self.row(shows="something", leaf_limit=4, recall=0.91234)
        self.assertEqual(tables.variant_table([(row, self.judge(row))]).splitlines()[2],
                         "| p | 8 | none | 4 | 0.9123 | 10.00 | 0.50 (0.45 – 0.55) nanoflann | 1.00 (0.90 – 1.10) | 2.00 (1.80 – 2.20), "
                         "2 threads | 20.00 (18.18 – 22.22) | 10.00 (9.09 – 11.11) | 500,000 |")
        exact = self.row(shows="something", k=1)
        self.assertIn("| p | 1 | none | no limit | 1.0000 |", tables.variant_table([(exact, self.judge(exact))]))

    def test_a_variant_that_nobody_measured_says_so(self) -> None:
        first = variant_names()[0]
        self.assertIn(f"; not measured, `make headline PLAN={first} HEADLINE_FLAGS=--page` does.", page.variants_text([]))
        row = self.row(plan=first, shows="something")
        self.assertNotIn(f"PLAN={first}", page.variants_text([(row, self.judge(row))]))

    def test_predecessors_say_what_they_were_measured_against(self) -> None:
        lines = tables.predecessors_table().splitlines()
        self.assertEqual(lines[0], "| source | what it does | its figure | measured against | exact |")
        self.assertGreater(len(lines), 2)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "p.toml")
            path.write_text('[[predecessor]]\nsource = "a"\ndoes = "b"\nfigure = "100 times"\nexact = "yes"\n')
            with self.assertRaisesRegex(Failure, "p.toml: against is missing, expected a text"):
                tables.predecessors_table(path)


def rendered(scale: float = 1, pixels: str = "p") -> dict[str, Any]:
    """What render --json says: 4 s of a frame, 1 of them gathers; wall is twice CPU."""
    unit = {"wall": scale, "cpu": 0.5 * scale}
    return {"width": 128, "height": 64, "spp": 4, "gather_rays": 16, "photons": 1000, "caustic_photons": 0, "k": 8, "pixels_sha256": pixels,
            "units": {"photon_gatherer": {"queries": 5000000}},
            "unit_seconds": {ON_A_BOARD[0]: {"wall": 0.75 * scale, "cpu": 0.375 * scale}, ON_A_BOARD[1]: {"wall": 0.25 * scale, "cpu": 0.125 * scale},
                             "cdf_sampler": unit},
            "phases": [{"phase": "photons", "wall": scale, "cpu": 0.5 * scale}, {"phase": "final gather", "wall": 3 * scale, "cpu": 1.5 * scale},
                       {"phase": "write", "wall": 100, "cpu": 100}]}


class Images(MadeUp):
    """5 million gathers: half a second of a board that does 10 Mquery/s, 1087 s of a link that brings 4,600 a second."""

    def image(self) -> ImageTime:
        goals = headline_goals().images
        return image_time(Path("scenes/a.xml"), goals, [rendered(s) for s in (1, 2, 4)], [rendered(s) for s in (2, 1, 1)], 2, "a core")

    def test_one_core_by_cpu_and_all_by_the_wall(self) -> None:
        image = self.image()
        self.assertEqual(image["one"], {"threads": 1, "runs": 3, "frame": {"least": 2, "median": 4, "most": 8},
                                        "gathers": {"least": 0.5, "median": 1, "most": 2}, "host": {"least": 1.5, "median": 3, "most": 6}})
        self.assertEqual(image["all"]["frame"], {"least": 4, "median": 4, "most": 8})
        self.assertEqual((image["queries"], image["busy"], image["scene"]), (5000000, 2, "a"))

    def test_images_that_differ(self) -> None:
        with self.assertRaisesRegex(Failure, "a.xml: its images differ from run to run"):
            image_time(Path("a.xml"), headline_goals().images, [rendered()], [rendered(1, "q")], 2, "")

    def test_with_the_link_and_without(self) -> None:
        row = self.row()
        self.assertEqual(tables.image_cells(self.image(), row, self.judge(row)),
                         ["a", "5,000,000", "4.00 (2.00 – 8.00)", "1.00 (0.50 – 2.00)", "4.00 (4.00 – 8.00)", "1.00 (1.00 – 2.00)", "0.50",
                          "3.50 (2.00 – 6.50)", "3.50 (3.50 – 6.50)", "1087", "1089.96 (1089.96 – 1092.96)"])
        fast = self.row(uart=20e6)
        self.assertEqual(tables.image_cells(self.image(), fast, self.judge(fast))[-1], "3.50 (3.50 – 6.50)")

    def text(self, pictures: list[ImageTime], row: Row) -> str:
        return page.images_text(pictures, [(row, self.judge(row))], headline_goals(), {"baud": 2e6, "down": 15.3, "up": 43.6})

    def test_the_binding_link_is_said(self) -> None:
        name = headline_goals().images.plan
        self.assertIn("Over the UART the link binds: it brings a query in 217 µs, the engine answers one in 0.10 µs.",
                      self.text([self.image()], self.row(plan=name, within_mean=True)))
        self.assertNotIn("binds", self.text([self.image()], self.row(plan=name, within_mean=True, uart=20e6)))

    def test_what_is_missing_is_said(self) -> None:
        self.assertIn('Not measured; `make headline HEADLINE_FLAGS="--images-only --page"` does.', self.text([], self.row()))
        self.assertIn("no row is of `", self.text([self.image()], self.row()))

    def test_the_frame_has_the_lines_of_its_plan(self) -> None:
        goals = headline_goals().images
        options = render_options(HEADLINE / f"{goals.plan}.toml", goals)
        self.assertEqual(options[:2], ["--size", f"{goals.width}x{goals.height}"])
        self.assertTrue(any(word.startswith("photon.position_bits=") for word in options))

    def test_scenes_and_threads_take_turns(self) -> None:
        goals = ImageGoals((ROOT / "scenes/a.xml", ROOT / "scenes/b.xml"), "sdram_k16", 8, 8, 1, 1)
        asked: list[tuple[str, bool]] = []

        def render(scene: Path, options: list[str], threads: int, folder: Path) -> dict[str, Any]:
            asked.append((scene.stem, threads == 1))
            return rendered()
        with mock.patch.object(images, "render", render), mock.patch("os.sched_getaffinity", lambda _: {0, 1}), \
                contextlib.redirect_stdout(io.StringIO()):
            times = time_images(goals, "a core", 2)
        self.assertEqual(asked, 2 * [("a", True), ("a", False), ("b", True), ("b", False)])
        self.assertEqual([(image["scene"], image["all"]["threads"]) for image in times], [("a", 2), ("b", 2)])

    def test_a_real_frame(self) -> None:
        """What the program says today: a small frame, of a scene that needs no generated file."""
        with tempfile.TemporaryDirectory() as folder:
            scene = Path(folder, "box.xml")
            scene.write_text(BOX)
            options = ["--size", "4x4", "--spp", "1", "--gather-rays", "1", "--photons", "64", "--caustic-photons", "64"]
            said = images.render(scene, options, 1, Path(folder))
            time = image_time(scene, headline_goals().images, [said], [said], 2, "")
        self.assertGreater(time["queries"], 0)
        self.assertGreater(time["one"]["gathers"]["median"], 0)
        self.assertGreater(time["one"]["host"]["median"], 0)


class Page(MadeUp):
    """The first lines, and what --check refuses."""

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name, "headline.md")
        self.path.write_text("<!-- summary -->\n<!-- end of summary -->\n<!-- report -->\n<!-- end of report -->\n"
                             "<!-- images -->\n<!-- end of images -->\n")
        self.data: Data = {"board": "ulx3s-85f", "replay": None, "images": [], "link": {"baud": 2e6, "down": 15.3, "up": 43.6},
                           "rows": [self.row(), self.row(11e6, plan="q"), self.row(plan="r", rejected="slower")]}

    def text(self, stale: set[str] | None = None) -> str:
        page.write_page(page.page_texts(self.data, headline_goals(), stale or set()), self.path)
        return self.path.read_text()

    def check(self, **today: str) -> None:
        digests = {name: "d" * 64 for name in ("p", "q", "r")}
        page.check_page(self.data, headline_goals(), {**digests, **today}, self.path)

    def test_it_opens_with_how_many_rows_reach_their_goal(self) -> None:
        self.assertEqual(self.text().splitlines()[1], "**1 of 2 rows reach their goal (`p`); 1 is slower than one core of golden.**")

    def test_of_a_plan_that_reaches_its_goal_in_part_the_rows_are_named(self) -> None:
        self.data["rows"][1]["plan"] = "p"
        self.data["rows"][1]["within_mean"] = True
        self.assertIn("rows reach their goal (`p` without a radius);", self.text().splitlines()[1])

    def test_a_prediction_of_an_earlier_fit_fails_the_check(self) -> None:
        predicted = copy.deepcopy(self.data)
        check_predictions(self.data, predicted)
        predicted["rows"][1]["fits"]["LUT4"] += 1
        with self.assertRaisesRegex(Failure, r"headline.json: row q has room for gatherers .*; scripts/headline --render writes them"):
            check_predictions(self.data, predicted)

    def test_few_seeds_of_a_variant_are_said_and_of_a_rejected_plan_not(self) -> None:
        self.data["rows"].append(self.row(plan="v", shows="something else"))
        for row in self.data["rows"][2:]:
            row["seeds"] = [2]
        self.assertIn("Routed with fewer than three seeds: `v`.", self.text())

    def test_it_says_who_feeds_a_board(self) -> None:
        self.data["rows"][1]["replay_queries"] = 512
        self.assertIn("A board is fed by its link, 4.6 thousand queries a second, or by a replayer of 512 to 1,024 queries.",
                      self.text())

    def test_few_seeds_and_unknown_clocks_are_said(self) -> None:
        self.data["rows"][0]["seeds"] = [1]
        self.data["rows"][1] = self.sdram(plan="q")
        self.data["rows"][1]["clocks"] = None
        self.assertIn("Routed with fewer than three seeds: `p`.", self.text())
        self.assertIn("controller reached was not recorded: `q`;", self.text())
        self.assertNotIn("Of one core the median alone", self.text())
        self.data["rows"][1]["cores"]["nanoflann"]["least"] = None
        self.assertIn("Of one core the median alone was recorded: `q`.", self.text())

    def test_what_earlier_forms_did_not_record_is_said(self) -> None:
        self.assertNotIn("were not recorded", self.text())
        self.data["rows"][1]["lut_eq"] = None
        self.assertIn("Golden on all cores, recall and the LUT-equivalents of the top were not recorded: `q`.", self.text())

    def test_a_file_of_an_earlier_form(self) -> None:
        rows: Any = copy.deepcopy(self.data["rows"][:1])
        for name in ("shows", "leaf_limit", "recall", "lut_eq", "all_cores"):
            del rows[0][name]
        old = {name: value for name, value in self.data.items() if name not in ("images", "replay")}
        path = self.path.with_name("headline.json")
        path.write_text(json.dumps({**old, "rows": rows}))
        data = read_data(path)
        self.assertEqual((data["rows"][0]["all_cores"], data["rows"][0]["shows"], data["images"], data["replay"]), (None, "", [], None))

    def test_a_file_that_is_none(self) -> None:
        path = self.path.with_name("headline.json")
        for text, said in (("[]", "is a list, expected a table"), ("{}", "rows is missing, expected a list"), ('{"rows": 5}', "rows is 5, expected a list"),
                           ('{"rows": [4]}', r"rows\[0\] is 4, expected a table"), ('{"rows": [{}]}', r"(board is missing, expected a text|rows\[0\].plan is missing)")):
            path.write_text(text)
            with self.subTest(text), self.assertRaisesRegex(Failure, f"headline.json: {said}"):
                read_data(path)
        for cores, has in (({}, "nothing"), ({"photonloom": self.data["rows"][0]["cores"]["photonloom"]}, "photonloom")):
            path.write_text(json.dumps({**self.data, "rows": [{**self.data["rows"][0], "cores": cores}]}))
            with self.subTest(cores), self.assertRaisesRegex(Failure, rf"rows\[0\].cores has {has}, expected photonloom and a library"):
                read_data(path)
        self.data["rows"] = [self.row(plan="sdram_k8"), self.row(plan="README.md")]
        with self.assertRaisesRegex(Failure, r"fpga/headline.json: rows\[1\].plan is README.md, expected one of block_ram_k16, "):
            digests_today(self.data, self.path.parent)

    def test_a_plan_without_rows_fails_the_check(self) -> None:
        self.data["rows"] = [self.row(plan=name) for name in headline_names()[1:]]
        with mock.patch.object(command, "read_data", lambda: self.data), mock.patch.object(command, "digests_today", lambda *_: {}), \
                mock.patch.object(command, "predicted_today", lambda data, _: data), \
                self.assertRaisesRegex(Failure, f"headline.json: has no row of {headline_names()[0]}; scripts/headline {headline_names()[0]} --page makes it"):
            command.of_page(False, headline_goals(), self.path.parent)

    def test_a_check_makes_no_folder(self) -> None:
        works: list[Path] = []

        def digests(data: Data, work: Path) -> dict[str, str]:
            works.append(work)
            raise Failure("far enough")
        for arguments in (["--check"], ["--render"], ["--check", "--results", str(self.path.parent / "there")]):
            with mock.patch.object(sys, "argv", ["headline", *arguments]), mock.patch.object(command, "digests_today", digests), \
                    self.assertRaisesRegex(Failure, "far enough"):
                command.main()
        self.assertEqual([work.is_dir() for work in works], [False, False, True])

    def test_variants_stand_apart_and_are_not_counted(self) -> None:
        self.data["rows"].append(self.row(plan="v", shows="something", k=1))
        head, tail = self.text().split("## One neighbour, and few leaves")
        self.assertIn("**1 of 2 rows reach", head)
        self.assertNotIn("| v |", head)
        self.assertIn("| v | 1 | none |", tail)

    def test_it_ends_with_images(self) -> None:
        self.assertIn("Not measured; `make headline", self.text().split("<!-- images -->")[1])
        self.path.write_text(self.text().replace("Not measured; `make", "Measured; `make"))
        with self.assertRaisesRegex(Failure, "is not what fpga/headline.json"):
            self.check()

    def test_a_row_of_earlier_rtl_is_to_be_said(self) -> None:
        self.text()
        self.check()
        with self.assertRaisesRegex(Failure, r"headline.md: row q was routed with earlier RTL \(netlist dddddddddddd, today's is "
                                             r"eeeeeeeeeeee\), and the first lines do not say so; make headline PLAN=q "
                                             r"HEADLINE_FLAGS=--page measures it again, scripts/headline --render marks it"):
            self.check(q="e" * 64)
        self.assertIn("\nRouted with earlier RTL: `q`. ", self.text({"q"}))
        self.check(q="e" * 64)
        with self.assertRaisesRegex(Failure, "row p was routed with earlier RTL"):
            self.check(q="e" * 64, p="e" * 64)

    def test_a_row_of_todays_rtl_is_not_to_be_called_earlier(self) -> None:
        self.text({"q"})
        with self.assertRaisesRegex(Failure, "is not what fpga/headline.json and fpga/goals.toml give"):
            self.check()

    def test_a_figure_that_was_changed_by_hand(self) -> None:
        self.path.write_text(self.text().replace("| 10.00 | 0.50", "| 11.00 | 0.50"))
        with self.assertRaisesRegex(Failure, "is not what fpga/headline.json and fpga/goals.toml give"):
            self.check()

    def test_rejected_rows_alone(self) -> None:
        self.data["rows"] = self.data["rows"][2:]
        self.assertIn("No row is of a plan of `fpga/headline`.", self.text())

    def test_rejected_rows_stand_apart(self) -> None:
        head, tail = self.text().split("## Rejected plans")
        self.assertNotIn("| r | 8 |", head)
        self.assertIn("| r | 8 |", tail)

    def test_each_section_says_on_which_core_its_rows_were_timed(self) -> None:
        """And with which tools, where they are others than those of the rows above."""
        self.data["rows"] += [self.row(plan="v", shows="something", processor="a third"),
                              self.sdram(plan="c", versions=["Yosys 3"], coarse={"finer": "p", "photon_bytes": 8, "relmse": 0, "finer_bytes": 12, "finer_relmse": 0})]
        apart = "Multiples of one processor's core cannot be set against those of another's, here and below; the boards' rates can.\n"
        self.assertIn(f"\nOne core of: a core. Yosys 1.\n\n{apart}\n| plan", self.text())
        sections = {part.split("\n")[0]: part for part in self.text().split("\n## ")}
        self.assertIn("\nOne core of: a third.\n\n| plan", sections["One neighbour, and few leaves"])
        self.assertIn("\nMade with Yosys 3.\n\n| plan", sections["Fewer bytes a photon"])
        self.assertIn("\nOne core of: a core.\n\n| plan", sections["Rejected plans"])
        for row in self.data["rows"]:
            row["processor"] = "a core"
        self.assertNotIn("cannot be set against those of another's", self.text())

    def test_a_report_has_the_rows_of_its_run_alone(self) -> None:
        """The page says of every plan that is not measured how to do so; the report of a run of some plans does not."""
        for row, heading in ((self.row(plan="own"), "## Tops"), (self.row(plan="r", rejected="slower"), "## Rejected plans"),
                             (self.row(plan="v", shows="something"), "## One neighbour, and few leaves")):
            self.data["rows"] = [row]
            text = page.report(self.data, headline_goals())
            self.assertIn(f"\n{heading}\n", text)
            self.assertEqual(text.count("One core of: a core. Yosys 1.\n"), 1)
            for other in ("not measured", "No replay", "One core of: .", *({"## Tops", "## Rejected plans", "## One neighbour, and few leaves", "## Fewer bytes a photon"} - {heading})):
                self.assertNotIn(other, text)

    def test_what_a_run_is_told_to_have_missed(self) -> None:
        """A plan of the user's as one of the headline; a rejected plan is known to miss."""
        low = [self.row(4e6, plan="own"), self.row(4e6, plan="r", rejected="slower")]
        self.assertEqual([(row["plan"], miss) for row, miss in misses(low, headline_goals())],
                         [("own", "2.50 times one core, goal 8")])

    def test_why_a_plan_was_rejected_is_of_the_file_of_plans(self) -> None:
        name = rejected_names()[0]
        self.data["rows"].append(self.row(plan=name, rejected="what was said when it was measured"))
        self.assertIn(f"`{name}`: {why_rejected(name)}.\n", self.text())
        self.assertNotIn("what was said", self.text())

    def test_a_rejected_plan_stands_beside_the_one_that_it_was_tried_against(self) -> None:
        name = rejected_names()[0]
        base = base_of("rejected", name)
        for within_mean, cycles in ((False, 8.0), (True, 20.0)):
            self.data["rows"] += [self.row(plan=base, within_mean=within_mean),
                                  self.row(plan=name, rejected="r", within_mean=within_mean, cycles_per_gather=cycles)]
        self.assertIn(f"`{name}`: {why_rejected(name)}. Its rates are 1.25 (no radius) and 0.50 (mean r²) times those of `{base}`.\n", self.text())

    def test_rows_that_were_measured_again_take_their_place(self) -> None:
        new = copy.deepcopy(self.data["rows"][1])
        new["seeds"] = [7]
        merged = merge(self.data["rows"], [new])
        self.assertEqual([(r["plan"], r["seeds"]) for r in merged], [("p", [1, 2, 3]), ("q", [7]), ("r", [1, 2, 3])])

    def test_the_replay_stands_beside_the_row(self) -> None:
        played: Replay = {"plan": "p", "digest": "d" * 64, "queries": 100, "passes": 2, "cycles": 2500, "lines_per_gather": 0.5}
        self.data["replay"] = played
        self.assertIn("replays 100 queries 2 times, in the order of the pixels: 12.50 cycles and 0.50 lines a gather, 8.00 Mquery/s "
                      "at its 100.0 MHz. The engine's row has 10.00 cycles, on a whole frame.\n", self.text())
        played["digest"] = "e" * 64
        self.assertIn("The replay is of netlist `eeeeeeeeeeee`, the row's is another.", self.text())


class Rows(Folder):
    def test_put_together(self) -> None:
        plan = HeadlinePlan("p", self.write("p.toml", "[board]\nreplay_queries = 512\n"))
        own = {"plan": "p", "memory": "sdram", "k": 8, "gatherers": 2, "order": "reordered", "r2_max": 7, "cycles_per_gather": 10,
               "nodes": 1, "leaves": 2, "insertions": 3, "bound": 4, "ports_cycles": None, "memory_lines_per_gather": 0.5, "line_bytes": 64,
               "row_changes_per_gather": 0.1, "row_change_cycles": 6, "roofline_cycles": 5, "sdram_mhz": 97}
        simulated = mock.Mock(rows=[own, {**own, "order": "pixels", "reorder_gain": 5, "reorder_goal": 4}])
        top = Top("p", "d", self.work, 50.0, {"baud": 2e6, "down": 1, "up": 1}, 4600)
        facts = {"resources": {"photon_gatherer": {"ebr": 40, "lut": 8000, "dsp": 24}, "reorder_buffer": {"ebr": 18, "lut": 3640, "dsp": 2}},
                 "board_ebr": {"total": 150}, "board_ebr_of_gatherers": [110, 150, 209, 208, 240]}
        with mock.patch("flow.headline.rows.describe", return_value=facts):
            row, = rows_of(plan, top, routed(placement(1, 80, 97), placement(2, 70, 99)), simulated, {7: Timed({"photonloom": rate(1e6)}, all_cores(2e6), 4, 0.9)},
                           {"yosys": "Yosys 1"}, "a core", read_board("ulx3s-85f"))
            simulated.rows.pop()
            with self.assertRaisesRegex(Failure, "p: the simulation has no row of r2_max 7 in the pixels' order"):
                rows_of(plan, top, routed(placement(1)), simulated, {7: Timed({}, all_cores(1), 0, 1)}, {}, "", read_board("ulx3s-85f"))
        self.assertEqual((row["within_mean"], row["replay_queries"], row["seeds"], row["fmax_mhz"]["median"]), (True, 512, [1, 2], 75))
        assert row["clocks"] and row["sdram"]
        self.assertEqual((row["clocks"][SDRAM_CLOCK]["median"], row["sdram"]["mhz"], row["sdram"]["reorder_gain"]), (98, 97, 5))
        self.assertEqual((row["lut_eq"], row["leaf_limit"], row["recall"], row["all_cores"]), (20000, 4, 0.9, all_cores(2e6)))
        # Many gatherers leave out of block RAM what fewer have: four may fit where three do not.
        self.assertEqual(row["fits"], {"DP16KD": 4, "LUT4": (83640 - 3640) // 8000, "MULT18X18D": (156 - 2) // 24})
        fewer: Any = {**facts, "resources": {"photon_gatherer": {"ebr": 40, "lut": 8000, "dsp": 24}}}
        self.assertEqual(gatherers_that_fit(fewer, read_board("ulx3s-85f"))["LUT4"], 10)


class RejectedPlans(Folder):
    def test_each_is_a_plan_that_says_why(self) -> None:
        for name in rejected_names():
            with self.subTest(name):
                plan = rejected_plan(name, self.work)
                self.assertTrue(plan.path.is_file() and plan.rejected)

    def test_a_plan_without_a_reason(self) -> None:
        variants = self.write("v.toml", '[rejected.a]\nbase = "sdram_k8"\nset = []\n')
        with self.assertRaisesRegex(Failure, "v.toml: rejected.a.why is missing, expected why it is not in the headline"):
            rejected_plan("a", self.work, variants)


class Variants(Folder):
    def test_each_is_a_plan_that_shows_something(self) -> None:
        for name in variant_names():
            with self.subTest(name):
                plan = find_plan(name, self.work)
                self.assertTrue(plan.path.is_file() and plan.shows and not plan.rejected)

    def test_k_and_the_leaf_limit_make_other_netlists(self) -> None:
        """So neither can share a routed top with its base."""
        board = read_board(headline_goals().board)
        plans = [find_plan("block_ram_k8", self.work), *(find_plan(name, self.work) for name in variant_names())]
        self.assertEqual(len({plan_digest(plan, board) for plan in plans}), len(plans))

    def test_a_plan_that_shows_nothing(self) -> None:
        variants = self.write("v.toml", '[variant.a]\nbase = "sdram_k8"\nset = []\n')
        with self.assertRaisesRegex(Failure, "v.toml: variant.a.shows is missing, expected what it shows"):
            variant_plan("a", self.work, variants)


class Prepared(Folder):
    def test_of_the_package_that_is_generated_today(self) -> None:
        """Package, link and digest of a plan, none of them recorded: a file of the package that moved is missed here."""
        board = read_board(headline_goals().board)
        plan = find_plan(headline_goals().replay, self.work)
        top = prepare(plan, self.work, Routing(board, Tools([], {"yosys": "1"}), 1, 1, None, 6, "static", False))
        self.assertTrue((top.package / "rtl" / f"{board.top()}.sv").is_file())
        self.assertEqual(top.digest, plan_digest(plan, board))
        self.assertEqual(top.link["baud"], 2e6)
        self.assertTrue(1e3 < top.rate < 1e5)


class BoardReplay(Folder):
    def replay(self, signature: str, full: int = 30) -> Any:
        said = {"signature": signature, "golden_signature": "1", "golden_full": full, "gathers": 40 * replay.PASSES, "cycles": 500, "lines_per_gather": 0.5}
        plan = HeadlinePlan("p", self.write("p.toml", "[global]\nphotons = 4096\n"))
        commands: list[list[str]] = []

        def run(command: list[str]) -> str:
            commands.append(command)
            return "a warning\n" + json.dumps(said)
        with mock.patch.object(replay, "run", run), mock.patch("flow.shell.run", run), mock.patch.object(replay, "simulated_board", lambda *_: contextlib.nullcontext()):
            played = replay.replay(plan, "d", Path("s.xml"), self.work)
        self.assertIn(str(4096 - replay.SPARE_PHOTONS), commands[0])
        return played

    def test_cycles_of_all_passes(self) -> None:
        self.assertEqual(self.replay("1"), {"plan": "p", "digest": "d", "queries": 40, "passes": replay.PASSES, "cycles": 500,
                                            "lines_per_gather": 0.5})

    def test_results_that_are_not_goldens(self) -> None:
        with self.assertRaisesRegex(Failure, "p: the board's signature is 2, expected golden's 1"):
            self.replay("2")

    def test_queries_that_find_nothing(self) -> None:
        with self.assertRaisesRegex(Failure, r"p\.toml: global\.radius: none of 40 replayed queries"):
            self.replay("1", full=0)


class Processor(Folder):
    def test_the_exact_model(self) -> None:
        path = self.write("cpuinfo", "cpu family\t: 25\nmodel\t\t: 1\nmodel name\t: AMD EPYC\nstepping\t: 1\n\nmodel name\t: other\n")
        self.assertEqual(processor(path), "AMD EPYC (family 25, model 1, stepping 1)")


class SerialLink(unittest.TestCase):
    def test_of_a_recorded_package(self) -> None:
        link = link_of(RECORDED / "package", 50000)
        self.assertEqual(link.baud, 2e6)
        # A query of 88 bits is 3 words, a result of 262 with its number 10; docs/host-link.md has the frames.
        self.assertAlmostEqual(link.down, (3 * (4 + 12 / 64) + 10 * 17 / 64) * 258 / 256)
        self.assertAlmostEqual(link.up, (10 * (4 + 16 / 64) + 3 * 16 / 64) * 258 / 256)
        self.assertAlmostEqual(link.rate, 2e5 / link.up)

    def test_what_is_not_there(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            rtl = Path(folder, "rtl")
            rtl.mkdir()
            board, package = rtl / "board_pkg.sv", rtl / "photonloom_pkg.sv"
            board.write_text("endpackage\n")
            package.write_text("endpackage\n")
            with self.assertRaisesRegex(Failure, "^board_pkg.sv: has no ClocksPerBit$"):
                link_of(Path(folder), 50000)
            board.write_text("  localparam int ClocksPerBit = 25;\n")
            with self.assertRaisesRegex(Failure, "^photonloom_pkg.sv: has no GatherQueryPacketBits$"):
                link_of(Path(folder), 50000)

    def test_the_line_is_that_of_the_template(self) -> None:
        line = r"^  localparam int ClocksPerBit = (\S+);"
        of_template = re.search(line, (ROOT / "rtl/generate/templates/board_pkg.sv.in").read_text(), re.MULTILINE)
        recorded = re.search(line, (RECORDED / "package/rtl/board_pkg.sv").read_text(), re.MULTILINE)
        self.assertEqual(of_template and of_template.group(1), "@CLOCKS_PER_BIT@")
        self.assertTrue(recorded)


if __name__ == "__main__":
    unittest.main()
