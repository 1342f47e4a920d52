# SPDX-License-Identifier: Apache-2.0
"""What the sign-off reads and plants: counters, holes, mutants."""
import tempfile
import unittest
from pathlib import Path

from flow.shell import ROOT, Failure
from signoff import cover, coverage, equivalence, evidence, faults, holes, mutate, mutators, page, units
from signoff.coverage import Point


def entry(kind: str, line: int, what: str, count: int, lines: str = "", module: str = "fifo", instance: str = "a") -> str:
    keys = {"f": f"{module}.sv", "l": str(line), "n": "3", "page": f"{kind}/{module}__W3", "o": what}
    if lines:
        keys["S"] = lines
    return "C '" + "".join(f"\x01{key}\x02{value}" for key, value in {**keys, "h": instance}.items()) + f"' {count}\n"


class Coverage(unittest.TestCase):
    def read(self, *texts: str) -> coverage.Coverage:
        with tempfile.TemporaryDirectory() as folder:
            files = [Path(folder) / f"{number}.dat" for number in range(len(texts))]
            for file, text in zip(files, texts, strict=True):
                file.write_text("# SystemC::Coverage-3\n" + text)
            return coverage.read(files, coverage.Without(frozenset({"lut_ram"}), frozenset({("fifo", 12)})))

    def test_an_arm_counts_for_its_lines(self) -> None:
        found = self.read(entry("v_branch", 7, "if", 3, "7-9,12") + entry("v_branch", 7, "else", 0))
        self.assertEqual([point.line for point in found.of("line")], [7, 8, 9])
        self.assertEqual(found.holes("line"), [])
        self.assertEqual(found.holes("branch"), [Point("fifo", "branch", 7, "else")])

    def test_a_bit_has_to_change_twice_in_one_instance(self) -> None:
        once = entry("v_toggle", 4, "data[1]", 1)
        self.assertEqual(len(self.read(once, entry("v_toggle", 4, "data[1]", 1, instance="b")).holes("toggle")), 1)
        self.assertEqual(self.read(once, entry("v_toggle", 4, "data[1]", 2, instance="b")).holes("toggle"), [])

    def test_words_of_a_memory_are_no_points(self) -> None:
        found = self.read(entry("v_toggle", 4, "memory[3][1]", 0, module="lut_ram") + entry("v_toggle", 5, "read_data_o[1]", 0, module="lut_ram"))
        self.assertEqual([point.what for point in found.of("toggle")], ["read_data_o[1]"])

    def test_bundles_are_no_points(self) -> None:
        found = self.read(entry("v_toggle", 4, "all[256]", 0) + entry("v_toggle", 4, "all[1]", 0) + entry("v_toggle", 5, "part[255]", 0))
        self.assertEqual([point.what for point in found.of("toggle")], ["part[255]"])

    def test_what_is_no_counter_is_refused(self) -> None:
        with self.assertRaisesRegex(Failure, "line 2: is no counter"):
            self.read("nonsense\n")


class Holes(unittest.TestCase):
    points = [Point("fifo", "toggle", 4, f"data[{bit}]") for bit in (0, 1, 2, 7)] + [Point("fifo", "toggle", 4, "put[0][3]"), Point("fifo", "toggle", 5, "full")]

    def test_a_reason_is_of_its_bits_alone(self) -> None:
        explained, bare = holes.explain(self.points, [holes.Reason("fifo", "toggle", ("data",), 1, 7, "because")])
        self.assertEqual(holes.grouped(explained[0].points), ["`data` 1-2, 7"])
        self.assertEqual(holes.grouped(bare), ["`data` 0", "`put[0]` 3", "`full`"])

    def test_an_index_is_no_pattern(self) -> None:
        explained, _ = holes.explain(self.points, [holes.Reason("fifo", "toggle", ("put[0]", "fu*"), 0, 99, "because")])
        self.assertEqual(len(explained[0].points), 2)

    def test_reasons_of_all_units_are_read(self) -> None:
        for unit in units.names():
            every = units.modules(unit) + [f"{module}_cover" for module in cover.modules(unit)]
            for reason in holes.reasons(unit):
                self.assertIn(reason.module, every, f"{unit}: {reason.module} is no module of it")


COVER = """module m_cover #(
    parameter int unsigned W,
    parameter int unsigned Two
) (
    input logic clk_i
);
  // Said above a register, not a point.
  logic ran_q;

  // It waits,
  // for long.
  waits: cover property (@(posedge clk_i) disable iff (rst_i) a &&
      b);
  // A reset.
  reset: cover property (@(posedge clk_i) rst_i);
endmodule
"""


class Cover(unittest.TestCase):
    def test_a_point_has_a_name_and_a_reason(self) -> None:
        self.assertEqual([(named.point, named.module, named.why) for named in cover.read("m", COVER)],
                         [(Point("m_cover", "user", 12, "waits"), "m", "It waits, for long."), (Point("m_cover", "user", 15, "reset"), "m", "A reset.")])
        with self.assertRaisesRegex(Failure, "line 14: reset: expected a comment"):
            cover.read("m", COVER.replace("  // A reset.\n", ""))
        with self.assertRaisesRegex(Failure, "line 15: waits: there are two"):
            cover.read("m", COVER.replace("reset:", "waits:"))
        with self.assertRaisesRegex(Failure, "line 15: expected NAME"):
            cover.read("m", COVER.replace("reset: ", ""))

    def test_every_instance_gets_them_with_its_own_parameters(self) -> None:
        self.assertEqual(cover.bound("m", COVER), "bind m m_cover #(.W(W), .Two(Two)) cover_points (.*);\n")

    def test_points_of_all_units_are_read(self) -> None:
        for unit in units.names():
            self.assertGreaterEqual(len(cover.points(unit)), 10)
        attached = {module for unit in units.names() for module in cover.modules(unit)}
        for file in (ROOT / units.COVER).glob("*"):
            self.assertIn(file.name.removesuffix("_cover.sv"), attached, f"{file.name}: is of no module of a unit, or has another name")

    def test_a_point_that_is_never_hit_is_a_hole(self) -> None:
        found = coverage.Coverage()
        point = Point("m_cover", "user", 15, "reset")
        found.add(point, 0)
        self.assertEqual(found.holes("user"), [point])
        self.assertEqual(len(holes.explain([point], [holes.Reason("m_cover", "user", ("waits",), 0, 0, "because")])[1]), 1)
        self.assertFalse(page.figures(found)[-1].met)
        found.add(point, 1)
        self.assertEqual(found.holes("user"), [])
        self.assertTrue(page.figures(found)[-1].met)


MODULE = """// a + b in a comment
module m #(parameter int unsigned W = 3 + 1) (input logic clk_i, input logic rst_i, input logic [W-1:0] a_i, output logic [W-1:0] b_o);
  localparam int unsigned Two = W - 2;
  logic [W-1:0] sum;
  assign sum = a_i[Two-1] ? a_i + W'(1) : {2{a_i[1:0]}};
  for (genvar i = 0; i < 2; i++) begin : gen_i
    always_ff @(posedge clk_i) begin
      if (a_i == 4'd3 && !rst_i) b_o <= sum;
      if (rst_i) b_o <= '0;
    end
  end
`ifdef SYNTHESIS
  assign b_o = a_i + sum;
`else
  assign b_o = '0;
`endif
  fifo #(.Depth(2 * W)) queue (.clk_i(clk_i), .in_i(sum | a_i), .out_o(b_o));
endmodule
"""


class Mutants(unittest.TestCase):
    def test_what_is_mutated(self) -> None:
        found = [(mutant.line, mutant.what) for mutant in mutators.mutants_of(MODULE, "m.sv")]
        self.assertEqual(found, [
            (5, "choice turned round"), (5, "+ becomes -"), (5, "1 becomes 0"),
            (8, "condition negated"), (8, "condition always true"), (8, "condition never true"),
            (8, "== becomes !="), (8, "4'd3 becomes 4'd2"), (8, "&& becomes ||"), (8, "! left out"),
            (9, "'0 becomes '1"), (15, "'0 becomes '1"), (17, "| becomes &")])

    def test_without_a_choice_the_source_stays(self) -> None:
        mutants = mutators.mutants_of(MODULE, "m.sv")
        self.assertIn("a_i[Two-1] ? a_i - W'(1) :", mutators.alone(MODULE, mutants[1]))
        text = mutators.planted(MODULE, "m.sv", list(enumerate(mutants, 1)))
        self.assertEqual(text.count("chosen_mutant =="), len(mutants))
        self.assertIn("(a_i == 4'd3 && !rst_i)", text)

    def test_constants(self) -> None:
        self.assertEqual([mutators._constant(text) for text in ("0", "1", "12", "'0", "8'hff", "2'b10", "'x")],
                         ["1", "0", "11", "'1", "8'hfe", "2'b11", None])

    def test_all_sources_are_read(self) -> None:
        for unit in units.names():
            tried = mutate.draw(unit, 200, 1)
            self.assertEqual(len(tried), 200)
            self.assertEqual([entry.mutant for entry in tried], [entry.mutant for entry in mutate.draw(unit, 200, 1)])

    def test_a_survivor_without_a_reason_is_told(self) -> None:
        tried = mutate.draw(units.names()[0], 3, 1)
        tried[0].killed_by = "plan p"
        tried[1].equivalent = True
        self.assertEqual(len(mutate.explain("none", tried)), 1)
        self.assertIn("killed of those not proved equivalent | 50.00 %", mutate.section("u", tried, ["p"], 9, 1))


HALVES = """module halves(input logic clk_i, input logic on_i, input logic [1:0] a_i, input logic [1:0] b_i, output logic [2:0] sum_o);
  logic [1:0] low_q, high_q;
  always_ff @(posedge clk_i) begin
    low_q  <= a_i;
    high_q <= b_i;
    if (on_i) sum_o <= low_q + high_q;
  end
endmodule
"""
HOLDER = """module holder(input logic clk_i, input logic [1:0] a_i, output logic [2:0] sum_o);
  halves inside (.clk_i(clk_i), .on_i(1'b1), .a_i(a_i), .b_i(~a_i), .sum_o(sum_o));
endmodule
"""


class Equivalence(unittest.TestCase):
    def proved(self, was: str, now: str, module: str = "halves") -> bool | None:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            files = {"halves": folder / "halves.sv", "holder": folder / "holder.sv"}
            files["halves"].write_text(HALVES)
            files["holder"].write_text(HOLDER)
            text = files[module].read_text()
            self.assertIn(was, text)
            mutant = folder / "mutant.sv"
            mutant.write_text(text.replace(was, now))
            return equivalence.proved("yosys", "holder", module, list(files.values()), {files[module]: mutant}, folder / "out")

    def test_the_same_in_one_step(self) -> None:
        self.assertTrue(self.proved("low_q + high_q", "high_q + low_q"))
        self.assertFalse(self.proved("low_q + high_q", "high_q - low_q"))

    def test_an_input_has_the_constant_that_the_unit_gives_it(self) -> None:
        self.assertTrue(self.proved("if (on_i)", "if (1'b1)"))
        self.assertFalse(self.proved("if (on_i)", "if (!on_i)"))

    def test_what_comes_to_an_instance_is_compared(self) -> None:
        self.assertTrue(self.proved("~a_i", "a_i ^ 2'b11", "holder"))
        self.assertFalse(self.proved("~a_i", "a_i", "holder"))

    def test_registers_that_differ_are_followed(self) -> None:
        self.assertTrue(self.proved("low_q  <= a_i;\n    high_q <= b_i;", "low_q  <= b_i;\n    high_q <= a_i;"))
        self.assertFalse(self.proved("low_q  <= a_i;", "low_q  <= b_i;"))


class Faults(unittest.TestCase):
    def test_rows_join_a_page(self) -> None:
        rows = [faults.Row("byte lost", "link", 1430, 1023, 407, 0, "41.4 ms"),
                faults.Row("reset in any of 400 cycles of work", "`a`", 5, 5, 0, 0, "4 cycles")]
        text = f"before\n{faults.BEGIN}\n\n{faults.section(rows)}{faults.END}\nbehind\n"
        lost, flipped = (faults.Row("byte lost", "link", 7, 7, 0, 0, "1 ms"),
                         faults.Row("one bit flipped", "`b`", 3, 2, 1, 0, "then, at 2 cycles"))
        self.assertEqual(faults.joined(text, []), rows)
        self.assertEqual(faults.joined(text, [flipped, lost]), [lost, flipped, rows[1]])
        self.assertRaises(Failure, faults.row_of_text, "| byte lost | link | 1 | 2 | 41.4 ms |")


class Evidence(unittest.TestCase):
    def test_proofs_and_planted_bugs_are_found(self) -> None:
        for unit in units.names():
            self.assertTrue(evidence.proofs(set(units.modules(unit))))
            self.assertTrue(evidence.hand_mutants(unit))

    def test_figures_are_rounded_down(self) -> None:
        self.assertIn("99.99 %", page.row(page.Figure("line", 99999, 100000)))
        self.assertIn("MISSED", page.row(page.Figure("toggle", 89, 100)))


if __name__ == "__main__":
    unittest.main()
