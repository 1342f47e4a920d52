# SPDX-License-Identifier: Apache-2.0
"""What the FPGA flow decides, on made-up figures; and photonloom's prediction of block RAM beside what was synthesized."""
import contextlib
import io
import json
import os
import re
import signal
import subprocess
import tempfile
import time
import unittest
from collections.abc import Container
from pathlib import Path
from typing import Any
from unittest import mock

from flow.boards import read_board
from flow.headline.data import read_data
from flow.headline.netlist import plan_digest
from flow.headline.plans import find_plan
from flow.measure import table
from flow.package import PHOTONLOOM
from flow.plans.fit import fit_one, least_squares, relative_error, twins_of
from flow.plans.measurements import Measurement, Measurements, merge
from flow.plans.catalogue import read_catalogue
from flow.plans.pages import COLUMNS, measured_table
from flow.results import Entry, add_placements, core_clocks, median, missed_clocks
from flow.routing import ROUTER_LEAST, ROUTER_MORE, STATIC_ROUNDS, Placement, arcs_left, legalises_for_ever, place, placements, routes_for_ever, seconds_of_group
from flow.shell import ROOT, Failure, first_line, run
from flow.tools import Tools

WORKS = "while :; do :; done"  # until it is ended


@mock.patch("flow.routing.POLL", 0.05)
class Placements(unittest.TestCase):
    def place(self, seeds: int, endless: Container[int], by_default: Container[int] = ()) -> list[tuple[int, str]]:
        """The (seed, placer) that are kept where nextpnr does not end with some seeds, by the static placer and by the default one."""
        with contextlib.redirect_stdout(io.StringIO()):
            return placements("board", range(1, 1 + seeds), "static",
                              lambda seed, placer: None if seed in (endless if placer == "static" else by_default) else (seed, placer))

    def test_a_further_seed_stands_in(self) -> None:
        self.assertEqual(self.place(2, []), [(1, "static"), (2, "static")])
        self.assertEqual(self.place(2, [1]), [(2, "static"), (3, "static")])
        self.assertEqual(self.place(1, [1, 2]), [(3, "static")])

    def test_then_the_default_placer(self) -> None:
        self.assertEqual(self.place(2, range(1, 9)), [(3, "heap"), (4, "heap")])

    def test_the_seeds_that_end_have_to_do(self) -> None:
        self.assertEqual(self.place(3, range(2, 9), range(9)), [(1, "static")])
        with self.assertRaisesRegex(Failure, "^board: nextpnr does not end with any seed of 1, 2, 3$"):
            self.place(1, range(9), range(9))

    def test_what_a_package_is_told(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            package = Path(folder, "package")
            built = package / "build"
            built.mkdir(parents=True)
            (package / "Makefile").write_text("all:\n\t@echo $(PLACER) $(SEED) >told\n")
            for placer, routed in (("heap", "top_seed2"), ("static", "top_seed2_static")):
                (built / f"{routed}.json").write_text('{"fmax": {"clk": {"achieved": 60, "constraint": 50}}, "utilization": {}}')
                (built / f"{routed}.log").write_text("Info: of a run that ended\n")
                self.assertIsNotNone(place(package, "top", 2, Tools([], {}), placer=placer))
                self.assertEqual((package / "told").read_text(), f"{placer} 2\n")
                self.assertTrue((built / f"{routed}.log").is_file(), "the log of a run that ended is kept")

    def place_by(self, makefile: str, placer: str = "static", route_speed: int | None = None) -> Placement | None:
        """What place() gives where a package's Makefile does this for `all`."""
        with tempfile.TemporaryDirectory() as folder:
            package = Path(folder, "package")
            (package / "build").mkdir(parents=True)
            (package / "Makefile").write_text(f"all:\n\t@{makefile}\n")
            return place(package, "top", 2, Tools([], {}), route_speed, placer)

    def test_a_placement_without_its_report_is_made_again(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            package = Path(folder, "package")
            built = package / "build"
            built.mkdir(parents=True)
            (package / "Makefile").write_text("all: build/top_seed2.bit\nbuild/top_seed2.bit: build/top_seed2.config\n\t@touch $@\nbuild/top_seed2.config:\n\t@cp report "
                                              "build/top_seed2.json; touch $@\n")
            (package / "report").write_text('{"fmax": {"clk": {"achieved": 60, "constraint": 50}}, "utilization": {}}')
            for end in ("config", "bit"):
                (built / f"top_seed2.{end}").touch()
            placed = place(package, "top", 2, Tools([], {}))
            assert placed
            self.assertEqual(placed["clocks"]["clk"]["achieved"], 60)

    def test_a_placer_that_does_not_end_is_ended(self) -> None:
        for says in (f"Info: iter={STATIC_ROUNDS + 1} steplen=1", "Info: iter=9 steplen=1\\nInfo: Strict legalising 7 cells..."):
            with self.subTest(says), mock.patch("flow.routing.LEGALISING_LEAST", 0.1), mock.patch("flow.routing.LEGALISING_SHARE", 0):
                self.assertIsNone(self.place_by(f"printf '{says}\\n' >build/top_seed2_static.log; {WORKS}"))

    def router_log(self, *steps: tuple[float, int]) -> str:
        """As nextpnr writes it: of (s since it began, arcs left)."""
        return "Info: Routing 9999 arcs.\n" + "".join(f"Info: {1000 * n:10} | {n:8} {9 * n:10} |  137   862 | {left:9}|       7.31 {at:10.2f}|\n"
                                                      for n, (at, left) in enumerate(steps, start=1))

    def test_arcs_that_a_router_has_left(self) -> None:
        self.assertIsNone(arcs_left(""))
        self.assertIsNone(arcs_left("Info: Routing 9999 arcs.\n"))
        self.assertEqual(arcs_left(self.router_log((1, 500), (9, 320))), 320)
        self.assertEqual(arcs_left(self.router_log((1, 500), (9, 0)) + "Info: Routing complete.\n"), 0)

    def test_a_router_takes_its_time(self) -> None:
        began, late = 700.0, ROUTER_LEAST + 3.0  # s of a core that placing had, and routing
        in_time = round(3 * ROUTER_MORE / late)  # arcs that can be left where one was routed in the last third
        cases: list[tuple[list[tuple[float, int]], bool]] = [
            ([], False), ([(1, 500000)], False), ([(0, 500), (ROUTER_LEAST - 1, 500)], False), ([(0, 500), (late, 500)], True),
            ([(0, 500), (late / 2, 400), (late * 0.8, 400), (late, 400)], True),
            ([(0, 1000 * in_time), (late * 2 / 3, 900 * in_time), (late, 900 * in_time - 800)], True),
            ([(0, 1000 * in_time), (late * 2 / 3, in_time), (late, in_time - 1)], False),
            ([(0, 1000 * in_time), (late * 2 / 3, in_time + 2), (late, in_time + 1)], True),
            ([(0, 9000000), (late * 2 / 3, in_time + 2), (late, in_time + 1)], True)]
        for steps, ever in cases:
            with self.subTest(steps):
                self.assertEqual(routes_for_ever([(began + at, left) for at, left in steps]), ever)

    def test_seconds_of_a_group_are_those_of_its_work(self) -> None:
        with subprocess.Popen(["sh", "-c", f"sh -c '{WORKS}'"], start_new_session=True) as works:
            with subprocess.Popen(["sleep", "600"], start_new_session=True) as sleeps:
                try:
                    while seconds_of_group(works.pid) < 0.2:
                        time.sleep(0.02)
                    self.assertLess(seconds_of_group(sleeps.pid), 0.2)
                finally:
                    for group in (works, sleeps):
                        os.killpg(group.pid, signal.SIGKILL)

    def test_seconds_of_a_group_are_those_of_children_that_have_ended_too(self) -> None:
        script = f"timeout --foreground 0.5 sh -c '{WORKS}'; echo ended; sleep 600; true"
        with subprocess.Popen(["sh", "-c", script], start_new_session=True, stdout=subprocess.PIPE, text=True) as works:
            try:
                assert works.stdout
                self.assertEqual(works.stdout.readline(), "ended\n")
                self.assertGreater(seconds_of_group(works.pid), 0.02)  # what sh and timeout need is less than a tick
            finally:
                os.killpg(works.pid, signal.SIGKILL)

    def test_a_router_that_does_not_get_on_is_ended(self) -> None:
        for placer, route_speed, log in (("static", None, "_static"), ("heap", None, ""), ("heap", 8, "_route8.routed")):
            with self.subTest(placer), tempfile.NamedTemporaryFile("w+") as said, mock.patch("flow.routing.ROUTER_LEAST", 0.3):
                said.write(self.router_log((1, 500)))
                said.flush()
                self.assertIsNone(self.place_by(f"cp {said.name} build/top_seed2{log}.log; {WORKS}", placer, route_speed))

    def test_a_router_that_was_stopped_is_judged_by_what_it_worked(self) -> None:
        # By the clock on the wall it hardly got on in the last third of its time, in which it was stopped.
        steps, works = [(1, 500), (850, 400), (1464, 399)], f"timeout --foreground 0.3 sh -c '{WORKS}'; "
        with tempfile.TemporaryDirectory() as folder:
            for n in range(3):
                Path(folder, str(n)).write_text(self.router_log(*steps[:n + 1]))
            placed = self.place_by("".join(f"cp {folder}/{n} build/top_seed2.log; {works}" for n in range(3)) +
                                   'echo \'{"fmax": {"clk": {"achieved": 60, "constraint": 50}}, "utilization": {}}\' >build/top_seed2.json', "heap")
        assert placed
        self.assertEqual(placed["clocks"]["clk"]["achieved"], 60)

    def test_legalising_takes_its_time(self) -> None:
        rounds, legalising = "Info: iter=9 steplen=1\n", "Info: Strict legalising 7 cells..."
        for log, until, since, ever in ((rounds + legalising, 400, 799, False), (rounds + legalising, 400, 801, True),
                                        (rounds + legalising, 10, 299, False), (rounds + legalising + "\n", 10, 301, True),
                                        (rounds + legalising + "\nInfo: HPWL after legalise: 7\n", 10, 1e6, False), (rounds, 10, 1e6, False)):
            self.assertEqual(legalises_for_ever(log, until, since), ever, (log, until, since))


class Seeds(unittest.TestCase):
    def entry(self, *achieved: tuple[float, float]) -> Entry:
        """An entry of a core constrained to 50 MHz and an SDRAM to 100, with what each seed achieved."""
        placed: list[Placement] = [
            {"seed": seed, "placer": "heap", "utilization": {}, "bitstream": "",
             "clocks": {"core": {"achieved": core, "constraint": 50.0}, "sdram": {"achieved": sdram, "constraint": 100.0}}}
            for seed, (core, sdram) in enumerate(achieved, start=1)]
        entry: Entry = {"name": "board", "digest": "", "top": "", "constraint_mhz": 50.0, "resources": {},
                        "binding": {"resource": "FF", "used": 0, "of": 1}, "seeds": []}
        add_placements(entry, placed, Path("there"))
        return entry

    def test_the_cores_clock(self) -> None:
        entry = self.entry((60, 120), (52, 101), (55, 110))
        self.assertEqual(entry["fmax_mhz"], {"median": 55, "low": 52, "high": 60})
        self.assertTrue(entry["met"])
        self.assertEqual(missed_clocks(entry), [])
        self.assertIn("| 50 |", table([entry]))

    def test_any_clock_can_miss(self) -> None:
        entry = self.entry((60, 120), (52, 99), (55, 98))
        self.assertFalse(entry["met"])
        self.assertEqual([name for name, _ in missed_clocks(entry)], ["sdram"])
        self.assertIn("| 50 (MISSED: 99.0 of 100) |", table([entry]))

    def test_another_placer_is_named(self) -> None:
        entry = self.entry((60, 120), (52, 101))
        self.assertNotIn("placer", table([entry]))
        entry["seeds"][1]["placer"] = "static"
        self.assertIn("\nPlaced by nextpnr's static placer: `board`.\n", table([entry]))

    def test_a_period_of_whole_picoseconds(self) -> None:
        for asked, said in ((100.0, 100.0), (87.5, 87.5043716430664), (93.75, 93.75586), (110.0, 110.01100158691406)):
            entry = self.entry((60, asked + 0.003))
            entry["seeds"][0]["clocks"]["sdram"]["constraint"] = said
            add_placements(entry, entry["seeds"], Path("there"))
            self.assertEqual(entry["clocks"]["sdram"]["constraint"], asked)
            self.assertEqual(missed_clocks(entry), [])

    def test_a_core_as_fast_as_its_sdram(self) -> None:
        entry = self.entry((60, 120))
        clocks = entry["seeds"][0]["clocks"]
        entry["seeds"][0]["clocks"] = {"$glbnet$clk_sdram": clocks["sdram"], "$glbnet$clk": {"achieved": 130.0, "constraint": 100.0}}
        entry["constraint_mhz"] = 100.0
        add_placements(entry, entry["seeds"], Path("there"))
        self.assertEqual(entry["fmax_mhz"], {"median": 130, "low": 130, "high": 130})
        self.assertEqual(core_clocks(entry["clocks"], 100.0), {"$glbnet$clk"})
        self.assertEqual(core_clocks(entry["clocks"], 90.0), set())

    def test_an_estimate_misses_nothing(self) -> None:
        entry = self.entry((60, 99))
        slow = entry["seeds"]
        del entry["met"]
        entry["estimated"] = True
        add_placements(entry, slow, Path("there"))
        self.assertEqual(missed_clocks(entry), [])
        self.assertNotIn("met", entry)
        self.assertIn("| tool's estimate, MHz |", table([entry]))
        self.assertIn("no frequency is claimed", table([entry]))

    def test_a_core_without_its_clock(self) -> None:
        entry = self.entry((60, 120))
        entry["constraint_mhz"] = 51.0
        with self.assertRaisesRegex(Failure, "there: no clock is constrained to 51.0 MHz"):
            add_placements(entry, entry["seeds"], Path("there"))

    def test_median(self) -> None:
        self.assertEqual(median([3, 1, 2]), 2)
        self.assertEqual(median([4, 1, 2, 3]), 2.5)


class MeasuredAgain(unittest.TestCase):
    def measurement(self, plan: str, unit: str, luts: int) -> Measurement:
        return {"plan": plan, "unit": unit, "resources": {"LUT4": luts}}

    def merge(self, yosys: str) -> Measurements:
        data: Measurements = {"board": "b", "versions": {"yosys": "a", "nextpnr-ecp5": "b"},
                              "measurements": [self.measurement("p", "u", 1), self.measurement("p", "v", 1)]}
        merge(data, [self.measurement("p", "u", 2), self.measurement("q", "u", 1)], {"yosys": yosys, "nextpnr-ecp5": "c"})
        return data

    def test_new_takes_the_place_of_old(self) -> None:
        data = self.merge("a")
        self.assertEqual([(m["plan"], m["unit"], m["resources"]["LUT4"]) for m in data["measurements"]],
                         [("p", "u", 2), ("p", "v", 1), ("q", "u", 1)])
        self.assertEqual(data["versions"]["nextpnr-ecp5"], "c")

    def test_counts_of_two_yosys_do_not_mix(self) -> None:
        with self.assertRaisesRegex(Failure, "was measured with a, expected that of b"):
            self.merge("b")


class MeasuredTable(unittest.TestCase):
    def test_clocks_of_one_nextpnr(self) -> None:
        catalogue = read_catalogue()
        name = next(iter(catalogue.scenes))
        counts = {column: 1 for column in COLUMNS}

        def measured(unit: str, by: str) -> Measurement:
            return {"plan": name, "unit": unit, "resources": counts, "fmax_mhz": 95.0, "constraint_mhz": 100.0,
                    "placed_by": f"nextpnr (Version {by})"}
        data: Measurements = {"board": "b", "versions": {catalogue.board.family.nextpnr: "nextpnr (Version 0.11)"},
                              "measurements": [measured("u", "0.11"), measured("v", "0.7")]}
        rows = measured_table(catalogue, data).splitlines()
        self.assertTrue(rows[2].endswith("| 95.0 |") and rows[3].endswith("| – |"))
        self.assertEqual(rows[5], f"Not shown are clocks by another nextpnr than that of the table: `v` of `{name}` (0.7). "
                                  f"`scripts/fpga-plans {name} --update` measures them again.")


class Fitted(unittest.TestCase):
    rows = [{"one": 1.0, "bits": bits} for bits in (1.0, 2.0, 5.0, 9.0)]

    def test_a_line_is_found(self) -> None:
        found = least_squares(self.rows, [13, 16, 25, 37])
        self.assertAlmostEqual(found["one"], 10, places=2)
        self.assertAlmostEqual(found["bits"], 3, places=2)

    def test_no_coefficient_is_negative(self) -> None:
        self.assertEqual(least_squares(self.rows, [40, 30, 20, 10])["bits"], 0)

    def test_each_plan_is_predicted_from_the_others(self) -> None:
        alone: dict[str, list[str]] = {"a": [], "b": [], "c": [], "d": []}
        outlier = fit_one(["a", "b", "c", "d"], self.rows, [13, 16, 25, 74], alone)
        self.assertEqual(outlier.points[3].measured, 74)
        self.assertAlmostEqual(outlier.points[3].predicted, 37, places=1)
        self.assertAlmostEqual(outlier.error, max(abs(relative_error(p.predicted, p.measured)) for p in outlier.points))
        worst = next(p for p in outlier.points if p.plan == outlier.worst)
        self.assertAlmostEqual(outlier.error, abs(relative_error(worst.predicted, worst.measured)))

    def test_a_twin_does_not_predict_its_twin(self) -> None:
        plans, rows = ["a", "b", "c", "d", "e"], [*self.rows, {"one": 1.0, "bits": 9.1}]
        terms = {plan: {"lut": row, "ff": {"one": 1.0}} for plan, row in zip(plans, rows)}
        twins = twins_of(plans, terms)
        self.assertEqual(twins, {"a": [], "b": [], "c": [], "d": ["e"], "e": ["d"]})
        measured = [13, 16, 25, 74, 74]  # d and e off the line of the others
        none: dict[str, list[str]] = {plan: [] for plan in plans}
        self.assertAlmostEqual(fit_one(plans, rows, measured, twins).points[3].predicted, 37, places=1)
        self.assertGreater(fit_one(plans, rows, measured, none).points[3].predicted, 45)

    def test_a_term_of_any_resource_tells_plans_apart(self) -> None:
        terms = {"a": {"lut": {"bits": 9.0}, "ff": {"one": 1.0}}, "b": {"lut": {"bits": 9.0}, "ff": {"one": 1.2}}}
        self.assertEqual(twins_of(["a", "b"], terms), {"a": [], "b": []})

    def test_a_plan_among_twins_alone(self) -> None:
        with self.assertRaisesRegex(Failure, "a: all other plans are its twins"):
            fit_one(["a", "b"], self.rows[:2], [1, 1], {"a": ["b"], "b": ["a"]})

    def test_error_where_nothing_was_measured(self) -> None:
        self.assertEqual(relative_error(0.4, 0), 0)
        self.assertEqual(relative_error(0.6, 0), float("inf"))


class BoardMemories(unittest.TestCase):
    """Block RAMs of a whole top: `photonloom plan` beside what was synthesized, with today's RTL: docs/headline.md names the rows
    of another, whose memories may be others."""

    def predicted(self, plan: Path) -> Any:
        return json.loads(run([PHOTONLOOM, "plan", str(plan), "--json"]))["board_ebr"]["total"]

    def test_of_the_headline(self) -> None:
        self.compare({"block_ram_k8", "sdram_k50"})  # memories_slow.py has all

    def compare(self, names: set[str] | None) -> None:
        rows = {row["plan"]: row for row in read_data()["rows"] if not row["rejected"]}
        self.assertGreaterEqual(len(rows), 6)
        with tempfile.TemporaryDirectory() as work:
            for name, row in rows.items():
                if names is not None and name not in names:
                    continue
                plan = find_plan(name, Path(work))
                if row["digest"] != plan_digest(plan, read_board("ulx3s-85f")):
                    continue
                fullest = row["binding"]
                with self.subTest(name):
                    self.assertEqual(fullest["resource"], "DP16KD")
                    self.assertEqual(self.predicted(plan.path), fullest["used"])

    def test_of_the_readme(self) -> None:
        found = re.search(r"^\| `board` \|.*\| DP16KD (\d+) of 208 \|", (ROOT / "README.md").read_text(), re.MULTILINE)
        assert found
        self.assertEqual(self.predicted(ROOT / "fpga/gatherer.toml"), int(found.group(1)))


class Run(unittest.TestCase):
    def test_a_program_that_is_not_there(self) -> None:
        with self.assertRaisesRegex(Failure, "^/nowhere/program: cannot be started: No such file or directory$"):
            run(["/nowhere/program"])

    def test_a_tool_that_does_not_start_has_no_version(self) -> None:
        self.assertEqual(first_line(["sh", "-c", "echo Yosys 0.52; exit 1"]), "Yosys 0.52")
        self.assertIsNone(first_line(["true"]))
        missing = "yosys: error while loading shared libraries: libtcl8.6.so: cannot open shared object file"
        for script, said in ((f"echo {missing}; exit 1", missing), ("echo not found; exit 127", "not found"), ("exit 126", "status 126")):
            with self.subTest(script), self.assertRaisesRegex(Failure, f"^sh: does not start: {said}$"):
                first_line(["sh", "-c", script])
        with self.assertRaisesRegex(Failure, "^/nowhere/yosys: does not start: No such file or directory$"):
            first_line(["/nowhere/yosys"])

    def test_what_failed_carries_its_last_words(self) -> None:
        with self.assertRaisesRegex(Failure, "sh -c failed: last$"):
            run(["sh", "-c", "echo first; echo last >&2; exit 3"])


if __name__ == "__main__":
    unittest.main()
