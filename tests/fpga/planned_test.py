# SPDX-License-Identifier: Apache-2.0
"""What is said of the engines that are planned for a board and routed, on made-up figures."""
import copy
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from flow import planned
from flow.boards import read_board
from flow.goals import planned_goals
from flow.headline.data import Link
from flow.headline.plans import HeadlinePlan
from flow.headline.tops import Routing, Top
from flow.planned import Data, Planned, cells, first_to_end, merged, missed, page, predicted, read_data, row_of, stale_rows
from flow.routing import Placement
from flow.shell import ROOT, Failure

ROW: Planned = {"scene": "room", "plan": "0123", "gatherers": 3, "widths": [2, 4, 1, 1], "contexts": 32, "memory": "block_ram", "beat_bits": 256,
                "cycles": 8.0, "digest": "d" * 64, "resources": {"LUT-eq": 41000, "DP16KD": 190}, "seed": 2,
                "clocks": [{"name": "clk", "achieved": 64.0, "constraint": 50.0}]}


class PlannedEngines(unittest.TestCase):
    def test_a_row(self) -> None:
        self.assertEqual(missed(ROW), [])
        self.assertEqual(cells(ROW), ["room", "3", "2, 4, 1, 1", "32", "block_ram", "256", "8.00", "41,000", "190", "2", "clk 64.0 of 50", "8.00",
                                      "`dddddddddddd`", "yes"])

    def test_a_clock_that_is_missed(self) -> None:
        row = copy.deepcopy(ROW)
        row["clocks"].append({"name": "clk_sdram", "achieved": 99.0, "constraint": 100.0})
        self.assertEqual(missed(row), ["clk_sdram reaches 99.0 MHz of 100"])
        self.assertEqual(cells(row)[-1], "**MISSED**: clk_sdram reaches 99.0 MHz of 100")
        row["clocks"] = []
        self.assertEqual(cells(row)[-4:], ["–", "–", "`dddddddddddd`", "**MISSED**: nextpnr does not end"])

    def test_a_seed_without_end_gives_way_to_a_further_one(self) -> None:
        def placed(seed: int) -> Placement:
            return {"seed": seed, "placer": "static", "clocks": {}, "utilization": {}}

        link: Link = {"baud": 1, "down": 1, "up": 1}
        top = Top("room", "d" * 64, Path("t"), 50.0, link, 1.0)
        routing = Routing(mock.Mock(), mock.Mock(), 1, 2, None, 6, "static", False)
        for ends, found in ((2, (placed(2), [])), (3, (placed(3), [2])), (9, (None, [2, 3, 4]))):
            with self.subTest(ends=ends), mock.patch("flow.routing.say"), \
                    mock.patch("flow.headline.tops.route_seed", side_effect=lambda t, seed, placer, o: placed(seed) if seed == ends else None):
                self.assertEqual(first_to_end(top, routing), found)
        row = copy.deepcopy(ROW)
        row["unrouted"] = [1, 5]
        self.assertEqual(cells(row)[9], "2; nextpnr does not end with 1, 5")

    def test_a_scene_measured_again_takes_the_place_of_its_row(self) -> None:
        other, again = copy.deepcopy(ROW), copy.deepcopy(ROW)
        other["scene"], again["cycles"] = "hall", 7.0
        scenes = [Path("scenes/hall.xml"), Path("scenes/room.xml"), Path("scenes/new.xml")]
        self.assertEqual(merged([ROW, other], [again], scenes), [other, again])

    def test_a_row_takes_what_is_predicted_of_its_own_plan_alone(self) -> None:
        self.assertEqual(predicted(ROW, {"hash": "0123", "engine": {"cycles": 8.5}}), {**ROW, "cycles": 8.5})
        with self.assertRaisesRegex(Failure, "room: is plan 4567 today, planned.json has a row of 0123; scripts/plan-boards room routes it"):
            predicted(ROW, {"hash": "4567", "engine": {"cycles": 8.5}})

    def test_the_page_changes_with_its_data(self) -> None:
        data: Data = {"board": "b", "options": ["--k", "16"], "versions": {"yosys": "Yosys 1"}, "rows": [copy.deepcopy(ROW)]}
        text = page(data)
        self.assertIn("`photonloom plan SCENE --k 16 --board b`", text)
        self.assertIn("Yosys 1", text)
        data["rows"][0]["plan"] = "4567"
        self.assertNotEqual(page(data), text)
        self.assertEqual(page(None), "Not routed yet.\n")

    def test_rows_of_earlier_rtl_are_named(self) -> None:
        data: Data = {"board": "b", "options": [], "versions": {}, "rows": [copy.deepcopy(ROW), copy.deepcopy(ROW)]}
        data["rows"][1]["scene"] = "hall"
        board = read_board("ulx3s-85f")
        with mock.patch("flow.planned.describe", return_value={"hash": "0123"}), \
                mock.patch("flow.planned.digest_now", side_effect=lambda plan, board: "n" * 64 if plan.stem == "hall" else "d" * 64):
            stale = stale_rows(data, board)
        self.assertEqual(stale, ["hall"])
        self.assertIn("\nRouted with earlier RTL: `hall`; ", page(data, stale))
        self.assertNotIn("earlier RTL", page(data))
        with mock.patch("flow.planned.describe", return_value={"hash": "4567"}), \
                self.assertRaisesRegex(Failure, "fpga/planned/room.toml: is plan 4567, expected 0123, which planned.json has of it"):
            stale_rows(data, board)

    def test_a_row_is_read_from_the_plan_and_the_placement(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "p.toml")
            path.write_text((ROOT / "fpga" / "headline" / "sdram_k8.toml").read_text())
            link: Link = {"baud": 1, "down": 1, "up": 1}
            top = Top("room", "d" * 64, Path(folder), 50.0, link, 1.0)
            placed: Placement = {"seed": 1, "placer": "static", "clocks": {"$glbnet$clk": {"achieved": 60.0, "constraint": 50.0}}, "utilization": {}}
            said = {"hash": "89ab", "engine": {"cycles": 7.5}}
            row = row_of(HeadlinePlan("room", path), said, top, {"LUT-eq": 1}, placed, [])
            self.assertEqual((row["plan"], row["memory"], row["widths"][1], row["clocks"]),
                             ("89ab", "sdram", 4, [{"name": "clk", "achieved": 60.0, "constraint": 50.0}]))
            self.assertEqual((row["seed"], "unrouted" in row), (1, False))
            for placement, without_end, told in ((placed, [3, 4], (1, [3, 4], 1)), (None, [1, 2, 3], (3, [1, 2], 0))):
                row = row_of(HeadlinePlan("room", path), said, top, {"LUT-eq": 1}, placement, without_end)
                self.assertEqual((row["seed"], row["unrouted"], len(row["clocks"])), told)
            path.write_text("[gatherer]\nlanes = 4\n")
            with self.assertRaisesRegex(Failure, "p.toml: board.gatherers is missing, expected a count"):
                row_of(HeadlinePlan("room", path), said, top, {}, placed, [])

    def test_a_scene_without_a_row_and_other_options_fail_the_check(self) -> None:
        data = read_data()
        assert data
        fewer, other = copy.deepcopy(data), copy.deepcopy(data)
        gone = fewer["rows"].pop(0)["scene"]
        other["options"] += ["--k", "50"]
        for changed, told in ((fewer, f"has no row of {gone}; scripts/plan-boards"), (other, "options is .*, expected ")):
            with mock.patch.object(planned, "read_data", return_value=changed), mock.patch.object(sys, "argv", ["plan-boards", "--check"]), \
                    self.assertRaisesRegex(Failure, told):
                planned.main()

    def test_the_goals_name_scenes_that_are_there(self) -> None:
        goals = planned_goals()
        self.assertGreaterEqual(len(goals.scenes), 3)
        for scene in goals.scenes:
            self.assertTrue(scene.is_file())


if __name__ == "__main__":
    unittest.main()
