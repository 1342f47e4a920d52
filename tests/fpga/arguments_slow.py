# SPDX-License-Identifier: Apache-2.0
"""Wrong arguments: status 2 and a sentence, before tools are looked for, fetched or run."""
import os
import subprocess
import tempfile
import unittest
from collections.abc import Mapping
from pathlib import Path

from flow.boards import UnknownBoard, read_board
from flow.shell import ROOT


def told(*command: str, environment: Mapping[str, str] | None = None) -> tuple[int, str]:
    """Status, and the last line that is not make's own."""
    done = subprocess.run(command, cwd=ROOT, env={**os.environ, **(environment or {})}, capture_output=True, text=True)
    lines = [line for line in (done.stdout + done.stderr).splitlines() if not line.startswith("make")]
    return done.returncode, lines[-1] if lines else ""


class Scripts(unittest.TestCase):
    def refused(self, sentence: str, script: str, *arguments: str) -> None:
        status, said = told(f"scripts/{script}", *arguments)
        self.assertRegex(said, f"^{script}: .*{sentence}")
        self.assertEqual(status, 2)

    def test_numbers(self) -> None:
        self.refused("--seeds: is 0, expected a whole number of at least 1$", "fpga", "--seeds", "0")
        self.refused("--first-seed: is -5, expected", "fpga", "--first-seed", "-5")
        self.refused("--seeds: the last one is 2147483649, expected at most 2147483647$", "fpga", "--first-seed", "2147483647")
        for clock in ("0", "-1", "nan", "inf", "9999"):
            self.refused(f"--clock: is {clock}, expected a number from 1 to 400$", "fpga", "--clock", clock)
            self.refused(f"--clock: is {clock}, expected a number from 1 to 400$", "headline", "--clock", clock)
        self.refused("--first-seed: is -1, expected", "headline", "--first-seed", "-1")
        for seeds in ("0", "-1", "1.5"):
            self.refused(f"--seeds: is {seeds}, expected a whole number of at least 1$", "fpga-fast", "--seeds", seeds)
        self.refused("--jobs: is 0, expected", "fpga-plans", "--jobs", "0")
        self.refused("--jobs: is 1.5, expected a whole number of at least 1$", "plan-boards", "--jobs", "1.5")
        self.refused("--seed: is 0, expected", "plan-boards", "--seed", "0")

    def test_names(self) -> None:
        self.refused("there is no board none, expected one of ", "fpga", "--board", "none")
        self.refused("none.toml: there is no such plan", "fpga", "none.toml")
        self.refused("none.toml: there is no such plan, expected a file or one of ", "headline", "none.toml")
        self.refused("there are two plans sdram_k8, expected each name once$", "headline", "sdram_k8", "fpga/headline/sdram_k8.toml")
        self.refused("there is no scene none, expected some of cornell, ", "plan-boards", "none")
        self.refused("--units: there is no none, expected some of ", "fpga-plans", "small", "--units", "none")
        self.refused("there is no option --none, expected ", "fpga-tools", "--none")

    def test_each_name_once(self) -> None:
        self.refused("--units: cdf_sampler is named twice, expected each once$", "fpga", "--units", "cdf_sampler,cdf_sampler")
        self.refused("--units: there is no , expected some of ", "fpga", "--units", "")
        self.refused("scene cornell is named twice, expected each once$", "plan-boards", "cornell", "cornell")
        self.refused("plan k8 is named twice, expected each once$", "fpga-fast", "k8", "k8")
        self.refused("plan small is named twice, expected each once$", "fpga-plans", "small", "small")
        self.refused("unit cdf_sampler is named twice, expected each once$", "area-check", "cdf_sampler", "cdf_sampler")

    def test_what_would_do_nothing(self) -> None:
        self.refused("--clock: is the board's, expected board among --units$", "fpga", "--units", "cdf_sampler", "--clock", "60")
        self.refused("--readme: README.md has a table of ulx3s-85f, expected that board or --page$", "fpga", "--board", "arty-a7-100t", "--readme")
        for option in ("--replay-only", "--images-only", "--render", "--check"):
            self.refused(f"{option} is of the whole page, expected no plans$", "headline", "sdram_k8", option)
        self.refused("not allowed with argument --render", "headline", "--render", "--check")
        self.refused("--page is of what is measured, expected none of ", "headline", "--page", "--route-only")
        for option in ("--images-only", "--render", "--check"):
            self.refused(f"--clock is of what is routed, and {option} routes nothing; expected none of --", "headline", option, "--clock", "60")
        self.refused("--first-seed is of what is routed, and --replay-only routes nothing; expected none of --", "headline", "--replay-only", "--first-seed", "0")
        self.refused("--jobs is of what is routed, and --check routes nothing; expected none of --", "headline", "--check", "--jobs", "2")
        self.refused("--results is of what is routed, and --images-only routes nothing; expected none of --", "headline", "--images-only", "--results", "d")
        self.refused("--results is of what is routed, and --check routes nothing; expected none of --", "plan-boards", "--check", "--results", "d")
        self.refused("--jobs is of what is routed, and --render routes nothing; expected none of --", "plan-boards", "--render", "--jobs", "2")
        self.refused("--route-again is of what is routed, and --render routes nothing; expected none of --", "headline", "--render", "--route-again")
        self.refused("--check and --render are of the whole table, expected no scenes$", "plan-boards", "cornell", "--check")
        for option in ("--predict", "--render", "--check"):
            self.refused(f"--seed is of what is routed, and {option} routes nothing; expected none of --", "plan-boards", option, "--seed", "1")
        self.refused("--placer is of what is routed, and --predict routes nothing; expected none of --", "plan-boards", "cornell", "--predict", "--placer", "heap")
        self.refused("--check, --render and --cycles are of the whole table, expected no plans$", "fpga-fast", "k8", "--cycles")
        self.refused("--no-route takes no Fmax, which fpga/plans.json has of scenes' plans; expected plans with it$", "fpga-plans", "--no-route")
        self.refused("--plans-only, --fit and --check are of all plans, expected none by name$", "fpga-plans", "small", "--check")

    def test_what_would_fail_after_hours(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            own = Path(folder, "own.toml")
            own.write_text((ROOT / "fpga/headline/block_ram_k8.toml").read_text())
            self.refused("--page: .*own.toml is a plan of its own, ", "headline", str(own), "--page", "--dry-run")
            own.write_text(own.read_text().replace("\nk = 8 ", "\nk = 7 "))
            self.refused("own.toml: .*goals.toml: headline.times_core.block_ram.7 is missing, expected a goal", "headline", str(own), "--dry-run")

    def test_files_that_are_none(self) -> None:
        for script in ("headline", "plan-boards"):
            self.refused("--results: README.md is a file, expected a folder$", script, "--results", "README.md")
        self.refused("/true: is no text, expected UTF-8$", "fpga", "--page", "/bin/true")

    def test_units_of_the_sign_off(self) -> None:
        for script in ("signoff", "mutate-auto"):
            self.refused("none: no such unit, expected one of ", script, "none")
        self.refused("--count: is 0, expected a whole number of at least 1$", "mutate-auto", "--count", "0", "--read")
        self.refused("--seeds: is 0, expected a whole number of at least 1$", "faults", "--seeds", "0", "--join", "none.jsonl")

    def test_proofs(self) -> None:
        self.refused("none: no such property in ", "formal", "none")
        self.refused("--jobs: is 0, expected a whole number of at least 1$", "formal", "--jobs", "0")
        self.refused("--limit: is 0, expected a number above 0$", "formal", "--limit", "0")

    def test_a_board_is_a_name_and_no_path(self) -> None:
        for name in ("../boards/up5k", "./up5k", "up5k/", "", "."):
            with self.assertRaisesRegex(UnknownBoard, "^there is no board "):
                read_board(name)

    def test_what_the_page_would_not_say(self) -> None:
        self.refused(r"--page: --clock is of a single run, expected the clock of a plan of the page in \[clock\] of fpga/headline.toml$",
                     "headline", "sdram_k16", "--clock", "75", "--page", "--dry-run")
        self.refused("README.md: is not TOML: .*", "headline", "README.md", "--dry-run")
        with tempfile.TemporaryDirectory() as folder:
            own = Path(folder, "block_ram_k8.toml")
            own.write_text((ROOT / "fpga/headline/block_ram_k8.toml").read_text())
            self.refused("block_ram_k8.toml: block_ram_k8 is a plan of the page, expected a name of its own$", "headline", str(own), "--dry-run")
            own.write_text("gather = 5\n")
            self.refused("block_ram_k8.toml: ", "headline", str(own), "--dry-run")


class Make(unittest.TestCase):
    def test_arguments_come_before_builds_and_tools(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            # What a verb would build or fetch with leaves its mark.
            for name in ("cmake", "apt-get"):
                Path(folder, name).write_text(f"#!/bin/sh\ntouch {folder}/started\nexit 1\n")
                Path(folder, name).chmod(0o755)
            path = {"PATH": f"{folder}:{os.environ['PATH']}"}
            for arguments, sentence in ((["fpga", "BOARD=none"], "there is no board none"), (["fpga", "SEEDS=0"], "--seeds: is 0"),
                                        (["fpga", "CLOCK=0"], "--clock: is 0"), (["fpga", "UNITS=none"], "--units: there is no none"),
                                        (["headline", "PLAN=none.toml"], "none.toml: there is no such plan"),
                                        (["fpga-tools", "BOARD=none"], "there is no board none"),
                                        (["formal", "FORMAL_FLAGS=none"], "none: no such property")):
                status, said = told("make", *arguments, environment=path)
                self.assertIn(sentence, said)
                self.assertEqual(status, 2)
                self.assertFalse(Path(folder, "started").exists(), arguments)


if __name__ == "__main__":
    unittest.main()
