# SPDX-License-Identifier: Apache-2.0
"""Rows of the headline with round figures, which no board and no core ever had."""
import unittest
from typing import Any

from flow.goals import headline_goals
from flow.headline.data import Cores, Rate, Row, SdramLoad
from flow.headline.verdict import Verdict, judge

CORE_CLOCK, SDRAM_CLOCK = "$glbnet$clk", "$glbnet$clk_sdram"


def rate(median: float) -> Rate:
    return {"least": 0.9 * median, "median": median, "most": 1.1 * median, "runs": 7}


def all_cores(median: float) -> Cores:
    return {"threads": 2, "share": 0.987, "rate": rate(median)}


class MadeUp(unittest.TestCase):
    """100 MHz and 10 cycles a gather: 10 Mquery/s; the gatherers' bound is 12.5."""

    def row(self, golden: float = 1e6, library: float = 0.5e6, **others: Any) -> Row:
        row: Row = {"plan": "p", "rejected": "", "shows": "", "coarse": None, "leaf_limit": 0, "recall": 1.0, "lut_eq": 20000,
                    "all_cores": all_cores(2 * golden), "memory": "block_ram", "k": 8, "within_mean": False, "gatherers": 2,
                    "replay_queries": 1024, "digest": "d" * 64, "clock_mhz": 50.0, "versions": ["Yosys 1"],
                    "processor": "a core", "seeds": [1, 2, 3], "fmax_mhz": {"median": 100, "low": 95, "high": 101},
                    "clocks": {CORE_CLOCK: {"median": 100, "low": 95, "high": 101, "constraint": 50.0}},
                    "binding": {"resource": "DP16KD", "used": 104, "of": 208},
                    "fits": {"DP16KD": 3, "LUT4": 12, "MULT18X18D": 6}, "cycles_per_gather": 10,
                    "cost": {"nodes": 12, "leaves": 3.5, "insertions": 16, "bound": 16}, "ports_cycles": 4, "sdram": None,
                    "cores": {"photonloom": rate(golden), "nanoflann": rate(library)}, "uart": 4600}
        whole: Any = {**row, **others}
        changed: Row = whole
        return changed

    def sdram(self, cycles: float = 9.0, reached: float = 105, gain: float = 5, **others: Any) -> Row:
        load: SdramLoad = {"lines": 0.25, "line_bytes": 64, "row_changes": 0.5, "row_change_cycles": 6, "cycles": cycles,
                           "mhz": min(100, reached), "reorder_gain": gain, "reorder_goal": 4}
        row = self.row(memory="sdram", ports_cycles=None, sdram=load, **others)
        assert row["clocks"]
        row["clocks"][SDRAM_CLOCK] = {"median": reached, "low": reached, "high": reached, "constraint": 100.0}
        return row

    def judge(self, row: Row) -> Verdict:
        return judge(row, headline_goals())
