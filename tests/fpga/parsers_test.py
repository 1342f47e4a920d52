# SPDX-License-Identifier: Apache-2.0
"""What is read of the tools' output, as recorded in tests/fpga/recorded of a small reorder buffer, and of data files."""
import json
import tempfile
import unittest
from pathlib import Path

from flow.boards import FAMILIES, LUT_EQ, UnknownBoard, board_names, read_board
from flow.goals import area_goals, fast_goals, headline_goals, planned_goals
from flow.plans.catalogue import read_catalogue
from flow.routing import clocks_of, routed_name, static_rounds
from flow.shell import ROOT, Failure, complaint
from flow.synthesis import binding, counts_of
from flow.tables import markdown, replace_between
from flow.tools import nextpnr_is_slow, nextpnr_version, yosys_version

RECORDED = Path(__file__).parent / "recorded"


class Files(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def write(self, name: str, text: str) -> Path:
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path


class Counts(Files):
    def counts(self, name: str, family: str, module: str = "reorder_buffer") -> dict[str, int]:
        return counts_of(RECORDED / name, FAMILIES[family], module)

    def test_of_an_ecp5(self) -> None:
        self.assertEqual(self.counts("yosys-0.23.stat.json", "ecp5"),
                         {"LUT4": 1352, "FF": 1412, "CCU2C": 199, "DPR16X4": 53, "DP16KD": 15, "MULT18X18D": 0,
                          LUT_EQ: 1352 + 2 * 199 + 4 * 53})

    def test_of_a_module_apart_from_its_top(self) -> None:
        self.assertEqual(self.counts("yosys-0.52.stat.json", "ecp5"),
                         {"LUT4": 870, "FF": 1237, "CCU2C": 141, "DPR16X4": 49, "DP16KD": 15, "MULT18X18D": 0, LUT_EQ: 1348})
        self.assertEqual(self.counts("yosys-0.52.stat.json", "ecp5", "ulx3s_85f_reorder_buffer_top")["DP16KD"], 0)

    def test_every_flip_flop_of_an_ice40(self) -> None:
        self.assertEqual(self.counts("yosys-0.23-ice40.stat.json", "ice40"),
                         {"LUT4": 1351, "FF": 932 + 332 + 211 + 5 + 52 + 5, "SB_RAM40_4K": 30, "SB_MAC16": 0})

    def test_what_is_counted_together_of_an_artix(self) -> None:
        self.assertEqual(self.counts("yosys-0.52-xc7.stat.json", "xc7"),
                         {"LUT6": 26 + 138 + 102 + 81 + 136 + 160, "FF": 909 + 10, "CARRY4": 72, "SRL": 103, "RAM64M": 34,
                          "RAM64X1D": 0, "RAMB36E1": 0, "RAMB18E1": 15, "DSP48E1": 0, LUT_EQ: 643 + 103 + 4 * 34,
                          "RAMB18-eq": 15})
        counts = {"LUT6": 10, "FF": 7, "RAMB36E1": 60, "RAMB18E1": 16, "DSP48E1": 24, LUT_EQ: 63400, "RAMB18-eq": 136}
        arty = read_board("arty-a7-100t")
        self.assertEqual(binding(counts, arty), {"resource": LUT_EQ, "used": 63400, "of": 63400})
        self.assertEqual(binding({**counts, LUT_EQ: 10}, arty), {"resource": "RAMB18-eq", "used": 136, "of": 270})

    def test_a_module_that_is_not_there(self) -> None:
        with self.assertRaisesRegex(Failure, r"yosys-0.23.stat.json: has no module v, only \\reorder_buffer$"):
            self.counts("yosys-0.23.stat.json", "ecp5", "v")

    def test_output_that_was_cut_short(self) -> None:
        path = self.write("stat.json", (RECORDED / "yosys-0.23.stat.json").read_text()[:100])
        with self.assertRaisesRegex(Failure, "stat.json: is not JSON"):
            counts_of(path, FAMILIES["ecp5"], "reorder_buffer")

    def test_the_fullest_resource_binds(self) -> None:
        counts = {"LUT4": 10, "FF": 7, "CCU2C": 3, "DPR16X4": 2, "DP16KD": 104, "MULT18X18D": 77, LUT_EQ: 24}
        ulx3s = read_board("ulx3s-85f")
        self.assertEqual(binding(counts, ulx3s), {"resource": "DP16KD", "used": 104, "of": 208})
        self.assertEqual(binding({**counts, LUT_EQ: 83640}, ulx3s), {"resource": LUT_EQ, "used": 83640, "of": 83640})
        self.assertEqual(binding(self.counts("yosys-0.23-ice40.stat.json", "ice40"), read_board("up5k")),
                         {"resource": "SB_RAM40_4K", "used": 30, "of": 30})


class Routed(Files):
    def test_clocks(self) -> None:
        clocks, utilization = clocks_of(RECORDED / "nextpnr-ecp5.report.json")
        self.assertEqual(clocks, {"$glbnet$clk_25mhz$TRELLIS_IO_IN": {"achieved": 121.71373748779297, "constraint": 100}})
        self.assertEqual(utilization["DP16KD"], {"available": 208, "used": 15})

    def test_a_report_without_a_clock(self) -> None:
        path = self.write("report.json", json.dumps({"fmax": {}, "utilization": {}}))
        with self.assertRaisesRegex(Failure, "report.json: nextpnr reports no clock"):
            clocks_of(path)

    def test_capacities_of_the_board_are_those_that_nextpnr_knows(self) -> None:
        utilization = clocks_of(RECORDED / "nextpnr-ecp5.report.json")[1]
        theirs = {"LUT4": "TRELLIS_COMB", "FF": "TRELLIS_FF", "DP16KD": "DP16KD", "MULT18X18D": "MULT18X18D"}
        self.assertEqual(read_board("ulx3s-85f").resources,
                         {ours: utilization[cell]["available"] for ours, cell in theirs.items()})

    def test_of_an_artix(self) -> None:
        clocks, utilization = clocks_of(RECORDED / "nextpnr-himbaechel-xilinx.report.json")
        self.assertEqual([c["constraint"] for c in clocks.values()], [100])
        theirs = {"FF": "SLICE_FFX", "RAMB18E1": "RAMB18E1_RAMB18E1", "DSP48E1": "DSP48E1_DSP48E1"}
        resources = read_board("arty-a7-100t").resources
        for ours, cell in theirs.items():
            self.assertEqual(resources[ours], utilization[cell]["available"], ours)
        # Two halves of each fracturable LUT.
        self.assertEqual(2 * resources["LUT6"], utilization["SLICE_LUTX"]["available"])

    def test_rounds_of_the_static_placer(self) -> None:
        self.assertEqual(static_rounds((RECORDED / "nextpnr-ecp5.static.log").read_text()), 439)
        self.assertEqual(static_rounds("Info: packing\n"), 0)

    def test_names_of_the_makefile(self) -> None:
        self.assertEqual(routed_name("t", 2, "heap", None), "t_seed2")
        self.assertEqual(routed_name("t", 2, "heap", 6), "t_seed2")
        self.assertEqual(routed_name("t", 2, "static", 8), "t_seed2_static_route8")


class Said(unittest.TestCase):
    versions = (RECORDED / "versions.txt").read_text().splitlines()

    def test_versions(self) -> None:
        self.assertEqual([yosys_version(line) for line in self.versions], ["0.23", "0.52", None, None, None])
        self.assertEqual([nextpnr_version(line) for line in self.versions[2:4]], ["0.11.1", "0.4"])
        self.assertIsNone(yosys_version(None))
        self.assertIsNone(nextpnr_version("nextpnr"))

    def test_a_slow_nextpnr(self) -> None:
        self.assertFalse(nextpnr_is_slow(self.versions[2]))
        for version in ("0.4-1+b1", "0.7-1+b2", "nextpnr-0.7", "0.7.3"):
            self.assertTrue(nextpnr_is_slow(f"(Version {version})"), version)
        for version in ("0.8", "0.70", "1.2", "0.10-1"):
            self.assertFalse(nextpnr_is_slow(f"(Version {version})"), version)

    def test_errors(self) -> None:
        for log, said in (("yosys-error.log", "bad.v:2: ERROR: syntax error, unexpected TOK_ASSIGN, expecting ';'"),
                          ("nextpnr-ecp5-error.log", "ERROR: Failed to open '--json' file 'nowhere.json': "
                                                     "No such file or directory.")):
            failure = complaint(["make", "synth", "X=1"], (RECORDED / log).read_text(), Path("a.log"))
            self.assertEqual(str(failure), f"make synth failed: {said} (all of it: a.log)")
        self.assertEqual(str(complaint(["make"], "", None)), "make failed: it said nothing")

    def test_what_stands_behind_the_cause(self) -> None:
        for log, said in (("make: Entering directory 'p'\nnextpnr -q\nmake: *** [Makefile:37: a.config] Killed\nmake: Leaving directory 'p'\n",
                           "make: *** [Makefile:37: a.config] Killed"),
                          ("make[1]: *** [Makefile:37: a.config] Error 3\nmake[1]: Leaving directory 'p'\n", "make[1]: *** [Makefile:37: a.config] Error 3"),
                          ("--clock: '7777', expected a number from 1 to 400\nRun with --help for more information.\n",
                           "--clock: '7777', expected a number from 1 to 400")):
            self.assertEqual(str(complaint(["tool"], log, None)), f"tool failed: {said}")


BOARD = """[part]
name = "P"
family = "ecp5"
[part.resources]
LUT4 = 100
[measure]
plan = "fpga/area.toml"
"""


class DataFiles(Files):
    def board(self, old: str, new: str) -> object:
        """A board whose file has `new` in the place of `old`."""
        self.assertIn(old, BOARD)
        self.write("b/board.toml", BOARD.replace(old, new))
        return read_board("b", self.folder)

    def test_boards(self) -> None:
        self.assertEqual(board_names(), ["arty-a7-100t", "nexys-video", "ulx3s-85f", "up5k"])
        self.assertEqual(read_board("ulx3s-85f").top(), "ulx3s_85f_top")
        self.assertEqual(read_board("up5k").top("reorder_buffer"), "up5k_reorder_buffer_top")
        with self.assertRaisesRegex(UnknownBoard, "^there is no board x, expected one of arty-a7-100t, nexys-video, ulx3s-85f, up5k$"):
            read_board("x")

    def test_a_board_of_files_alone(self) -> None:
        self.board("LUT4 = 100", "LUT4 = 100")
        self.assertEqual(board_names(self.folder), ["b"])

    def test_a_board_with_a_fault(self) -> None:
        for old, new, said in (
                ('"ecp5"', '"x"', "part.family is x, expected one of ecp5, ice40, xc7"),
                ('family = "ecp5"', "", "part.family is missing, expected one of"),
                ("LUT4 = 100", "LUT4 = 1.5", "part.resources.LUT4 is 1.5, expected a count"),
                ("LUT4 = 100", "FF = 3", "part.resources.LUT4 is missing, expected a count"),
                ("LUT4 = 100", "LUTS = 100", "part.resources.LUTS is unknown, expected some of LUT4,"),
                ('plan = "fpga/area.toml"', "plan = 3", "measure.plan is 3, expected a plan below"),
                ("[measure]", "[measurements]", "measure.plan is missing, expected a plan below"),
                ("[measure]", "[measure", "is not TOML")):
            with self.subTest(new), self.assertRaisesRegex(Failure, f"b/board.toml: {said}"):
                self.board(old, new)

    def test_goals(self) -> None:
        self.assertEqual(headline_goals().times_core("sdram", 16), 1.5)
        self.assertEqual(headline_goals().share, {"SDRAM": 0.85, "gatherers": 0.8})
        text = (ROOT / "fpga" / "goals.toml").read_text()
        path = self.write("goals.toml", text.replace("times = [2, 1.8]", "times = [2]"))
        with self.assertRaisesRegex(Failure, r"goals.toml: headline.gain.block_ram_k8.times is \[2\], expected two numbers above 0"):
            headline_goals(path)
        path = self.write("goals.toml", '[area]\ngrowth = "much"\n')
        with self.assertRaisesRegex(Failure, "goals.toml: area.growth is 'much', expected a share"):
            area_goals(path)
        with self.assertRaisesRegex(Failure, "goals.toml: headline.times_core is missing, expected a table"):
            headline_goals(path)

    def test_the_catalogue_of_plans(self) -> None:
        catalogue = read_catalogue()
        self.assertEqual(catalogue.scenes["small"][:3], ["scenes/cornell.xml", "--photons", "4096"])
        self.assertEqual((catalogue.variations["pool256"].unit, catalogue.variations["pool256"].base),
                         ("reorder_buffer", "plans/large"))
        path = self.write("plans.toml", 'board = "ulx3s-85f"\n[derived.a]\nbase = "b"\nset = [1]\n')
        with self.assertRaisesRegex(Failure, r"plans.toml: derived.a.set is \[1\], expected a list of strings"):
            read_catalogue(path)


class Tables(Files):
    def test_markdown(self) -> None:
        self.assertEqual(markdown([["a", 1]], ["x", "y"]), "| x | y |\n|---|---|\n| a | 1 |\n")

    def test_a_page_keeps_what_is_around(self) -> None:
        page = self.write("page.md", "before\n<!-- m -->\nold\n<!-- end of m -->\nafter\n")
        replace_between(page, "m", "new\n")
        self.assertEqual(page.read_text(), "before\n<!-- m -->\nnew\n<!-- end of m -->\nafter\n")
        with self.assertRaisesRegex(Failure, "page.md: has no marks '<!-- n -->' and '<!-- end of n -->'"):
            replace_between(page, "n", "new\n")


class Goals(Files):
    def test_what_is_wrong_with_a_goal(self) -> None:
        """Its field, and what was expected."""
        right = (ROOT / "fpga" / "goals.toml").read_text()
        scenes, numbers = "expected a list of scenes", "expected two numbers above 0"
        for read, old, new, said in (
                (headline_goals, "block_ram_k50 = { before", "blok_ram_k50 = { before", "headline.gain.blok_ram_k50 is unknown, expected some of commit, golden, block_ram_k16, "),
                (headline_goals, "golden = { block_ram =", "golden = { block_ramm =", "headline.gain.golden.block_ramm is unknown, expected some of block_ram, sdram"),
                (headline_goals, "golden = { block_ram = 1.5, ", "golden = { ", "headline.gain.golden.block_ram is missing, expected a multiple of one core"),
                (headline_goals, "block_ram = { 8", "block_ramm = { 8", "headline.times_core.block_ramm is unknown, expected some of block_ram, sdram"),
                (headline_goals, "before = [0.80,", "before = [0,", rf"headline.gain.block_ram_k50.before is \[0, 1.26\], {numbers}"),
                (headline_goals, "times = [2.5, 2.5]", "times = [true, 2]", rf"headline.gain.block_ram_k50.times is \[True, 2\], {numbers}"),
                (headline_goals, "or_gatherers = [0, 3]", "or_gatherers = [0, 1.5]", r"headline.gain.block_ram_k8.or_gatherers is \[0, 1.5\], expected two counts"),
                (headline_goals, 'scenes = ["scenes/cornell.xml", "scenes/atrium.xml"]', "scenes = [5]", rf"headline.images.scenes is \[5\], {scenes}"),
                (headline_goals, 'plan = "sdram_k16"', 'plan = "sdram_k17"', "headline.images.plan is sdram_k17, expected one of block_ram_k16, "),
                (headline_goals, "spp = 4", "spp = 0", "headline.images.spp is 0, expected a count of at least 1"),
                (planned_goals, 'scenes = ["scenes/cornell.xml", "scenes/atrium.xml", "scenes/cornell_glossy.xml"]', "scenes = [1]", rf"planned.scenes is \[1\], {scenes}"),
                (planned_goals, 'options = ["--photons", "16000", "--k", "16"]', "options = [1, 2]", r"planned.options is \[1, 2\], expected a list of options"),
                (fast_goals, "seeds = 3", "seeds = 0", "fast.seeds is 0, expected a count of at least 1"),
                (fast_goals, "seeds = 3", "seeds = -2", "fast.seeds is -2, expected a count of at least 1"),
                (fast_goals, "8 = 90", "wide = 90", "fast.mhz.wide is unknown, expected a k, a whole number"),
                (fast_goals, "8 = 729142", "k8 = 729142", "fast.rates.k8 is unknown, expected a k, a whole number")):
            self.assertIn(old, right)
            path = self.write("goals.toml", right.replace(old, new))
            with self.subTest(new), self.assertRaisesRegex(Failure, f"goals.toml: {said}"):
                read(path)


if __name__ == "__main__":
    unittest.main()
