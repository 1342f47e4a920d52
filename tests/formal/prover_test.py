# SPDX-License-Identifier: Apache-2.0
"""What the runner of proofs decides by itself: which tables it takes, what counts as a path and what as passed; what a bound's
script says, and when golden agrees with it."""
import json
import shutil
import tempfile
import unittest
import unittest.mock
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

from flow.shell import ROOT, Failure
from prover import bounds, commands, elastic, engines, formula, golden, model, paths, properties, report, script, sources, steps, tools
from prover.properties import Property

ENTRY = """
[[property]]
name = "a"
module = "m"
says = "s"
harness = "h"
method = "{method}"
bug = "b"
{more}
"""


def table(text: str) -> list[Property]:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "properties.toml"
        file.write_text(text)
        return properties.load(file)


class Table(unittest.TestCase):
    def refused(self, text: str, word: str) -> None:
        with self.assertRaisesRegex(Failure, word):
            table(text)

    def test_reads(self) -> None:
        (read,) = table(ENTRY.format(method="bmc", more="depth = 7"))
        self.assertEqual((read.name, read.depth, read.unbounded), ("a", 7, False))

    def test_refuses(self) -> None:
        self.refused("", "found none")
        self.refused(ENTRY.format(method="guess", more=""), "method: expected one of")
        self.refused(ENTRY.format(method="pdr", more="depth = 7"), "depth")
        self.refused(ENTRY.format(method="bmc", more=""), "depth")
        self.refused(ENTRY.format(method="induction", more=""), "depth")
        self.refused(ENTRY.format(method="path", more=""), "paths")
        self.refused(ENTRY.format(method="pdr", more="speed = 1"), "speed: no such key")
        self.refused(ENTRY.format(method="pdr", more="") * 2, "stands twice")
        self.refused(ENTRY.format(method="pdr", more='step = "power"'), "gappa alone")
        self.refused(ENTRY.format(method="gappa", more=""), "gappa alone")
        self.refused(ENTRY.format(method="gappa", more='step = "s"\nranges = { m = [3, 2] }'), "LEAST, GREATEST")


class Sources(unittest.TestCase):
    def of(self, package: str) -> list[Path]:
        (read,) = table(ENTRY.format(method="pdr", more=""))
        with tempfile.TemporaryDirectory() as folder:
            for name, text in (("harness/h.sv", "// package: p.sv\n// sources: m.sv\nm dut(); // photonloom_pkg::Remark\n"), ("p.sv", package),
                               ("m.sv", "localparam int Units = photonloom_pkg::Reciprocals; photonloom_pkg::word_t w;")):
                path = Path(folder, "tests/formal" if name.startswith("harness") else "", name)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
            return sources.of(Path(folder), read)

    def test_a_package_has_what_its_users_read(self) -> None:
        word = "typedef struct packed { logic a; } word_t;"
        self.assertEqual([path.name for path in self.of(f"localparam int unsigned Reciprocals = 1; {word}")], ["p.sv", "m.sv", "h.sv"])
        with self.assertRaisesRegex(Failure, "p.sv: has no Reciprocals, which m.sv reads"):
            self.of(f"localparam int unsigned ReciprocalBits = 1; {word}")


class Model(unittest.TestCase):
    def test_a_name_that_yosys_makes_up_is_an_error(self) -> None:
        said = "a.sv:3: Warning: Identifier `\\gen_a[0]' is implicitly declared.\n"
        with unittest.mock.patch.object(model.commands, "run", return_value=commands.Finished(0, said, 1.0, True)):
            with self.assertRaisesRegex(Failure, "implicitly declared.*make formal takes a newer one"):
                model.aiger(tools.Tools("yosys", "", ""), Path(), table(ENTRY.format(method="bmc", more="depth = 3"))[0], [], Path("m"), Path("log"))


class Paths(unittest.TestCase):
    def leads(self, kind: str) -> bool:
        cell = {"type": kind, "port_directions": {"A": "input", "Y": "output"}, "connections": {"A": [2], "Y": [3]}}
        module = {"cells": {"c": cell}, "netnames": {"a": {"bits": [2]}, "y": {"bits": [3]}}}
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "netlist.json"
            file.write_text(json.dumps({"modules": {"top": module}}))
            return paths.leads(file, "top", "a", "y")

    def test_gates_lead_and_registers_do_not(self) -> None:
        self.assertTrue(self.leads("$_NOT_"))
        self.assertFalse(self.leads("$_DFF_P_"))


class Verdicts(unittest.TestCase):
    def test_only_a_proof_whose_bug_is_refuted_passes(self) -> None:
        (read,) = table(ENTRY.format(method="pdr", more=""))
        holds, fails = engines.Outcome("holds", None, 1.0), engines.Outcome("fails", 3, 1.0)
        undecided = engines.Outcome("undecided", 9, 1.0)
        self.assertTrue(report.Result(read, holds, fails).passed)
        for sound, planted in ((holds, holds), (holds, undecided), (holds, None), (undecided, None), (fails, None)):
            self.assertFalse(report.Result(read, sound, planted).passed)
        self.assertIn("UNDECIDED", report.Result(read, undecided, None).verdict)

    def test_the_page_has_a_row_of_each_property_and_none_of_another(self) -> None:
        before, = table(ENTRY.format(method="pdr", more=""))
        now = replace(before, says="t")
        holds, fails = engines.Outcome("holds", None, 1.0), engines.Outcome("fails", 3, 1.0)
        with tempfile.TemporaryDirectory() as folder:
            page = Path(folder, "formal.md")
            page.write_text(f"above\n{report.BEGIN}\n{report.END}\nbelow\n")
            report.write_page(page, [report.Result(before, holds, fails)], [before])
            report.check_page(page, [before])
            with self.assertRaisesRegex(Failure, r"formal.md: has 0 rows of a as it is now, expected one; scripts/formal a "):
                report.check_page(page, [now])
            with self.assertRaisesRegex(Failure, r"formal.md: has 0 rows of a as it is now"):
                report.check_page(page, [replace(before, parameters={"Depth": 9})])
            with self.assertRaisesRegex(Failure, r"formal.md: has a row of no property, expected none: `m` \| s \|  \| pdr \| `b`$"):
                report.check_page(page, [])
            report.write_page(page, [report.Result(now, holds, fails)], [now], whole=False)
            report.check_page(page, [now])
            self.assertTrue(page.read_text().startswith("above\n") and page.read_text().endswith("\nbelow\n"))


class Formulas(unittest.TestCase):
    def value(self, text: str, **known: int) -> Fraction:
        return formula.rational(formula.value(formula.parse(text), known))

    def test_are_exact(self) -> None:
        self.assertEqual(self.value("2^-m / (1 - 2^-m)", m=2), Fraction(1, 3))
        self.assertEqual(self.value("(3 / sqrt(2) * 2^(1 - b))^2", b=3), Fraction(9, 32))
        self.assertEqual(self.value("1 + 2^(p - 50)", p=4), 1 + Fraction(1, 1 << 46))
        for text in ("sqrt(2)", "sqrt(2) + 1", "2^(1/2)", "x", "f(1)", "1 +"):
            with self.assertRaises(Failure):
                self.value(text)

    def test_literals_of_gappa(self) -> None:
        self.assertEqual(formula.literal(Fraction(-3, 8)), "-3b-3")
        self.assertEqual(formula.literal(Fraction(1, 28)), "(1 / 28)")
        number = formula.toward_zero(Fraction(1, 3))
        digits, exponent = number.split("b")
        cut = int(digits) * Fraction(2) ** int(exponent)
        self.assertTrue(Fraction(1, 3) - Fraction(1, 1 << 60) < cut < Fraction(1, 3))

    def test_words_that_are_not_known_stay(self) -> None:
        self.assertEqual(script.fill("x = $(bound) + $(4^a);", {"a": 2}, "(1 + 4^a) / total"), "x = (17b0 / total) + 16b0;")


SCRIPT = r"""
@down = fixed<0,dn>;
sum = float<ieee_64,ne>(x + 1b-1);  # golden's
code = down(sum);
{ @FIX(x, -2) /\ x in [0, $(2^m)] -> |code - x| <= $(bound) }
code - x -> (code - sum) + ((sum - (x + 1b-1)) + 1b-1);
"""


class Scripts(unittest.TestCase):
    def read(self, text: str = SCRIPT, bound: str = "1/2") -> script.Script:
        return script.read(script.fill(text, {"m": 3}, bound))

    def test_roundings(self) -> None:
        for operator, number, due in (("fixed<0,dn>", Fraction(-1, 2), -1), ("fixed<0,up>", Fraction(1, 2), 1),
                                      ("fixed<0,na>", Fraction(1, 2), 1), ("fixed<0,na>", Fraction(-1, 2), -1),
                                      ("fixed<0,ne>", Fraction(1, 2), 0), ("fixed<1,dn>", Fraction(3), 2),
                                      ("float<ieee_64,ne>", 1 + Fraction(1, 1 << 53), 1)):
            self.assertEqual(script.rounded(operator, number), due)
        with self.assertRaises(Failure):
            script.rounded("fixed<0,od>", Fraction(1))

    def test_run_as_they_say(self) -> None:
        read = self.read()
        self.assertEqual(read.inputs, ["x"])
        self.assertEqual(read.evaluate(read.definitions["code"], {"x": Fraction(5, 2)}), 3)
        self.assertEqual(script.search(read, 10), script.Tried(33, None))

    def test_an_input_that_breaks_the_bound_is_found(self) -> None:
        self.assertIsNotNone(script.search(self.read(bound="3/8"), 10).breaks)
        self.assertIsNotNone(script.search(self.read(SCRIPT.replace("ne>(x + 1b-1)", "ne>(x)").split("code - x ->")[0]), 10).breaks)

    def test_hypotheses_that_nothing_satisfies_show_nothing(self) -> None:
        self.assertEqual(script.search(self.read(SCRIPT.replace("->", "/\\ x in [-2, -1] ->", 1)), 10).inputs, 0)

    def test_hint_that_is_no_equality_is_refused(self) -> None:
        with self.assertRaisesRegex(Failure, "not equal"):
            script.search(self.read(SCRIPT.replace("+ 1b-1);\n", "- 1b-1);\n")), 10)


class Steps(unittest.TestCase):
    def test_steps_and_properties_name_each_other(self) -> None:
        (read,) = table(ENTRY.format(method="gappa", more='step = "power"'))
        read = replace(read, name="bound_a")
        shown = {"power": "Gappa: bound_a"}
        steps.check(steps.Bounds({}, {}, shown), [read])
        for wrong in ({"power": "Gappa: bound_b"}, {"power": "not by machine: a sum"}, {"flux": "Gappa: bound_a"}, {"power": "by hand"}):
            with self.assertRaises(Failure):
                steps.check(steps.Bounds({}, {}, wrong), [read])


class Golden(unittest.TestCase):
    def setUp(self) -> None:
        self.proved = next(proved for proved in properties.load(ROOT / "tests/formal/properties.toml") if proved.name == "bound_reciprocal")

    def check(self, mantissa: int, widths: tuple[int, int] = (8, 24)) -> int:
        lines = [f"line|gather.reciprocal_bits|{widths[0]}|{widths[1]}"]
        for w in range(8, 25):
            # 3 / 2 and what a cut would show.
            lines += [f"bound_reciprocal|W={w}|x=3b{w - 1}|R={(1 << 2 * w) // (3 << w - 1)}",
                      f"bound_reciprocal|W={w}|x={(3 << w) + 1}b-1|R={(1 << 2 * w) // ((3 << w - 1) + 1)}"] * 2
        lines.append(f"bound_reciprocal|W=8|x=256|R={mantissa}")
        with tempfile.TemporaryDirectory() as folder:
            return golden.check(ROOT, self.proved, golden.read("\n".join(lines)), Path(folder))

    def test_equal_numbers_pass_and_others_not(self) -> None:
        self.assertEqual(self.check(256), 69)
        with self.assertRaisesRegex(Failure, "R is 255 in golden, 256 in the script"):
            self.check(255)
        with self.assertRaisesRegex(Failure, "W goes from 8 to 24"):
            self.check(256, (8, 25))

    def test_too_few_values_do_not_pass(self) -> None:
        with self.assertRaisesRegex(Failure, "0 values of golden"):
            golden.check(ROOT, self.proved, golden.read(""), Path())

    def test_numbers(self) -> None:
        self.assertEqual([golden.number(text) for text in ("-3", "0x1.8p+1", "1/3", "5b-1", "0x1p-1~1")],
                         [-3, 3, Fraction(1, 3), Fraction(5, 2), Fraction(-1, 2)])


@unittest.skipUnless(shutil.which("gappa"), "gappa is not installed")
class Gappa(unittest.TestCase):
    def outcome(self, text: str, bound: str, planted: bool = False) -> engines.Outcome:
        (read,) = table(ENTRY.format(method="gappa", more='step = "power"\nranges = { m = [3, 4] }'))
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            (folder / "bounds").write_text(f'STEP("power", "{bound}", "", "")\n')
            (folder / "a.g").write_text(text)
            run = bounds.refute if planted else bounds.prove
            return run(tools.find(ROOT, {"gappa"}), folder, read, [Path("bounds"), Path("a.g")], folder, 60)

    def test_proves_a_bound_and_nothing_tighter(self) -> None:
        self.assertEqual(self.outcome(SCRIPT, "1/2").verdict, "holds")
        self.assertEqual(self.outcome(SCRIPT, "3/8").verdict, "fails")

    def test_a_bug_is_refuted_by_an_input(self) -> None:
        refuted = self.outcome(SCRIPT.replace("ne>(x + 1b-1)", "ne>(x)"), "1/2", planted=True)
        self.assertEqual((refuted.verdict, refuted.note), ("fails", "m = 3: x = 0.75"))
        # Not proved is not refuted: without the hint nothing is found either way.
        self.assertEqual(self.outcome(SCRIPT.split("code - x ->")[0].replace("@FIX(x, -2) /\\ ", ""), "1/2 + 2^(m - 53)", planted=True).verdict,
                         "undecided")

    def test_what_gappa_takes_for_granted_is_refused(self) -> None:
        with self.assertRaisesRegex(Failure, "not trivially equal"):
            self.outcome(SCRIPT.replace("+ 1b-1);\n", "- 1b-1);\n"), "1/2")

    def test_without_it_a_sentence_says_so(self) -> None:
        with self.assertRaisesRegex(Failure, "gappa: neither in .* nor on PATH"), unittest.mock.patch.dict("os.environ", PATH="/nowhere"):
            tools.find(Path("/nowhere"), {"gappa"})


class Elastic(unittest.TestCase):
    FILE = """
module plain (input logic a_i, output logic b_o);  // ready_o
endmodule
module stream #(parameter W = 1) (
    input  logic in_valid_i,  // offered
    output logic [W-1:0] out_o
);
  fifo #(.Depth(2)) words (.clk_i(clk_i));
  always_ff @(posedge clk_i) room_q <= room_q - taken;
endmodule
module shifts (
    input logic a_i
);
  always_ff @(posedge clk_i) places_q <= places_q >> 1;
endmodule
"""

    def test_finds_what_words_go_through(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "rtl").mkdir()
            (Path(folder) / "rtl" / "a.sv").write_text(self.FILE)
            self.assertEqual(elastic.elastic(Path(folder)), {"stream": ["ports", "FIFO", "credits"]})

    def test_a_module_without_property_or_reason_fails(self) -> None:
        read = table(ENTRY.format(method="pdr", more=""))
        found = {"m": ["ports"], "n": ["FIFO"]}
        self.assertEqual(elastic.rows(found, {"n": "why"}, read)[2:], ["| `m` | ports | `a` |", "| `n` | FIFO | none: why |"])
        for modules, reasons, word in ((found, {}, "n: words go through it"), (found, {"n": "why", "m": "why"}, "a property names it"),
                                       ({"m": ["ports"]}, {"n": "why"}, "no such module")):
            with self.assertRaisesRegex(Failure, word):
                elastic.rows(modules, reasons, read)


if __name__ == "__main__":
    unittest.main()
