# SPDX-License-Identifier: Apache-2.0
"""Data files that are not what their type says: the file, the field, and what was expected."""
import json
import tempfile
import unittest
from pathlib import Path
from typing import Any, NotRequired, TypedDict

from flow.shell import Failure
from flow.typed_json import checked_json, typed


class Part(TypedDict):
    name: str
    mhz: float | None
    seeds: NotRequired[list[int]]


class Whole(TypedDict):
    parts: list[Part]
    counts: dict[str, int]
    best: Part | None
    met: bool
    other: Any


PART: dict[str, Any] = {"name": "a", "mhz": 1, "seeds": [1], "beside": 0}
WHOLE: dict[str, Any] = {"parts": [PART], "counts": {"FF": 3}, "best": None, "met": True, "other": [None]}


class Typed(unittest.TestCase):
    def read(self, value: Any) -> Whole:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "data.json")
            path.write_text(json.dumps(value))
            return checked_json(path, Whole)

    def test_what_is_right(self) -> None:
        right: list[dict[str, Any]] = [{}, {"best": PART}, {"parts": []}, {"parts": [{"name": "a", "mhz": None}, {"name": "a", "mhz": 1.5}]}]
        for others in right:
            self.assertEqual(self.read({**WHOLE, **others}), {**WHOLE, **others})

    def test_what_is_wrong(self) -> None:
        wrong: list[tuple[Any, str]] = [
            ([], "is a list, expected a table"), (None, "is null, expected a table"), ("x", 'is "x", expected a table'),
            ({}, "parts is missing, expected a list"),
            ({**WHOLE, "parts": {}}, "parts is a table, expected a list"),
            ({**WHOLE, "parts": [PART, {}]}, r"parts\[1\].name is missing, expected a text"),
            ({**WHOLE, "parts": [5]}, r"parts\[0\] is 5, expected a table"),
            ({**WHOLE, "parts": [{"name": 5, "mhz": 1}]}, r"parts\[0\].name is 5, expected a text"),
            ({**WHOLE, "parts": [{"name": "a", "mhz": "1"}]}, r'parts\[0\].mhz is "1", expected a number or null'),
            ({**WHOLE, "parts": [{"name": "a"}]}, r"parts\[0\].mhz is missing, expected a number or null"),
            ({**WHOLE, "parts": [{**PART, "seeds": [1, 2.5]}]}, r"parts\[0\].seeds\[1\] is 2.5, expected a whole number"),
            ({**WHOLE, "counts": {"FF": True}}, "counts.FF is true, expected a whole number"),
            ({**WHOLE, "counts": []}, "counts is a list, expected a table"),
            ({**WHOLE, "best": {"name": "a"}}, "best.mhz is missing, expected a number or null"),
            ({**WHOLE, "best": 1}, "best is 1, expected a table or null"),
            ({**WHOLE, "met": 1}, "met is 1, expected true or false")]
        for value, said in wrong:
            with self.subTest(said), self.assertRaisesRegex(Failure, f"data.json: {said}$"):
                self.read(value)

    def test_a_part_of_a_file(self) -> None:
        self.assertEqual(typed([1], list[int], Path("a.json"), "rows"), [1])
        with self.assertRaisesRegex(Failure, r"^a.json: rows\[0\] is null, expected a whole number$"):
            typed([None], list[int], Path("a.json"), "rows")


if __name__ == "__main__":
    unittest.main()
