# SPDX-License-Identifier: Apache-2.0
"""What scripts/tradeoffs, plan-promise and time-to-image make of figures, on made-up ones."""
import runpy
import unittest
from pathlib import Path
from typing import Any

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"
TRADEOFFS, PROMISE, TIME = (runpy.run_path(str(SCRIPTS / name)) for name in ("tradeoffs", "plan-promise", "time-to-image"))
ERROR, CYCLES, LUT, MAP = (TRADEOFFS[name] for name in ("ERROR", "CYCLES", "LUT", "MAP"))


def point(number: int, error: float, scene: str = "s", **costs: float) -> dict[str, Any]:
    """A measured point by its ratios to the default plan."""
    names = {"cycles": CYCLES, "lut": LUT, "bytes": MAP}
    values = {ERROR: {"ratio": error}, TRADEOFFS["FLIP"]: {"ratio": 1.0}, **{names[name]: {"ratio": ratio} for name, ratio in costs.items()}}
    return {"point": number, "scene": scene, "state": "done", "lines": {"gather.k": number}, "values": values}


def summary(*points: dict[str, Any]) -> dict[str, Any]:
    return {"scenes": [{"scene": scene} for scene in dict.fromkeys(p["scene"] for p in points)], "points": list(points)}


class Tradeoffs(unittest.TestCase):
    def verdicts(self, *points: dict[str, Any]) -> list[str]:
        """Of the first goal: at most 1.02 times the error, 0.4 of the cycles and 0.55 of the LUTs, on two scenes."""
        page: list[str] = TRADEOFFS["goals"](summary(*points))
        self.assertEqual(TRADEOFFS["GOALS"][0], (1.02, {CYCLES: 0.4, LUT: 0.55}))
        second = next(n for n, line in enumerate(page) if line.startswith("**") and n > 0)
        return [line for line in page[:second] if line]

    def test_a_goal_is_met_where_one_point_holds_all_of_it(self) -> None:
        good = {"cycles": 0.4, "lut": 0.55}
        met = self.verdicts(point(1, 1.02, "a", **good), point(1, 1.02, "b", **good))
        self.assertRegex(met[0], r"scenes: met\*\* \(2 of 2 scenes\)")
        self.assertTrue(met[1].startswith("- `a`: met by point 1"))
        for error, cycles, lut, said in ((1.03, 0.1, 0.1, "MISSED; no point is within the error"), (1.0, 0.41, 0.1, "MISSED by point 1"),
                                         (1.0, 0.1, 0.56, "MISSED by point 1")):
            with self.subTest(said, cycles=cycles):
                page = self.verdicts(point(1, 1.0, "a", **good), point(1, error, "b", cycles=cycles, lut=lut))
                self.assertRegex(page[0], r"scenes: MISSED\*\* \(1 of 2 scenes\)")
                self.assertTrue(page[2].startswith(f"- `b`: {said}"), page)

    def test_two_points_do_not_hold_a_goal_together(self) -> None:
        page = self.verdicts(point(1, 1.0, "a", cycles=0.3, lut=0.6), point(2, 1.0, "a", cycles=0.5, lut=0.5))
        self.assertIn("(0 of 1 scenes)", page[0])
        self.assertTrue(page[1].startswith("- `a`: MISSED by point 1"), "the one whose worst cost is nearest to what is allowed")

    def test_the_least_cost_within_an_error(self) -> None:
        costs = {"cycles": 0.5, "lut": 1.0, "bytes": 1.0}
        rows = TRADEOFFS["answers"](summary(point(1, 1.1, "s", **costs), point(2, 1.1001, "s", **{**costs, "cycles": 0.2})))
        of = {float(row.split(" | ")[1]): row.split(" | ")[2] for row in rows[2:]}
        self.assertEqual({limit: cell.split(" (")[0] for limit, cell in of.items()}, {1.02: "–", 1.1: "0.500", 1.2: "0.200", 1.5: "0.200", 2.0: "0.200"})


class Promise(unittest.TestCase):
    def test_one_in_nine_may_miss_by_less_than_a_tenth(self) -> None:
        kept = [-0.1] * 8
        for misses, broken in ((kept + [0.0], False), (kept + [0.099], False), (kept + [0.1], True), (kept[1:] + [0.01, 0.01], True),
                               (kept[1:] + kept + [0.01, 0.01], True), (kept + kept + [0.01, 0.01], False), ([0.05], False), ([0.05, 0.05], True)):
            self.assertEqual(PROMISE["broken"](misses), broken, misses)


class TimeToImage(unittest.TestCase):
    def test_a_goal_is_of_after_over_before(self) -> None:
        said = TIME["verdict"]
        self.assertEqual(TIME["GOAL"], 0.5)
        self.assertEqual(said(0.01, 40.0, 20.0), "- after over before, to 0.01: 0.50, goal at most 0.5")
        self.assertEqual(said(0.01, 20.0, 40.0), "- after over before, to 0.01: 2.00, goal at most 0.5: MISSED")
        self.assertEqual(said(0.03, 20.0, None), "- after, to 0.03: not reached: MISSED")
        self.assertEqual(said(0.03, None, 5.0), "- after, to 0.03: 5.0 s; before: not reached")

    def test_seconds_between_two_points_are_a_power_of_the_error(self) -> None:
        points = [{"seconds": 10.0, "relmse": 0.04}, {"seconds": 1000.0, "relmse": 0.0004}]
        self.assertAlmostEqual(TIME["seconds_at"](points, 0.004), 100.0)
        self.assertEqual(TIME["seconds_at"](points, 0.05), 10.0)
        self.assertIsNone(TIME["seconds_at"](points, 0.0001))
        self.assertIsNone(TIME["seconds_at"]([], 0.1))


if __name__ == "__main__":
    unittest.main()
