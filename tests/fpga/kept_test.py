# SPDX-License-Identifier: Apache-2.0
"""What is kept of earlier runs and of other tools, what ends with a command, and what of several jobs is told."""
import contextlib
import fcntl
import io
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path
from unittest import mock

from flow import area, fast, planned
from flow.area import Section
from flow.boards import read_board
from flow.goals import headline_goals
from flow.headline import command, tops
from flow.jobs import each
from flow.package import PHOTONLOOM, UNITS, generate
from flow.plans.catalogue import read_catalogue
from flow.plans.measurements import Measurements, check_complete, jobs_of
from flow.routing import forget
from flow.shell import ROOT, Failure, locked
from flow.tables import between
from flow.tools import Tools, require_same
from made_up_rows import MadeUp

SMALL = ROOT / "fpga" / "area.toml"
WAITED = 20.0  # seconds, for what takes less than one
COMMAND = """import sys
sys.path.insert(0, sys.argv[1])
from flow.jobs import each
from flow.shell import exit_with, run
def main():
    each(1, lambda name: run(["sh", "-c", f"echo $$ >{sys.argv[2]}/{name}; sleep 600; true"]), ["first", "second"])
    return 0
exit_with(main)
"""
TALKS = """import sys
sys.path.insert(0, sys.argv[1])
import time
from pathlib import Path
from flow.jobs import each
from flow.shell import exit_with, run, say
def work(name):
    if name == "works":
        run(["sh", "-c", f"echo $$ >{sys.argv[2]}/works; sleep 600; true"])
    while not Path(sys.argv[2], "read").is_file():
        time.sleep(0.02)
    say("to nobody")
def main():
    say("begins")
    if sys.argv[3] == "alone":
        work("talks")
    else:
        each(2, work, ["works", "talks"])
    return 0
exit_with(main)
"""
# Writes all that nextpnr would, and misses a clock.
MISSES = """#!/bin/sh
while [ $# -gt 0 ]; do
  case $1 in --report | --log | --textcfg | --asc | --write) echo of a missed clock >"$2" ;; esac
  shift
done
exit 1
"""


class InFolder(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def program(self, name: str, text: str) -> Path:
        path = self.folder / name
        path.write_text(text)
        path.chmod(0o755)
        return path


class Packages(InFolder):
    board = read_board("ulx3s-85f")

    def built(self, versions: dict[str, str]) -> Path:
        """The report of a placement, where it is kept."""
        generate(SMALL, self.folder / "package", self.board, "reorder_buffer", versions=versions)
        return self.folder / "package" / "build" / "top_seed1.json"

    def test_what_the_same_tools_built_is_kept(self) -> None:
        self.built({"yosys": "1"}).write_text("{}")
        self.assertTrue(self.built({"yosys": "1"}).is_file())

    def test_what_other_tools_built_is_not(self) -> None:
        self.built({"yosys": "1"}).write_text("{}")
        self.assertFalse(self.built({"yosys": "2"}).is_file())
        self.assertFalse(self.built({"yosys": "1"}).is_file())

    def test_what_nobody_knows_who_built_is_not(self) -> None:
        kept = self.built({"yosys": "1"})
        kept.write_text("{}")
        (kept.parent / "tools.json").unlink()
        self.assertFalse(self.built({"yosys": "1"}).is_file())

    def test_a_missed_clock_fails_each_time(self) -> None:
        nextpnr, yosys = self.program("nextpnr", MISSES), self.program("yosys", '#!/bin/sh\nmkdir -p build; for j in $WANTED; do echo "{}" >$j; done\n')
        for name in ("ulx3s-85f", "up5k", "arty-a7-100t"):
            board, package = read_board(name), self.folder / name
            generate(SMALL, package, board, "reorder_buffer")
            netlist = f"build/{board.top('reorder_buffer')}.json"
            for again in (False, True):
                with self.subTest(name, again=again):
                    done = subprocess.run(["make", "-C", str(package), "route", f"NEXTPNR={nextpnr}", f"YOSYS={yosys}"], capture_output=True,
                                          text=True, env={**os.environ, "WANTED": netlist})
                    self.assertTrue((package / netlist).is_file(), done.stderr)
                    self.assertEqual(done.returncode, 2, done.stdout)


class RoutedAgain(InFolder):
    def test_a_placement_is_forgotten_and_no_other(self) -> None:
        built = self.folder / "build"
        built.mkdir()
        mine = ["top_seed1_static.config", "top_seed1_static.json", "top_seed1_static.bit"]
        others = ["top.json", "top_seed1.json", "top_seed11_static.json", "top_seed1_static_route8.json"]
        for name in mine + others:
            (built / name).touch()
        forget(self.folder, "top", 1, "static", 6)
        self.assertEqual(sorted(path.name for path in built.iterdir()), sorted(others))

    def seed(self, again: bool) -> list[str]:
        """Files of seed 1 that a placer finds."""
        board, found = read_board("ulx3s-85f"), list[str]()
        top = tops.Top("p", "d", self.folder, 50.0, {"baud": 1, "down": 1, "up": 1}, 1)
        built = top.package / "build"
        built.mkdir(parents=True, exist_ok=True)
        for name in (f"{board.top()}.json", f"{board.top()}_seed1_static.bit"):
            (built / name).touch()
        (self.folder / "top.json").write_text(json.dumps({"digest": "d", "versions": {}, "resources": {}, "binding": {"resource": "FF", "used": 1, "of": 2}}))

        def place(*_: object) -> None:
            found.extend(path.name for path in built.glob("*_seed1_*"))

        with mock.patch.object(tops, "place", place):
            tops.route_seed(top, 1, "static", tops.Routing(board, Tools([], {}), 1, 1, None, 6, "static", again))
        return found

    def test_route_again_routes_again(self) -> None:
        self.assertEqual(self.seed(again=False), ["ulx3s_85f_top_seed1_static.bit"])
        self.assertEqual(self.seed(again=True), [])


def end_left(leader: int) -> None:
    """Ends what a test that failed left, which would keep its outputs open."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(leader, signal.SIGKILL)


class Ended(InFolder):
    def wait_for(self, what: str, there: object) -> None:
        until = time.monotonic() + WAITED
        while time.monotonic() < until:
            if callable(there) and there():
                return
            time.sleep(0.02)
        self.fail(f"{what}: not within {WAITED:g} s")

    def test_what_a_command_started_ends_with_it(self) -> None:
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(number.name):
                first, second = self.folder / "first", self.folder / "second"
                # Not as nohup would have it, under which these tests may run.
                running = subprocess.Popen([sys.executable, "-B", "-c", COMMAND, str(ROOT / "fpga"), str(self.folder)], stderr=subprocess.DEVNULL,
                                           preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_DFL))
                self.addCleanup(running.kill)
                self.wait_for("a program", lambda: first.is_file() and first.read_text().endswith("\n"))
                leader = int(first.read_text())
                self.addCleanup(end_left, leader)
                running.send_signal(number)
                self.assertEqual(running.wait(WAITED), 128 + number)
                self.wait_for("the end of the program and its children", lambda: not alive(leader))
                self.assertFalse(second.exists(), "the next job is not begun")
                first.unlink()

    def test_a_command_that_nobody_hears_ends(self) -> None:
        for workers in ("alone", "two"):
            with self.subTest(workers):
                works, read = self.folder / "works", self.folder / "read"
                running = subprocess.Popen([sys.executable, "-B", "-c", TALKS, str(ROOT / "fpga"), str(self.folder), workers],
                                           stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
                assert running.stdout and running.stderr
                self.addCleanup(running.stderr.close)
                self.addCleanup(running.kill)
                self.assertRegex(running.stdout.readline(), ": begins$")
                if workers == "two":
                    self.wait_for("a program", lambda: works.is_file() and works.read_text().endswith("\n"))
                running.stdout.close()
                read.touch()
                self.assertEqual(running.wait(WAITED), 128 + signal.SIGPIPE)
                self.assertEqual(running.stderr.read(), "")
                if workers == "two":
                    leader = int(works.read_text())
                    self.addCleanup(end_left, leader)
                    self.wait_for("the end of the program and its children", lambda: not alive(leader))
                read.unlink()

    def test_one_at_a_time(self) -> None:
        lock, done = self.folder / "lock", threading.Event()

        def other() -> None:
            with locked(lock):
                done.set()

        said = io.StringIO()
        with contextlib.redirect_stdout(said):
            with locked(lock):
                waiting = threading.Thread(target=other)
                waiting.start()
                self.assertFalse(done.wait(0.1))
            waiting.join(WAITED)
        self.assertTrue(done.is_set())
        self.assertEqual(said.getvalue(), "", "the command's own threads are no other command")

    def test_another_command_is_waited_for_and_named(self) -> None:
        lock, said = self.folder / "lock", io.StringIO()
        held = open(lock, "w")
        fcntl.flock(held, fcntl.LOCK_EX)  # by none that this process knows of

        def give() -> None:
            self.wait_for("the sentence", said.getvalue)
            held.close()

        giving = threading.Thread(target=give)
        giving.start()
        with contextlib.redirect_stdout(said), locked(lock):
            giving.join(WAITED)
        self.assertRegex(said.getvalue(), f": waits for another command, which holds {lock}\n$")


def alive(group: int) -> bool:
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


class Jobs(unittest.TestCase):
    def test_results_keep_their_order(self) -> None:
        self.assertEqual(each(2, lambda number: number * number, [3, 1, 2]), [9, 1, 4])

    def test_a_failure_does_not_end_the_others_and_each_is_told(self) -> None:
        done: list[int] = []

        def one(number: int) -> None:
            if number % 2:
                raise Failure(f"{number} is odd")
            done.append(number)

        errors = io.StringIO()
        with contextlib.redirect_stderr(errors), self.assertRaisesRegex(Failure, "^1 is odd$"):
            each(1, one, [1, 2, 3, 4])
        self.assertEqual(done, [2, 4])
        self.assertRegex(errors.getvalue(), ": 3 is odd\n$")


class Data(InFolder):
    def test_rows_of_other_tools_are_not_mixed(self) -> None:
        tools = Tools([], {"yosys": "2", "nextpnr": "1"})
        require_same({"yosys": "2"}, tools, Path("rows.json"), "all")
        with self.assertRaisesRegex(Failure, "^rows.json: its rows were made by 1, but yosys is 2; all makes all of them again$"):
            require_same({"yosys": "1"}, tools, Path("rows.json"), "all")

    def test_every_plan_is_measured_and_no_other(self) -> None:
        catalogue = read_catalogue()
        data: Measurements = {"board": "b", "versions": {},
                              "measurements": [{"plan": job["plan"], "unit": job["unit"], "resources": {}} for job in jobs_of(catalogue, [])]}
        check_complete(catalogue, data)
        last = data["measurements"].pop()
        with self.assertRaisesRegex(Failure, f"has no {last['unit']} of {last['plan']}, which fpga/plans.toml asks for"):
            check_complete(catalogue, data)
        data["measurements"] += [last, {"plan": "none", "unit": "reorder_buffer", "resources": {}}]
        with self.assertRaisesRegex(Failure, "has reorder_buffer of none, which fpga/plans.toml does not ask for"):
            check_complete(catalogue, data)

    def test_a_baseline_of_two_plans(self) -> None:
        section = Section(Path("baseline.json"), "0.23", {"plan": "a", **{unit: {} for unit in UNITS}})
        with mock.patch.object(area, "counted", return_value={name: 1 for name in area.FAMILY.cells}):
            with self.assertRaisesRegex(Failure, "^baseline.json: was made of plan a, but fpga/area.toml is b; expected --update without names, for "):
                section.update(UNITS[:1], "yosys", "b")
            section.update(UNITS[:1], "yosys", "a")
            section.update(UNITS, "yosys", "b")
        self.assertEqual(section.values["plan"], "b")
        self.assertEqual(section.values[UNITS[-1]]["LUT4"], 1)

    def test_a_sentence_behind_the_table_is_noticed(self) -> None:
        for module, mark in ((fast, "fast"), (planned, "planned")):
            with self.subTest(mark), mock.patch.object(module, "stale_rows", return_value=[]), mock.patch.object(module, "page", return_value="table\n"), \
                    mock.patch.object(module, "PAGE", self.folder / "page.md"), mock.patch("sys.argv", [mark, "--check"]), \
                    contextlib.redirect_stdout(io.StringIO()):
                module.PAGE.write_text(f"<!-- {mark} -->\ntable\n<!-- end of {mark} -->\n")
                self.assertEqual(between(module.PAGE, mark), "table\n")
                self.assertEqual(module.main(), 0)
                module.PAGE.write_text(f"<!-- {mark} -->\ntable\n\nRouted with earlier RTL: all.\n<!-- end of {mark} -->\n")
                with self.assertRaisesRegex(Failure, "page.md: is not what "):
                    module.main()


class Published(MadeUp):
    def test_rows_that_no_page_shows_are_not_written(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            data = Path(folder, "headline.json")
            data.write_text(json.dumps({"board": "ulx3s-85f", "rows": [], "link": {"baud": 1, "down": 1, "up": 1}}))
            before = data.read_text()
            with mock.patch.object(command, "DATA", data), mock.patch.object(command, "read_data", return_value={**json.loads(before), "replay": None, "images": []}), \
                    self.assertRaisesRegex(Failure, r"rows\[0\].plan is none, expected one of "):
                command.publish([self.row(plan="none")], None, [], None, headline_goals(), Path(folder), True)
            self.assertEqual(data.read_text(), before)


if __name__ == "__main__":
    unittest.main()
