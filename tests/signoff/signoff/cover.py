# SPDX-License-Identifier: Apache-2.0
"""Cover points: events in the middle of a module that a bench is to bring about. Those of a module stand in tests/signoff/cover/MODULE_cover.sv,
whose ports and parameters have the names of the module's own signals and parameters. The sign-off binds it into a copy of the RTL; nothing
else knows of it."""
import re
import shutil
from dataclasses import dataclass
from pathlib import Path

from flow.shell import ROOT, Failure, read_text

from . import units
from .coverage import Point

_POINT = re.compile(r" *(\w+): cover property \(@\(posedge clk_i\)")
# Ahead of a file's first line: only points are counted. A point may look at some bits of a signal, and be constant in some plans.
_AHEAD = "/* verilator coverage_off */ /* verilator lint_off UNUSEDSIGNAL */ /* verilator lint_off CMPCONST */ /* verilator lint_off UNSIGNED */ "
_PARAMETER = re.compile(r"^ *parameter .*?(\w+),?$", re.MULTILINE)


@dataclass(frozen=True)
class Named:
    point: Point
    module: str  # that it looks into
    why: str


def modules(unit: str) -> list[str]:
    """Those of the unit's modules that have cover points."""
    return [module for module in units.modules(unit) if units.cover(module).is_file()]


def read(module: str, text: str) -> list[Named]:
    """The points of a module's file, each with the comment above it."""
    found: list[Named] = []
    comment: list[str] = []
    for number, line in enumerate(text.splitlines(), 1):
        point = _POINT.match(line)
        if point:
            if not comment:
                raise Failure(f"{units.COVER}/{module}_cover.sv, line {number}: {point[1]}: expected a comment above it that says why it matters")
            if point[1] in (named.point.what for named in found):
                raise Failure(f"{units.COVER}/{module}_cover.sv, line {number}: {point[1]}: there are two of this name")
            found.append(Named(Point(f"{module}_cover", "user", number, point[1]), module, " ".join(comment)))
        elif re.search(r"\bcover\b", line.split("//")[0]):
            raise Failure(f"{units.COVER}/{module}_cover.sv, line {number}: expected NAME: cover property (@(posedge clk_i) ..., found {line.strip()}")
        said = re.fullmatch(r" *// (.*)", line)
        comment = [*comment, said[1]] if said else []
    return found


def points(unit: str) -> list[Named]:
    found = [named for module in modules(unit) for named in read(module, read_text(units.cover(module)))]
    if not found:
        raise Failure(f"{units.COVER}: has no file of a module of {unit}")
    return found


def bound(module: str, text: str) -> str:
    """The line behind a module's source that puts its points, whose source this is, into every instance."""
    parameters = ", ".join(f".{name}({name})" for name in _PARAMETER.findall(text))
    return f"bind {module} {module}_cover {f'#({parameters}) ' if parameters else ''}cover_points (.*);\n"


def attach(unit: str, folder: Path) -> None:
    """A copy of the RTL with the unit's cover points in it."""
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(ROOT / "rtl", folder, ignore=shutil.ignore_patterns("generate"))
    for module in modules(unit):
        text = read_text(units.cover(module))
        source = folder / units.source(module).relative_to("rtl")
        source.with_name(f"{module}_cover.sv").write_text(_AHEAD + text)
        source.write_text(source.read_text() + bound(module, text))
