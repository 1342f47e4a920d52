# SPDX-License-Identifier: Apache-2.0
"""What fpga/planned.json says that its engines are predicted to take is what photonloom predicts today, of the same plans."""
import tempfile
import unittest
from pathlib import Path

from flow.goals import planned_goals
from flow.planned import DATA, Data, plan_scene, predicted
from flow.shell import read_json


class Predictions(unittest.TestCase):
    def test_rows_are_predicted_as_today(self) -> None:
        data: Data = read_json(DATA)
        goals = planned_goals()
        rows = {row["scene"]: row for row in data["rows"]}
        self.assertEqual(sorted(rows), sorted(scene.stem for scene in goals.scenes))
        with tempfile.TemporaryDirectory() as work:
            for scene in goals.scenes:
                with self.subTest(scene.stem):
                    row = rows[scene.stem]
                    today = predicted(row, plan_scene(scene, goals, Path(work))[1])
                    self.assertEqual(f"{row['cycles']:.2f}", f"{today['cycles']:.2f}", "scripts/plan-boards --predict writes today's")


if __name__ == "__main__":
    unittest.main()
