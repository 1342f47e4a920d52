# SPDX-License-Identifier: Apache-2.0
"""The units, their benches and what a bench runs."""
import hashlib
import re
from collections.abc import Iterable
from pathlib import Path

from flow.shell import ROOT, Failure, UsageError, read_text, run

LIST = Path("golden/plan/units.hpp")
COVER = Path("tests/signoff/cover")


def names() -> list[str]:
    """In the order of the list of units."""
    found = re.findall(r"^ *UNIT\(\w+, (\w+),", read_text(ROOT / LIST), re.MULTILINE)
    if not found:
        raise Failure(f"{LIST}: expected lines UNIT(Interface, name, ...), found none")
    return found


def chosen(named: list[str]) -> list[str]:
    """Those named, all where none is."""
    every = names()
    for name in named:
        if name not in every:
            raise UsageError(f"{name}: no such unit, expected one of {', '.join(every)}")
    return named or every


def bench(benches: Path, unit: str) -> Path:
    program = benches / f"bench_{unit}"
    if not program.is_file():
        raise Failure(f"{program}: is not built (cmake --build build --target benches)")
    return program


def plans(program: Path) -> list[str]:
    """The plans that a bench lists, all of which the tests rtl.UNIT.* run."""
    return re.findall(r"^plan (\S+)$", run([str(program), "--list"]), re.MULTILINE)


def plans_of(program: Path, named: list[str]) -> list[str]:
    """Those named, all where none is."""
    every = plans(program)
    for plan in named:
        if plan not in every:
            raise UsageError(f"--plan {plan}: {program.name} has none of this name, expected one of {', '.join(every)}")
    return [plan for plan in every if plan in named] or every


def check_plans(benches: Path, of: list[str], named: list[str]) -> None:
    """That every one of these units has the plans that are named, before the first of them runs."""
    for unit in of if named else []:
        plans_of(bench(benches, unit), named)


def made_from(program: Path, others: Iterable[Path] = ()) -> str:
    """A hash of a bench, of all RTL and of other files."""
    made = hashlib.sha256(program.read_bytes())
    for file in [*sorted((ROOT / "rtl").glob("*/*.sv")), *others]:
        made.update(file.read_bytes())
    return made.hexdigest()


def cover(module: str) -> Path:
    """Where a module's cover points stand, if it has any."""
    return ROOT / COVER / f"{module}_cover.sv"


def source(module: str) -> Path:
    """The file of a module, below the project's root."""
    if (ROOT / COVER / f"{module}.sv").is_file():
        return COVER / f"{module}.sv"
    found = sorted((ROOT / "rtl").glob(f"*/{module}.sv"))
    if len(found) != 1:
        raise Failure(f"rtl/*/{module}.sv: expected one such file, found {len(found)}")
    return found[0].relative_to(ROOT)


def modules(unit: str) -> list[str]:
    """The unit's module and all that it instantiates, directly or not."""
    every = {file.stem for file in (ROOT / "rtl").glob("*/*.sv")}
    found: list[str] = []
    ahead = [unit]
    while ahead:
        module = ahead.pop()
        if module in found:
            continue
        found.append(module)
        text = re.sub(r"//[^\n]*|/\*.*?\*/", "", read_text(ROOT / source(module)), flags=re.DOTALL)
        ahead += sorted(every & set(re.findall(r"\b[a-z]\w*\b", text)) - set(found))
    return sorted(found)
