# SPDX-License-Identifier: Apache-2.0
"""What the commands keep of earlier results, and what they say of data files that are not right; nothing is synthesized."""
import contextlib
import io
import json
import tempfile
import unittest
from pathlib import Path
from typing import Any
from unittest import mock

from flow import area, fast, measure, planned
from flow.arguments import made_folder
from flow.boards import read_board
from flow.goals import fast_goals, planned_goals
from flow.measure import merged
from flow.package import describe
from flow.plans import command as plans_command, measurements
from flow.plans.catalogue import read_catalogue
from flow.results import Entry
from flow.routing import Placement
from flow.shell import ROOT, Failure, UsageError, read_json, said_json, write_json
from flow.tools import Tools

PLACED: Placement = {"seed": 1, "placer": "heap", "clocks": {}, "utilization": {}}
TOOLS = Tools([], {"yosys": "Yosys 1", "nextpnr-ecp5": "nextpnr 1"})


def entry(name: str, digest: str, seeds: int = 1, luts: int = 1) -> Entry:
    return {"name": name, "digest": digest, "top": "", "constraint_mhz": 50.0, "resources": {"LUT4": luts},
            "binding": {"resource": "FF", "used": 0, "of": 1}, "seeds": [PLACED] * seeds}


class Commands(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.enterContext(contextlib.redirect_stdout(io.StringIO()))

    def run_command(self, module: Any, *arguments: str) -> int:
        with mock.patch("sys.argv", ["command", *arguments]):
            status: int = module.main()
            return status

    def refused(self, sentence: str, module: Any, *arguments: str) -> None:
        errors = io.StringIO()
        with contextlib.redirect_stderr(errors), self.assertRaises(SystemExit) as ended:
            self.run_command(module, *arguments)
        self.assertEqual(ended.exception.code, 2)
        self.assertRegex(errors.getvalue(), sentence)

    def data(self, module: Any, text: str) -> None:
        """A data file of a command that holds this."""
        path = self.folder / "data.json"
        path.write_text(text)
        self.enterContext(mock.patch.object(module, "DATA", path))


class Arguments(Commands):
    def test_before_any_tool_is_started(self) -> None:
        dry = ("--dry-run",)
        self.refused("README.md: is no plan, expected a plan.toml\n", measure, str(ROOT / "README.md"), *dry)
        self.refused("fpga/goals.toml: gatherer is missing, expected a plan with this table\n", measure, str(ROOT / "fpga/goals.toml"), *dry)
        broken = self.folder / "plan.toml"
        broken.write_text("[gatherer\n")
        self.refused("plan.toml: is not TOML: ", measure, str(broken), *dry)
        self.refused("the plan has no name, expected a plan.toml\n", measure, "", *dry)
        self.refused("--units: up5k has no top of a whole board, expected some of photon_gatherer, ", measure, "--board", "up5k", "--units", "board", *dry)
        self.refused("--clock: is 7777, expected a number from 1 to 400\n", measure, "--clock", "7777", "--units", "board", *dry)
        for board in ("ulx3s-85f", "arty-a7-100t"):
            self.assertEqual(self.run_command(measure, "--board", board, "--clock", "400", "--units", "board", *dry), 0)
        broken.write_text("")
        self.refused(f"--results: {broken} is a file, expected a folder\n", planned, "--results", str(broken / "a" / "b"))

    def test_what_would_route_nothing(self) -> None:
        for idle in (("--seeds", "1"), ("--placer", "heap"), ("--no-route",)):
            for option in ("--check", "--render", "--cycles"):
                self.refused(f"{idle[0]} is of what is routed, and {option} routes nothing; expected none of --", fast, option, *idle)
        for idle in (("--seeds", "3"), ("--first-seed", "0"), ("--route-speed", "6"), ("--placer", "heap")):
            self.refused(f"{idle[0]} is of what is routed, and --synthesis-only routes nothing; expected none of --", measure, "--synthesis-only", *idle)

    def test_what_would_measure_nothing(self) -> None:
        for idle in (("--readme",), ("--page",), ("--synthesis-only",), ("--seeds", "3"), ("--units", "board"), ("--clock", "60")):
            self.refused(f"{idle[0]} is of what is measured, and --tools measures nothing; expected none of --", measure, "--tools", *idle)
        self.refused("--tools is of no plan, expected none\n", measure, "--tools", "fpga/area.toml")
        for option in ("--plans-only", "--fit", "--check"):
            self.refused(f"--no-route is of what is measured, and {option} measures nothing; expected none of --", plans_command, option, "--no-route")
        self.refused("--jobs is of what is measured, and --check measures nothing; expected none of --", plans_command, "--check", "--jobs", "2")
        self.refused("not allowed with argument --fit", plans_command, "--fit", "--check")

    def test_a_unit_that_none_of_the_plans_has(self) -> None:
        with mock.patch.object(plans_command, "find_tools", return_value=TOOLS), \
                self.assertRaisesRegex(Failure, "^--units: none of lanes1 has cdf_sampler, expected a unit of one of them$"):
            self.run_command(plans_command, "lanes1", "--units", "cdf_sampler", "--update")

    def test_json_among_warnings(self) -> None:
        self.assertEqual(said_json(["sh", "-c", "echo 'a: warning: {b}' >&2; printf '{\n \"c\": 1\n}\nmore\n'"]), {"c": 1})
        with self.assertRaisesRegex(Failure, "^sh -c: says no JSON: none$"):
            said_json(["sh", "-c", "echo none"])


class Reports(Commands):
    def test_what_of_a_report_stays(self) -> None:
        old, new = [entry("cdf_sampler", "b"), entry("board", "c")], [entry("photon_gatherer", "a")]
        self.assertEqual(merged(old, new, {"cdf_sampler": "b", "board": "d"}), [new[0], old[0]])
        self.assertEqual(merged(old, new, {}), [new[0], *old], "written meanwhile")
        self.assertEqual(merged(old, new, None), new)
        again = [entry("board", "c", luts=2)]
        self.assertEqual(merged(old, again, None), again)

    def test_resources_alone_do_not_take_the_place_of_clocks(self) -> None:
        old, new = [entry("board", "c")], [entry("board", "c", seeds=0)]
        self.assertEqual(merged(old, new, None), old)
        other = [entry("board", "d", seeds=0)]
        self.assertEqual(merged(old, other, None), other)
        self.assertEqual(merged([entry("board", "c", seeds=0, luts=2)], new, None), new)

    def test_a_result_that_comes_while_a_digest_waits(self) -> None:
        report = self.folder / "report.json"

        def write(entries: list[Entry]) -> None:
            write_json(report, {"board": "ulx3s-85f", "plan": "0123", "versions": {}, "entries": entries})

        def digest_now(*_: object) -> str:
            write([entry("cdf_sampler", "b", luts=2)])  # of the command that was waited for
            return "b"

        write([entry("cdf_sampler", "b", luts=1)])
        with mock.patch.object(measure, "find_tools", return_value=TOOLS), mock.patch.object(measure, "digest_now", digest_now), \
                mock.patch.object(measure, "describe", return_value={"hash": "0123", "units": ["cdf_sampler", "reorder_buffer"]}), \
                mock.patch.object(measure, "measure", return_value=entry("reorder_buffer", "a")), \
                mock.patch.object(measure, "report_folder", return_value=self.folder):
            self.assertEqual(self.run_command(measure, "--units", "reorder_buffer"), 0)
        self.assertEqual([(e["name"], e["resources"]["LUT4"]) for e in read_json(report)["entries"]], [("reorder_buffer", 1), ("cdf_sampler", 2)])

    def test_a_part_that_a_page_would_lose_is_told_before_anything_is_measured(self) -> None:
        page = self.folder / "page.md"
        page.write_text("<!-- ulx3s-85f -->\n\nNetlists of `fpga/gatherer.toml`: reorder_buffer `0123`, board `4567`.\n<!-- end of ulx3s-85f -->\n")
        write_json(self.folder / "report.json", {"board": "ulx3s-85f", "plan": "0123", "versions": {}, "entries": [entry("board", "c")]})
        with mock.patch.object(measure, "find_tools", return_value=TOOLS), mock.patch.object(measure, "measure", side_effect=AssertionError), \
                mock.patch.object(measure, "describe", return_value={"hash": "0123", "units": ["cdf_sampler", "reorder_buffer"]}), \
                mock.patch.object(measure, "report_folder", return_value=self.folder):
            with self.assertRaisesRegex(UsageError, "^--units: .*page.md has reorder_buffer of this plan and .*report.json has not, expected it among them$"):
                self.run_command(measure, "--units", "cdf_sampler", "--page", str(page))
            for units in ("cdf_sampler,reorder_buffer", "reorder_buffer"):
                with self.subTest(units), self.assertRaises(AssertionError):
                    self.run_command(measure, "--units", units, "--page", str(page))

    def test_pages_alone_are_of_every_board(self) -> None:
        for option in ("--check", "--render"):
            self.refused(f"--board is of what is measured, and {option} measures nothing", measure, option, "--board", "up5k")

    def test_what_did_not_route_says_nothing_of_routing(self) -> None:
        board = read_board("arty-a7-100t")
        counts = {**{name: 1 for name in board.family.cells}, "LUT-eq": 1, "RAMB18-eq": 1}
        o = measure.Options(Path("p.toml"), board, range(1, 2), None, None, ("static",), True, False, False)
        with mock.patch.object(measure, "package", return_value=({"clock_khz": 1000}, "d")), mock.patch.object(measure, "synthesise", return_value=counts):
            found = measure.measure_in(o, self.folder / "board", TOOLS)
        self.assertNotIn("placer", found)

    def test_what_the_part_has_no_room_for_is_not_placed(self) -> None:
        board = read_board("ulx3s-85f")
        o = measure.Options(Path("p.toml"), board, range(1, 2), None, None, ("static",), False, False, False)
        for resource, of in board.resources.items():
            counted = board.family.equivalents[resource][0] if resource in board.family.equivalents else resource
            counts = {**{name: 1 for name in board.family.cells}, "LUT-eq": 1, counted: of + 1}
            with self.subTest(resource), mock.patch.object(measure, "package", return_value=({"clock_khz": 1000}, "d")), \
                    mock.patch.object(measure, "synthesise", return_value=counts), mock.patch.object(measure, "place", side_effect=AssertionError), \
                    self.assertRaisesRegex(Failure, f"^p.toml: its board needs {of + 1} {counted}, the part has {of}$"):
                measure.measure_in(o, self.folder / "board", TOOLS)

    def test_the_placer_by_which_a_part_is_faster(self) -> None:
        board = read_board("ulx3s-85f")
        core, sdram, endless = {"heap": 70.0, "static": 80.0}, {"heap": 110.0, "static": 105.0}, set[str]()

        def place(_: Path, __: str, seed: int, ___: Tools, ____: int | None, placer: str) -> Placement | None:
            if placer in endless:
                return None
            return {"seed": seed, "placer": placer, "utilization": {}, "clocks": {"$glbnet$clk": {"achieved": core[placer] + seed, "constraint": 50.0},
                                                                                  "clk_sdram": {"achieved": sdram[placer], "constraint": 100.0}}}

        def found(*placers: str) -> Entry:
            o = measure.Options(Path("p.toml"), board, range(1, 4), None, None, placers, False, False, False)
            with mock.patch.object(measure, "package", return_value=({"clock_khz": 50000}, "d")), mock.patch.object(measure, "place", place), \
                    mock.patch.object(measure, "synthesise", return_value={**{name: 1 for name in board.family.cells}, "LUT-eq": 1}):
                return measure.measure_in(o, self.folder / "board", TOOLS)

        def placed(entry: Entry) -> tuple[float, str, set[str]]:
            return entry["fmax_mhz"]["median"], entry.get("placer", "heap"), {seed["placer"] for seed in entry["seeds"]}

        alone = found("heap")
        self.assertEqual(placed(alone), (72, "heap", {"heap"}))
        self.assertNotIn("other_placers", alone)
        self.assertNotIn("placer", measure.table([alone]))
        both = found("heap", "static")
        self.assertEqual(placed(both), (82, "static", {"static"}))
        self.assertEqual(both["other_placers"]["heap"]["$glbnet$clk"], {"constraint": 50, "median": 72, "low": 71, "high": 73})
        self.assertIn("\nPlaced by nextpnr's static placer: `board`.\n\nBy the heap placer: `board` 72.0 MHz.\n", measure.table([both]))
        report = self.folder / "report.json"
        write_json(report, {"board": "b", "plan": "0", "versions": {}, "entries": [both]})
        self.assertEqual(measure.read_entries(report), [both])
        sdram["static"] = 99  # a clock that is missed weighs more than a faster core
        both = found("heap", "static")
        self.assertEqual(placed(both), (72, "heap", {"heap"}))
        self.assertTrue(both["met"])
        self.assertIn("\nBy the static placer: `board` 82.0 MHz (MISSED: clk_sdram 99.0 of 100).\n", measure.table([both]))
        core["static"] = 40
        self.assertIn("`board` 42.0 MHz (MISSED: 42.0 of 50, clk_sdram 99.0 of 100).\n", measure.table([found("heap", "static")]))
        core["static"] = 80
        endless.add("heap")  # no seed of the one placer stands for the other
        self.assertEqual(placed(found("heap", "static")), (82, "static", {"static"}))
        self.assertIn("\nBy the heap placer: `board` does not end.\n", measure.table([found("heap", "static")]))
        endless.symmetric_difference_update({"heap", "static"})
        both = found("heap", "static")
        self.assertEqual((placed(both), both["other_placers"]), ((72, "heap", {"heap"}), {"static": {}}))
        self.assertEqual(placed(found("static")), (74, "static", {"heap"}))  # alone, seeds 3 to 5 by the default placer
        endless.add("heap")
        with self.assertRaisesRegex(Failure, "^board: nextpnr does not end by any placer$"):
            found("heap", "static")
        with self.assertRaisesRegex(Failure, "^board: nextpnr does not end with any seed of 1, 2, 3, 4, 5$"):
            found("heap")

    def test_a_report_that_is_none(self) -> None:
        report = self.folder / "report.json"
        whole = {"board": "b", "plan": "0", "versions": {}}
        for text, said in (("[]", "is a list, expected a table"), ("{}", "board is missing, expected a text"),
                           (json.dumps({**whole, "entries": [{}]}), r"entries\[0\].name is missing, expected a text"),
                           (json.dumps({**whole, "entries": [entry("none", "")]}), r"entries\[0\].name is none, expected one of photon_gatherer, ")):
            report.write_text(text)
            with self.subTest(text), self.assertRaisesRegex(Failure, f"report.json: {said}"):
                measure.read_entries(report)
        self.assertEqual(measure.read_entries(self.folder / "none.json"), [])


class OtherRows(Commands):
    """Rows that stay beside those that are measured again."""

    def fast_row(self, plan: str) -> fast.Row:
        return {"plan": plan, "k": 8, "widths": [1, 4, 1, 1], "contexts": 16, "digest": "d", "cycles": [10.0, 20.0],
                "resources": {"LUT-eq": 1, "DP16KD": 1, "MULT18X18D": 1}, "mhz": [90.0]}

    def test_fast_plans_of_another_placer(self) -> None:
        data: fast.Data = {"board": "ulx3s-85f", "placer": "static", "versions": TOOLS.versions,
                           "rows": [self.fast_row(name) for name in fast.names()]}
        self.data(fast, json.dumps(data))
        self.refused("is of the placer static, expected --placer static or all plans\n", fast, "k8", "--placer", "heap")
        with mock.patch.object(fast, "find_tools", side_effect=Failure("accepted")), self.assertRaisesRegex(Failure, "^accepted$"):
            self.run_command(fast, *fast.names(), "--placer", "heap")

    def test_fast_plans_of_another_board(self) -> None:
        self.data(fast, json.dumps({"board": "b", "placer": "static", "versions": TOOLS.versions, "rows": [self.fast_row("k16")]}))
        self.refused("is of the board b, expected all plans for ulx3s-85f\n", fast, "k8")

    def test_engines_that_were_planned_otherwise(self) -> None:
        goals = planned_goals()
        right = {"board": goals.board, "options": list(goals.options), "versions": TOOLS.versions, "rows": []}
        row: dict[str, Any] = {**json.loads(planned.DATA.read_text())["rows"][0], "scene": goals.scenes[1].stem}
        work = ("--results", str(self.folder))
        with mock.patch.object(planned, "find_tools", side_effect=Failure("accepted")):
            differing: list[tuple[dict[str, Any], str]] = [({"options": ["--k", "8"]}, "options is --k 8, expected "),
                                                           ({"board": "b"}, "board is b, expected ulx3s-85f, ")]
            for others, said in differing:
                self.data(planned, json.dumps({**right, "rows": [row], **others}))
                for scenes in ((goals.scenes[0].stem,), ("--predict",)):
                    with self.subTest(others, scenes=scenes), \
                            self.assertRaisesRegex(Failure, f"data.json: {said}.*scripts/plan-boards without scenes routes all again$"):
                        self.run_command(planned, *scenes, *work)
                with self.assertRaisesRegex(Failure, "^accepted$"):
                    self.run_command(planned, *work)

    def test_what_another_command_has_written_meanwhile(self) -> None:
        goals, written = planned_goals(), self.folder / "data.json"
        beginning = {"board": goals.board, "placer": "static", "options": list(goals.options), "versions": TOOLS.versions, "rows": []}

        def row_of(scene: Path) -> dict[str, Any]:
            return {**json.loads((ROOT / "fpga/planned.json").read_text())["rows"][0], "scene": scene.stem}

        def each(_: int, __: Any, scenes: list[Path]) -> list[dict[str, Any]]:
            write_json(written, {**beginning, "rows": [row_of(goals.scenes[1])]})
            return [row_of(scene) for scene in scenes]

        def measure_fast(name: str, *_: Any) -> fast.Row:
            write_json(written, {**beginning, "rows": [self.fast_row("k8")]})
            return self.fast_row(name)

        for module, measured, asked, key, both in (
                (planned, ("each", each), [goals.scenes[0].stem, "--results", str(self.folder)], "scene", [scene.stem for scene in goals.scenes[:2]]),
                (fast, ("measure", measure_fast), ["k16"], "plan", ["k8", "k16"])):
            self.data(module, json.dumps(beginning))
            with self.subTest(key), mock.patch.object(module, *measured), mock.patch.object(module, "find_tools", return_value=TOOLS), \
                    mock.patch.object(module, "stale_rows", return_value=[]), mock.patch.object(module, "page", return_value=""), \
                    mock.patch.object(module, "replace_between"), mock.patch("shutil.copyfile"), mock.patch.object(fast, "verdict", return_value=[]), \
                    mock.patch.object(fast, "checked_json", wraps=lambda path, kind: read_json(path) if path == written else {"photon_gatherer": []}):
                self.assertEqual(self.run_command(module, *asked), 0)
                self.assertCountEqual([row[key] for row in read_json(written)["rows"]], both)


    def test_a_row_that_misses_its_goal_is_status_1(self) -> None:
        goals = planned_goals()
        beginning = {"board": goals.board, "placer": "static", "options": list(goals.options), "versions": TOOLS.versions, "rows": []}
        planned_row = json.loads((ROOT / "fpga/planned.json").read_text())["rows"][0]
        slow = {**planned_row, "clocks": [{**clock, "achieved": clock["constraint"] - 0.1} for clock in planned_row["clocks"]]}
        few = self.fast_row("k16")
        few["mhz"] = [1000.0]
        self.assertGreater(fast_goals().seeds, 1)
        for module, patch, asked in ((planned, ("each", lambda *_: [slow]), [goals.scenes[0].stem, "--results", str(self.folder)]),
                                     (fast, ("measure", lambda *_: few), ["k16"])):
            self.data(module, json.dumps(beginning))
            said = io.StringIO()
            with self.subTest(module.__name__), contextlib.redirect_stdout(said), mock.patch.object(module, *patch), \
                    mock.patch.object(module, "find_tools", return_value=TOOLS), mock.patch.object(module, "stale_rows", return_value=[]), \
                    mock.patch.object(module, "page", return_value=""), mock.patch.object(module, "replace_between"), mock.patch("shutil.copyfile"), \
                    mock.patch.object(fast, "checked_json", wraps=lambda path, kind: {"photon_gatherer": []} if path == fast.CYCLES else read_json(path)):
                self.assertEqual(self.run_command(module, *asked), 1)
            self.assertRegex(said.getvalue(), r": MISSED: 1 of \d seeds routed|reaches .* MHz of ")


class WrongData(Commands):
    def test_files_of_rows(self) -> None:
        plans = read_catalogue().names()
        unfit: dict[str, Any] = {"board": "b", "versions": TOOLS.versions | {"ecppack": "1"},
                                 "measurements": [{"plan": plans[0], "unit": "u", "resources": {"FF": 1}}]}
        row: dict[str, Any] = {**json.loads(planned.DATA.read_text())["rows"][0], "resources": {}}
        for module, run, text, said in (
                (fast, fast, "[]", "is a list, expected a table"), (fast, fast, "{}", "board is missing, expected a text"),
                (fast, fast, '{"board": "b", "placer": "heap", "versions": {}, "rows": [{}]}', r"rows\[0\].plan is missing, expected a text"),
                (planned, planned, "[]", "is a list, expected a table"), (planned, planned, "{}", "board is missing, expected a text"),
                (planned, planned, '{"board": "b", "options": [], "versions": {}, "rows": [{}]}', r"rows\[0\].scene is missing, expected a text"),
                (planned, planned, json.dumps({"board": "b", "options": [], "versions": {}, "rows": [row]}),
                 r"rows\[0\].resources.LUT-eq is missing, expected a whole number"),
                (measurements, plans_command, "[]", "is a list, expected a table"),
                (measurements, plans_command, "{}", "board is missing, expected a text"),
                (measurements, plans_command, '{"board": "b", "versions": {}, "measurements": [{"plan": "small"}]}',
                 r"measurements\[0\].unit is missing, expected a text"),
                (measurements, plans_command, '{"board": "b", "versions": {}, "measurements": []}', "versions.yosys is missing, expected a text"),
                (measurements, plans_command, json.dumps(unfit), r"measurements\[0\].resources.LUT4 is missing, expected a whole number")):
            self.data(module, text)
            with self.subTest(text, data=module.__name__), self.assertRaisesRegex(Failure, f"data.json: {said}"):
                self.run_command(run, "--check")

    def test_fast_cycles_of_one_memory(self) -> None:
        row: dict[str, Any] = {**json.loads(fast.DATA.read_text())["rows"][0], "cycles": []}
        self.data(fast, json.dumps({"board": "b", "placer": "heap", "versions": {}, "rows": [row]}))
        with self.assertRaisesRegex(Failure, r"rows\[0\].cycles is \[\], expected those with an ideal memory and with a slow one"):
            self.run_command(fast, "--check")

    def test_a_baseline(self) -> None:
        path = self.folder / "baseline.json"
        plan = describe(area.PLAN)["hash"]
        with mock.patch.object(area, "first_line", return_value="Yosys 0.23 (git sha1 0)"), \
                mock.patch.object(area, "counted", side_effect=AssertionError):
            for text, option, said in (
                    ('{"0.23": 5}', (), "0.23 is 5, expected a table"), ("[]", ("--update",), "is a list, expected a table"),
                    (json.dumps({"0.23": {"plan": plan, "reorder_buffer": {"LUT4": 1}}}), (),
                     "0.23.reorder_buffer.FF is missing, expected a whole number"),
                    (json.dumps({"0.23": {"plan": plan, "reorder_buffer": 7}}), (), "0.23.reorder_buffer is 7, expected a table")):
                path.write_text(text)
                with self.subTest(text), self.assertRaisesRegex(Failure, f"baseline.json: {said}"):
                    self.run_command(area, "reorder_buffer", "--baseline", str(path), *option)

    def test_a_folder_that_cannot_be_made(self) -> None:
        self.assertTrue(made_folder(self.folder / "a" / "b").is_dir())
        with self.assertRaisesRegex(Failure, "^/proc/nope: cannot be made: "):
            made_folder(Path("/proc/nope"))
        with self.assertRaisesRegex(Failure, "^/proc/nope: cannot be made: "):
            self.run_command(planned, "--results", "/proc/nope")


if __name__ == "__main__":
    unittest.main()
