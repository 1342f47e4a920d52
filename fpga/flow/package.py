# SPDX-License-Identifier: Apache-2.0
"""What photonloom says of a plan and writes of it."""
import hashlib
import json
import os
import re
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TypedDict

from flow.boards import Board
from flow.shell import ROOT, beside, read_json, run, said_json, write_json

PHOTONLOOM = os.environ.get("PHOTONLOOM", str(ROOT / "build" / "photonloom"))
UNITS = re.findall(r"^ *UNIT\(\w+, (\w+),", (ROOT / "golden/plan/units.hpp").read_text(), re.MULTILINE)  # the one list


class PlanFacts(TypedDict):
    """Of `photonloom plan --json`: hash and units of the plan; unit -> resource -> prediction; block RAMs of a board's top, and
    with 1, 2, ... gatherers instead; unit -> resource -> term of the prediction -> value."""
    hash: str
    units: list[str]
    resources: dict[str, dict[str, int]]
    board_ebr: dict[str, int]
    board_ebr_of_gatherers: list[int]
    resource_terms: dict[str, dict[str, dict[str, float]]]


class PackageFacts(TypedDict):
    """Of package.json: the clock that the package is constrained to."""
    clock_khz: int


def describe(plan: Path) -> PlanFacts:
    """What photonloom says of a plan."""
    facts: PlanFacts = said_json([PHOTONLOOM, "plan", str(plan), "--json"])
    return facts


def set_options(settings: Sequence[str]) -> list[str]:
    """Options of photonloom that change lines of a plan."""
    return [word for line in settings for word in ("--set", line)]


def generate(plan: Path, folder: Path, board: Board, unit: str | None = None, clock: float | None = None,
             versions: Mapping[str, str] | None = None) -> PackageFacts:
    """A package for a board, in `folder`. What was built of the same files before is kept where it was by tools of the same versions."""
    command = [PHOTONLOOM, "generate", str(plan), "--board", board.name, "-o", str(folder)]
    if unit:
        command += ["--unit", unit]
    if clock:
        command += ["--clock", str(clock)]
    kept, aside = folder / "build", beside(folder, ".built")
    tools = kept / "tools.json"
    shutil.rmtree(aside, ignore_errors=True)
    if kept.is_dir() and (not tools.is_file() or read_json(tools) != versions):
        shutil.rmtree(kept)
    before = tree(folder)
    times = {path: (folder / path).stat().st_mtime_ns for path in before}
    if kept.is_dir():
        kept.rename(aside)  # generate replaces the folder
    try:
        run(command)
    finally:
        if aside.is_dir():
            if tree(folder) == before:
                aside.rename(kept)
                for path, time in times.items():  # or make takes the files for newer than what was built of them
                    os.utime(folder / path, ns=(time, time))
            else:
                shutil.rmtree(aside)
    kept.mkdir(exist_ok=True)
    write_json(tools, versions)
    facts: PackageFacts = read_json(folder / "package.json")
    return facts


def lock_of(folder: Path) -> Path:
    """Held by a command from the generation of a package to its last placement."""
    return beside(folder, ".lock")


def tree(folder: Path) -> dict[str, bytes]:
    """Path -> bytes of all files of a package, what was built apart."""
    files = {}
    for where, folders, names in os.walk(folder):
        if where == str(folder) and "build" in folders:
            folders.remove("build")
        for name in names:
            path = Path(where, name)
            files[str(path.relative_to(folder))] = path.read_bytes()
    return files


def digest(folder: Path, versions: Mapping[str, str]) -> str:
    """SHA-256 of what a package's result depends on: its RTL and constraints, the plan's hash apart, and the tools."""
    text = "".join(f"{path}\0{content!r}\0" for path, content in sorted(tree(folder).items())
                   if path.startswith(("rtl/", "board/")))
    text = re.sub(r"PlanHash = 64'h[0-9a-f]{16}|plan [0-9a-f]{16}", "", text)
    return hashlib.sha256((text + json.dumps(versions)).encode()).hexdigest()
