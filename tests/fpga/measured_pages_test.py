# SPDX-License-Identifier: Apache-2.0
"""Tables of scripts/fpga on pages, and what they say of the RTL that was measured."""
import unittest

from flow.measured_pages import EARLIER, PAGES, UNRECORDED, recorded, section, today_of, with_age
from flow.shell import ROOT, Failure
from flow.tables import around
from flow.boards import read_board

PLAN = ROOT / "fpga" / "gatherer.toml"
NETLISTS = {"reorder_buffer": "0123456789abcdef", "board": "fedcba9876543210"}
NOW = {name: netlist[:12] for name, netlist in NETLISTS.items()}


class Sections(unittest.TestCase):
    def test_what_was_measured_just_now(self) -> None:
        text = section("| table |\n", "tools", PLAN, NETLISTS)
        self.assertEqual(text, "| table |\n\ntools.\n\nNetlists of `fpga/gatherer.toml`: reorder_buffer `0123456789ab`, board `fedcba987654`.\n")
        self.assertEqual(with_age(text, NOW), text)

    def test_rows_of_earlier_rtl(self) -> None:
        text = section("| table |\n", "tools", PLAN, NETLISTS)
        later = with_age(text, {**NOW, "board": "other"})
        self.assertEqual(later, f"{text}\n{EARLIER}`board`.\n")
        self.assertEqual(with_age(later, {**NOW, "board": "other"}), later)
        self.assertEqual(with_age(later, {}), f"{text}\n{EARLIER}`reorder_buffer`, `board`.\n")
        self.assertEqual(with_age(later, NOW), text)

    def test_a_plan_that_only_its_user_has(self) -> None:
        self.assertEqual(recorded(ROOT.parent / "plan.toml", NETLISTS), "")
        text = section("| table |\n", "tools", ROOT.parent / "plan.toml", NETLISTS)
        self.assertEqual(text, f"| table |\n\ntools.\n\n{UNRECORDED}\n")
        self.assertEqual(with_age(text, {}), text)
        self.assertEqual(today_of(text, read_board("up5k")), {})

    def test_a_plan_that_is_gone(self) -> None:
        text = section("", "tools", ROOT / "gone.toml", NETLISTS)
        with self.assertRaisesRegex(Failure, "^gone.toml: there is no such plan"):
            today_of(text, read_board("ulx3s-85f"))

    def test_each_page_has_its_marks(self) -> None:
        for page, mark in PAGES:
            around(page, mark)


if __name__ == "__main__":
    unittest.main()
