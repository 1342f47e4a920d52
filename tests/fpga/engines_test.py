# SPDX-License-Identifier: Apache-2.0
"""Predicted cycles of engines on docs/planner.md: the data of which they are."""
import json
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from flow import engines
from flow.shell import Failure


class DataOfEngines(unittest.TestCase):
    def test_what_is_wrong_names_file_and_field(self) -> None:
        row = {"table": "headline", "plan": "sdram_k8", "within_mean": True, "predicted": 1.5, "simulated": 2}
        for text, said in ((json.dumps({}), "is a table, expected a list"), (json.dumps([{}]), r"\[0\].table is None, expected one of frames, "),
                           (json.dumps([row, {**row, "table": "sdram"}]), r"\[1\].scene is missing, expected a text"),
                           (json.dumps([{**row, "simulated": "2"}]), r'\[0\].simulated is "2", expected a number')):
            with tempfile.TemporaryDirectory() as folder, self.subTest(text), \
                    mock.patch.object(engines, "DATA", Path(folder, "engines.json")):
                engines.DATA.write_text(text)
                with self.assertRaisesRegex(Failure, f"engines.json: {said}"):
                    engines.read_data()

    def test_rows_that_were_measured_again_since(self) -> None:
        now = engines.read_data()
        engines.check_rows(now)
        one = next(e for e in now if e["table"] == "headline")
        for other in ([e for e in now if e is not one], [{**e, "simulated": 1.0} if e is one else e for e in now],
                      [*now, {**one, "plan": "sdram_k51"}]):
            with self.assertRaisesRegex(Failure, "scripts/engine-predictions headline predicts its rows again$"):
                engines.check_rows(other)


if __name__ == "__main__":
    unittest.main()
