#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The table of ranges in docs/plan.md: what the program expects in each line that concerns a unit. Exit status 1 where the page
says something else; --update writes it."""
import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).parent))
from plan import read_plan
from program import Failure, Program

SOURCE = Path(__file__).resolve().parents[2]
PAGE = SOURCE / "docs" / "plan.md"
MARKS = ("<!-- ranges -->\n", "<!-- end of ranges -->\n")
SECTIONS = ("photon", "global", "caustic", "gather", "gatherer", "reorder", "sampler", "cache", "board", "frame", "pixel")


def expected(program: Program, plan: Path, line: str) -> str:
    """What the program says to a value that no line can have."""
    done = subprocess.run(program.command("plan", plan, "--set", f"{line}=?"), capture_output=True, text=True)
    _, found, said = done.stderr.strip().partition(", expected ")
    if not done.returncode or not found:
        raise Failure(f"{line} = ? is not refused with what was expected: {done.stderr.strip()}")
    return said.replace('"', "`")


def table(program: Program) -> str:
    """A row for each line; lines of a section that expect the same share one."""
    with tempfile.TemporaryDirectory() as folder:
        plan = Path(folder, "plan.toml")
        program.run("plan", SOURCE / "scenes" / "cornell.xml", "--size", "8x8", "--photons", "200", "--k", "4", "-o", plan)
        rows: dict[tuple[str, str], list[str]] = {}
        for line in read_plan(plan):
            section = line.split(".")[0]
            if section in SECTIONS:
                rows.setdefault((section, expected(program, plan, line)), []).append(f"`{line}`")
    return "| line | expects |\n|---|---|\n" + "".join(f"| {', '.join(lines)} | {said} |\n" for (_, said), lines in rows.items())


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--photonloom", default=os.environ.get("PHOTONLOOM", str(SOURCE / "build" / "photonloom")))
    parser.add_argument("--update", action="store_true", help="write the table")
    options = parser.parse_args()
    text = PAGE.read_text(encoding="utf-8")
    start, end = (text.index(mark) for mark in MARKS)
    fresh = text[:start] + MARKS[0] + table(Program(options.photonloom)) + text[end:]
    if options.update:
        PAGE.write_text(fresh, encoding="utf-8")
    elif fresh != text:
        print("docs/plan.md: its ranges are not those of the program: tests/model/ranges.py --update")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
