# SPDX-License-Identifier: Apache-2.0
"""scripts/bench: the tables that it writes of what was measured."""
import runpy
import subprocess
import unittest
from typing import Any

from flow.shell import ROOT, read_text, read_toml

BENCH = runpy.run_path(str(ROOT / "scripts" / "bench"))


def spread(median: float) -> dict[str, Any]:
    """Queries a second: 20 % to both sides of the median."""
    return {"least": 0.8 * median, "median": median, "most": 1.25 * median, "runs": 7}


class Tables(unittest.TestCase):
    def cell(self, points: int = 65536, k: int = 5) -> dict[str, Any]:
        return {"points": points, "queries": 1000, "k": k, "recall": 1, "all_cores": {**spread(4e6), "threads": 2, "share": 0.95},
                "spread": {"photonloom": spread(2e6), "nanoflann": spread(1e6), "FLANN": spread(0.5e6), "CGAL": spread(0.8e6)}}

    def test_uniform_points(self) -> None:
        published = [{"name": "L", "source": "a page", "microseconds": {"65536": {"5": 0.63}}}]
        lines = BENCH["uniform_table"]([self.cell(), self.cell(k=6)], published).splitlines()
        self.assertEqual(lines[2], "| 65,536 | 5 | 0.50 (0.40 – 0.62) | 1.00 (0.80 – 1.25) | 2.00 (1.60 – 2.50) | 1.25 (1.00 – 1.56) | 2.00 | "
                                   "0.25 (0.20 – 0.31) | 0.63 |")
        self.assertTrue(lines[3].endswith("| – |"))
        self.assertIn("which had 95 to 95 % of the cores", BENCH["uniform_text"]([self.cell()], published))

    def test_photons(self) -> None:
        cells = [{"photons": 10000, "k": 8, "radius": radius, "ratio": ratio} for radius in (False, True) for ratio in (1.5, 1.2)]
        self.assertEqual(BENCH["photons_table"]({"cells": cells}).splitlines(),
                         ["| photons | k = 8 | k = 8, radius |", "|---|---|---|", "| 10,000 | 1.20 – 1.50 | 1.20 – 1.50 |"])

    def test_what_is_published_and_where_it_goes(self) -> None:
        for library in read_toml(ROOT / "bench" / "published.toml")["library"]:
            self.assertTrue(library["name"] and library["source"])
            self.assertTrue(all(int(n) > 0 and int(k) > 0 for n, some in library["microseconds"].items() for k in some))
        for mark in ("uniform", "photons"):
            self.assertIn(f"<!-- end of {mark} -->", read_text(BENCH["PAGE"]))

    def test_arguments_are_judged_first(self) -> None:
        def told(*arguments: str) -> tuple[int, str]:
            done = subprocess.run([ROOT / "scripts" / "bench", *arguments], capture_output=True, text=True)
            return done.returncode, done.stdout + done.stderr

        self.assertEqual(told("--help")[0], 0)
        self.assertRegex(told("--help")[1], "^usage: bench ")
        for wrong in (["none"], ["photons", "uniform"], ["--none"]):
            self.assertEqual(told(*wrong)[0], 2)


if __name__ == "__main__":
    unittest.main()
