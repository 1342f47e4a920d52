# SPDX-License-Identifier: Apache-2.0
"""When a unit counts as grown."""
import tempfile
import unittest
from pathlib import Path

from flow.area import FAMILY, compare, measure, median_of, names_before, ranges_of
from flow.goals import area_goals
from flow.shell import Failure

# Yosys that counts a LUT for each wire of the file that it reads first.
YOSYS = """#!/bin/sh
first=$(printf '%s' "$3" | sed 's/read_verilog -sv \\([^ ]*\\) .*/\\1/')
said=$(printf '%s' "$3" | sed 's/.*-o \\([^ ]*\\) stat.*/\\1/')
printf '{"modules": {"%s": {"num_cells_by_type": {"LUT4": %d}}}}' '\\\\reorder_buffer' "$(grep -o wire "$first" | wc -l)" >"$said"
"""


class AreaCheck(unittest.TestCase):
    base = {"LUT4": 1000, "FF": 500, "CCU2C": 100, "DPR16X4": 40, "DP16KD": 4, "MULT18X18D": 0}

    def check(self, **changes: int) -> tuple[list[str], list[str]]:
        return compare("unit", {**self.base, **changes}, self.base, area_goals().growth)

    def test_same_and_small_changes_pass(self) -> None:
        self.assertEqual(self.check(), ([], []))
        self.assertEqual(self.check(LUT4=1030, FF=485), ([], []))

    def test_each_resource_can_fail(self) -> None:
        for name in FAMILY.cells:
            grown, shrunk = self.check(**{name: self.base[name] * 104 // 100 + 1})
            self.assertEqual((len(grown), shrunk), (1, []), name)
            self.assertIn(f"unit: {name}", grown[0])

    def test_growth_is_told_in_percent(self) -> None:
        self.assertEqual(self.check(LUT4=1031)[0], ["unit: LUT4 1000 -> 1031 (+3.1 %)"])

    def test_shrinking_is_told(self) -> None:
        self.assertEqual(self.check(DPR16X4=30), ([], ["unit: DPR16X4 40 -> 30 (-25.0 %)"]))

    def test_the_size_is_the_median_of_each_resource(self) -> None:
        runs = [{"LUT4": lut, "FF": ff} for lut, ff in ((9, 1), (7, 2), (8, 3), (70, 2), (6, 2))]
        self.assertEqual(median_of(runs), {"LUT4": 8, "FF": 2})
        self.assertEqual(median_of(runs[:2]), {"LUT4": 7, "FF": 1})  # a size that was measured

    def test_how_far_the_runs_are_apart_is_told(self) -> None:
        self.assertEqual(ranges_of([{"LUT4": 9, "FF": 2}, {"LUT4": 7, "FF": 2}, {"LUT4": 8, "FF": 2}]), "LUT4 8 (7 to 9), FF 2")

    def test_names_that_nothing_uses(self) -> None:
        self.assertEqual(names_before(0), "module names_before; endmodule\n")
        self.assertEqual(names_before(2), "module names_before; wire name_0; wire name_1; endmodule\n")

    def test_a_growth_that_nothing_exceeds_is_refused(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            goals = Path(folder, "goals.toml")
            for growth in ("nan", "inf", "1.0", "-0.01"):
                goals.write_text(f'[area]\ngrowth = {growth}\nci_yosys = "0.23"\nruns = 5\n')
                with self.assertRaisesRegex(Failure, f"^{goals}: area.growth is {growth}, expected a share of at least 0, below 1$"):
                    area_goals(goals)

    def test_each_run_reads_other_names_before_the_unit(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            yosys = Path(folder, "yosys")
            yosys.write_text(YOSYS)
            yosys.chmod(0o755)
            self.assertEqual([counts["LUT4"] for counts in measure("reorder_buffer", str(yosys), 4, 2)], [0, 1, 2, 3])


if __name__ == "__main__":
    unittest.main()
