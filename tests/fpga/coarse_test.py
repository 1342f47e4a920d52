# SPDX-License-Identifier: Apache-2.0
"""Rows in coarser formats: what they are judged by, what the page says of them, and what their formats cost."""
import tempfile
import unittest
from pathlib import Path
from typing import Any
from unittest import mock

from flow.goals import CoarseGoals, headline_goals
from flow.headline import page, tables
from flow.headline.data import Coarse, Row, of_headline
from flow.headline.formats import formats_relmse
from flow.headline.plans import VARIANTS, HeadlinePlan, check_variants, clock_of, coarse_names, coarse_plan, find_plan, known_names, why_rejected
from flow.headline.rows import photon_bytes
from flow.headline.verdict import judge_coarse
from flow.shell import ROOT, Failure, field, read_toml
from made_up_rows import CORE_CLOCK, MadeUp

GOALS = CoarseGoals(relmse=1e-4, times=1.25)


class Coarser(MadeUp):
    def coarse(self, relmse: float = 2e-5, **others: Any) -> Row:
        """Twelve million queries a second, unless others say so."""
        formats: Coarse = {"finer": "p", "photon_bytes": 8, "relmse": relmse, "finer_bytes": 12, "finer_relmse": 1e-7}
        return self.sdram(plan="p_coarse", coarse=formats, **{"cycles_per_gather": 8, **others})

    def test_it_is_judged_beside_the_row_of_its_radius(self) -> None:
        rows = [self.sdram(), self.sdram(within_mean=True, cycles_per_gather=9)]
        open_row, near = (judge_coarse(self.coarse(within_mean=within), rows, GOALS) for within in (False, True))
        self.assertEqual((open_row.times, open_row.missed), (1.25, []))
        self.assertEqual(near.missed, ["1.12 times the rate of p, goal 1.25"])
        self.assertAlmostEqual(near.times or 0, 9 / 8)

    def test_formats_that_cost_too_much_fail_however_quick_they_are(self) -> None:
        self.assertEqual(judge_coarse(self.coarse(1e-4), [self.sdram()], GOALS).missed, [])
        self.assertEqual(judge_coarse(self.coarse(1.01e-4, cycles_per_gather=1), [self.sdram()], GOALS).missed,
                         ["relMSE 1.0e-04, at most 1e-04"])

    def test_a_missed_clock_fails_it(self) -> None:
        slow = self.coarse(clocks={CORE_CLOCK: {"median": 49, "low": 48, "high": 50, "constraint": 50.0}})
        self.assertEqual(self.judge(slow).missed, ["clk reaches 49.0 MHz of 50"])
        self.assertIn("| no, **missed**: clk reaches 49.0 MHz of 50 |", tables.coarse_table([(slow, self.judge(slow))], [self.sdram()], GOALS))

    def test_reordering_that_gains_too_little_fails_it(self) -> None:
        row = self.coarse(gain=3)
        self.assertIn("| no, **missed**: reordering gains 3.00, goal 4 |", tables.coarse_table([(row, self.judge(row))], [self.sdram()], GOALS))

    def test_its_share_of_its_bound_is_no_goal(self) -> None:
        self.assertEqual(self.judge(self.coarse(cycles_per_gather=20)).missed, [])

    def test_without_the_other_row_nothing_is_said_to_be_reached(self) -> None:
        alone = judge_coarse(self.coarse(), [], GOALS)
        self.assertEqual((alone.times, alone.missed), (None, []))
        row = self.coarse()
        self.assertIn("| – | 1.25 | – |", tables.coarse_table([(row, self.judge(row))], [], GOALS))

    def test_it_is_none_of_the_headlines_rows_and_has_no_goal_of_a_core(self) -> None:
        row = self.coarse()
        self.assertFalse(of_headline(row))
        self.assertIsNone(self.judge(row).goal)

    def test_the_page_has_both_plans_figures(self) -> None:
        row = self.coarse()
        text = page.coarse_text([(row, self.judge(row))], [self.sdram(), row], GOALS)
        self.assertIn("| p_coarse | none | 8 (12) | 2.0e-05 (1.0e-07) | 12.50 (10.00) | 1.25 | 1.25 | yes |", text)
        self.assertIn("may cost a relMSE of at most 1e-04", text)
        for name in coarse_names():
            self.assertIn(f"; not measured, `make headline PLAN={name} HEADLINE_FLAGS=--page` does.", text)
        self.assertIn("`photon.position_bits=", text)
        self.assertIn("`sdram_k8_coarse` is `sdram_k8` with ", text)

    def test_goals_are_read(self) -> None:
        goals = headline_goals().coarse
        self.assertEqual((goals.relmse, goals.times), (1e-4, 1.25))


class Plans(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = Path(folder.name)

    def test_each_names_a_plan_with_more_bytes_and_the_same_clock(self) -> None:
        for name in coarse_names():
            plan = find_plan(name, self.work)
            self.assertTrue(plan.finer and not plan.rejected and not plan.shows)
            finer = find_plan(plan.finer, self.work)
            self.assertLess(photon_bytes(plan), photon_bytes(finer))
            self.assertEqual(*(field(read_toml(p.path), p.path, "board.sdram_khz", int, "kHz") for p in (plan, finer)))

    def test_a_base_that_is_missing_names_file_and_field(self) -> None:
        variants = self.work / "headline.toml"
        variants.write_text("[coarse.a]\nset = []\n")
        with self.assertRaisesRegex(Failure, "headline.toml: coarse.a.base"):
            coarse_plan("a", self.work, variants)

    def test_a_core_may_be_asked_for_a_clock_of_its_own(self) -> None:
        variants = self.work / "headline.toml"

        def clocks(text: str) -> list[float | None]:
            variants.write_text(f'{text}\n[rejected.a]\n[variant.b]\n[coarse.c]\n')
            return [clock_of(name, variants) for name in ("a", "b", "c", "sdram_k8")]

        self.assertEqual(clocks("[clock]\na = 75\nb = 62.5\nsdram_k8 = 1"), [75, 62.5, None, 1])
        for text, expected in (("[clock]\nc = 0", "clock.c is 0, expected 1 to 400 MHz"), ("[clock]\nc = nan", "clock.c is nan, expected 1 to 400 MHz"),
                               ('[clock]\nc = "75"', "clock.c is '75', expected MHz of the core"),
                               ("[clock]\nsdram_k9 = 75", "clock.sdram_k9 is of no plan, expected some of block_ram_k16, "),
                               ("", "clock is missing, expected a table of MHz")):
            with self.assertRaisesRegex(Failure, f"headline.toml: {expected}"):
                clocks(text)
        name = "sdram_k16"
        with mock.patch("flow.headline.plans.clock_of", lambda of: 75.0 if of == name else None):
            plan = find_plan(name, self.work)
            self.assertEqual(plan.clock, 75)
            self.assertEqual(find_plan(str(plan.path), self.work), plan)
            own = self.work / f"{name}.toml"
            own.write_text(plan.path.read_text())
            self.assertEqual(find_plan(str(own), self.work), HeadlinePlan(name, own))
            self.assertIsNone(find_plan("sdram_k8", self.work).clock)

    def test_what_is_wrong_with_the_file_of_plans(self) -> None:
        """All of it is told before anything is built."""
        variants = self.work / "headline.toml"
        right = VARIANTS.read_text()
        for old, new, said in (('set = ["gather.leaf_limit=4"]', "set = [4]", r"variant.block_ram_k8_leaves4.set is \[4\], expected a list of strings"),
                               ("[variant.block_ram_k1]", "[variant.sdram_k8]", "variant.sdram_k8 is the name of another plan too, expected each name once"),
                               ("[variant.block_ram_k1]", "[variant.sdram_k8_coarse]", "coarse.sdram_k8_coarse is the name of another plan too, "),
                               ('base = "sdram_k50"', 'base = "sdram_k51"', "rejected.sdram_k50_candidates2.base is sdram_k51, expected one of block_ram_k16, "),
                               (f'why = "{why_rejected("sdram_k16_contexts16")}"', 'why = ""',
                                "rejected.sdram_k16_contexts16.why is empty, expected why it"),
                               ("why = ", "because = ", "rejected.sdram_k16_contexts16.why is missing, expected why it"),
                               ("shows = ", "tells = ", "variant.block_ram_k1.shows is missing, expected what it shows"),
                               ("[clock]", '[clock]\nsdram_k16 = "75"', "clock.sdram_k16 is '75', expected MHz of the core"),
                               ("[clock]", "[clock]\nsdram_k17 = 75", "clock.sdram_k17 is of no plan, ")):
            self.assertIn(old, right)
            variants.write_text(right.replace(old, new))
            with self.subTest(new), self.assertRaisesRegex(Failure, f"headline.toml: {said}"):
                check_variants(variants)
        self.assertEqual(len(set(known_names())), len(known_names()))
        check_variants()

    def test_relmse_is_that_of_golden_beside_reference(self) -> None:
        """Positions of 11 bits cost more than those of 16, and those cost something."""
        plans = [find_plan(coarse_names()[0], self.work), find_plan(find_plan(coarse_names()[0], self.work).finer, self.work)]
        small = [self.small(plan) for plan in plans]
        coarse, fine = (formats_relmse(path, ROOT / "scenes" / "cornell.xml", self.work) for path in small)
        self.assertGreater(fine, 0)
        self.assertGreater(coarse, 10 * fine)

    def small(self, plan: HeadlinePlan) -> Path:
        text = plan.path.read_text()
        for line, value in (("width = 48", "width = 8"), ("height = 48", "height = 8")):
            self.assertIn(line, text)
            text = text.replace(line, value)
        path = self.work / f"small_{plan.name}.toml"
        path.write_text(text)
        return path
