# SPDX-License-Identifier: Apache-2.0
"""What is said of the gatherer alone, on made-up figures."""
import contextlib
import io
import json
import sys
import tempfile
import unittest
from collections.abc import Mapping, Sequence
from pathlib import Path
from unittest import mock

from flow import fast
from flow.boards import read_board
from flow.fast import CycleRow, Data, Row, cycles_of, fewer, names, page, rate, slowest, stale_rows, take_cycles, there, verdict
from flow.goals import FastGoals, fast_goals
from flow.routing import placements
from flow.shell import Failure

GOALS = FastGoals("b", 3, {8: 90.0}, {}, Path("goals.toml"))


def row(plan: str, mhz: list[float], cycles: float, luts: int) -> Row:
    return {"plan": plan, "k": 8, "widths": [2, 8, 2, 2], "contexts": 32, "digest": "", "cycles": [cycles, 2 * cycles],
            "resources": {"LUT-eq": luts, "DP16KD": 90, "MULT18X18D": 48}, "mhz": mhz}


NARROW = row("narrow_k8", [100.0, 100.0, 100.0], 20.0, 5000)  # a million for 1,000


class Fast(unittest.TestCase):
    def test_rate_is_that_of_the_median(self) -> None:
        self.assertEqual(rate(row("k8", [80.0, 100.0, 90.0], 10.0, 9000)), 1e6)
        self.assertIsNone(rate(row("k8", [], 10.0, 9000)))

    def test_the_slowest_clock_counts(self) -> None:
        self.assertEqual(slowest({"core": {"achieved": 80.0, "constraint": 100.0}, "other": {"achieved": 60.0, "constraint": 50.0}}), 60.0)

    def test_goals_are_reached_or_missed(self) -> None:
        cases: list[tuple[list[float], int, list[str]]] = [
            ([90.0, 90.0, 95.0], 9000, []),
            ([80.0, 88.0, 99.0], 8000, ["MISSED: 88.0 MHz, goal 90"]),
            ([90.0, 90.0, 90.0], 10000, ["MISSED: 900,000 gathers, goal 1,000,000"]),
            ([80.0], 9000, ["MISSED: 1 of 3 seeds routed", "MISSED: 80.0 MHz, goal 90", "MISSED: 888,889 gathers, goal 1,000,000"]),
            ([], 9000, ["MISSED: 0 of 3 seeds routed"])]
        for mhz, luts, said in cases:
            wide = row("k8", mhz, 10.0, luts)
            self.assertEqual(verdict(wide, [wide, NARROW], GOALS), said)
        self.assertEqual(verdict(NARROW, [NARROW], GOALS), [])

    def test_a_rate_of_its_own_goes_before_the_narrow_one(self) -> None:
        wide = row("k8", [90.0, 90.0, 90.0], 10.0, 10000)
        self.assertEqual(verdict(wide, [wide, NARROW], FastGoals("b", 3, {8: 90.0}, {8: 9e5}, Path("g"))), [])
        self.assertEqual(verdict(wide, [wide], GOALS), ["narrow_k8 is not routed"])
        with self.assertRaisesRegex(Failure, "goals.toml: fast.mhz.16 is missing"):
            GOALS.megahertz(16)

    def test_cycles_of_both_memories(self) -> None:
        rows: list[CycleRow] = [{"plan": "a", "memory": "slow", "cycles_per_gather": 2.0}, {"plan": "a", "memory": "ideal", "cycles_per_gather": 1.0},
                                {"memory": "ideal", "cycles_per_gather": 3.0}]
        self.assertEqual(cycles_of(rows, "a", Path("j")), [1.0, 2.0])
        with self.assertRaisesRegex(Failure, "j: has no rows of plan b with both memories"):
            cycles_of(rows, "b", Path("j"))

    def test_the_page_changes_with_its_data(self) -> None:
        data: Data = {"board": "b", "placer": "static", "versions": {"yosys": "Yosys 1"}, "rows": [row("k8", [80.0], 10.0, 9000), NARROW]}
        text = page(data, GOALS, [])
        self.assertIn("| `k8` | 2, 8, 2, 2 | 32 | 10.0 | 20.0 | 80.0, 80.0 (1) | 9,000 | 90 | 48 | 888,889 | 1,000,000, from 90.0 MHz | MISSED: 1 of 3 seeds", text)
        self.assertIn("Yosys 1", text)
        self.assertIn("nextpnr's static placer. Where nextpnr does not end with a seed, a further one is taken, up to 2 of a plan, then the default placer. ", text)
        data["rows"][0]["digest"] = "other"
        self.assertNotEqual(page(data, GOALS, []), text)
        data["placer"] = "heap"
        self.assertIn("up to 2 of a plan. ", page(data, GOALS, []))

    def test_rows_of_earlier_rtl_are_named(self) -> None:
        data: Data = {"board": "b", "placer": "static", "versions": {}, "rows": [row("k8", [80.0], 10.0, 9000), NARROW]}
        data["rows"][0]["digest"] = "then"
        with mock.patch("flow.fast.digest_now", side_effect=lambda plan, board, unit: "" if plan.stem == "narrow_k8" else "now") as asked:
            stale = stale_rows(data, read_board("ulx3s-85f"))
        self.assertEqual(stale, ["k8"])
        self.assertEqual({call.kwargs["unit"] for call in asked.call_args_list}, {"photon_gatherer"})
        self.assertIn("\nMeasured with earlier RTL: `k8`; ", page(data, GOALS, stale))
        self.assertNotIn("earlier RTL", page(data, GOALS, []))

    def test_cycles_are_taken_anew(self) -> None:
        data: Data = {"board": "b", "placer": "static", "versions": {}, "rows": [row("k8", [80.0], 10.0, 9000)]}
        rows: list[CycleRow] = [{"plan": "0123", "memory": "ideal", "cycles_per_gather": 9.0}, {"plan": "0123", "memory": "slow", "cycles_per_gather": 18.5}]
        with mock.patch("flow.fast.describe", return_value={"hash": "0123"}):
            take_cycles(data, [], rows)
            self.assertEqual((data["rows"][0]["cycles"], data["rows"][0]["mhz"]), ([9.0, 18.5], [80.0]))
            with self.assertRaisesRegex(Failure, "k8 was measured with earlier RTL, expected scripts/fpga-fast k8 first$"):
                take_cycles(data, ["k8"], rows)

    def taken(self, routed: Mapping[str, float], ended: Sequence[str]) -> list[float]:
        """MHz of three seeds where these placements are there, and these did not end."""
        with tempfile.TemporaryDirectory() as folder:
            built = Path(folder, "build")
            built.mkdir()
            (built / "top.json").touch()
            for name, mhz in routed.items():
                (built / f"top_seed{name}.json").write_text(json.dumps({"fmax": {"clk": {"achieved": mhz, "constraint": 50}}, "utilization": {}}))
            for name in [*routed, *ended]:
                (built / f"top_seed{name}.log").touch()
            with contextlib.redirect_stdout(io.StringIO()):
                found = placements("k8", [1, 2, 3], "static", lambda seed, placer: there(Path(folder), "top", seed, placer))
            return [mhz for of_seed in found for mhz in of_seed]

    def test_what_is_there_is_taken_as_routing_would(self) -> None:
        some = {"2_static": 92.0, "3_static": 93.0, "4_static": 94.0}
        self.assertEqual(self.taken({}, []), [])
        self.assertEqual(self.taken(some, []), [92, 93], "a seed that was not tried")
        self.assertEqual(self.taken(some, ["1_static"]), [92, 93, 94])
        self.assertEqual(self.taken({"2_static": 92.0, "5": 85.0}, ["1_static", "3_static", "4_static", "5_static"]), [92, 85])
        with self.assertRaisesRegex(Failure, "^k8: nextpnr does not end with any seed of 1, 2, 3, 4, 5$"):
            self.taken({}, [f"{seed}{placer}" for seed in range(1, 6) for placer in ("", "_static")])

    def test_a_row_of_more_seeds_is_not_lost_unsaid(self) -> None:
        self.assertEqual(fewer(row("k8", [80.0], 1, 1), row("k8", [80.0, 81.0], 1, 1)), ["MISSED: 1 seeds routed, 2 in the row that this one replaces"])
        self.assertEqual(fewer(row("k8", [80.0], 1, 1), row("k8", [80.0], 1, 1)), [])
        self.assertEqual(fewer(row("k8", [80.0], 1, 1), None), [])

    def test_a_plan_without_a_row_fails_the_check(self) -> None:
        data = fast.read_data()
        data["rows"] = data["rows"][1:]
        with mock.patch.object(fast, "read_data", lambda: data), mock.patch.object(sys, "argv", ["fpga-fast", "--check"]), \
                self.assertRaisesRegex(Failure, "fast.json: has no row of k8; scripts/fpga-fast k8 makes it"):
            fast.main()

    def test_every_plan_has_its_goals(self) -> None:
        self.assertEqual(names(), ["k8", "narrow_k8", "k16", "narrow_k16", "k50", "narrow_k50"])
        self.assertEqual(sorted(fast_goals().mhz), [8, 16, 50])


if __name__ == "__main__":
    unittest.main()
