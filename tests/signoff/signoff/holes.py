# SPDX-License-Identifier: Apache-2.0
"""Holes of a unit's coverage, each with the reason that tests/signoff/holes/UNIT.toml gives; one without a reason is a fault, and
so is a reason without a hole."""
import re
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from flow.shell import ROOT, Failure, read_text, read_toml

from . import units
from .coverage import KINDS, Point


@dataclass(frozen=True)
class Reason:
    """Why some points of a module are not reached."""
    module: str
    kind: str
    of: tuple[str, ...]  # signals or patterns of them; of lines and arms the source line, or a pattern of it; of cover points names
    low: int  # of a toggle the bits that it is of
    high: int
    why: str

    def explains(self, point: Point) -> bool:
        if (self.module, self.kind) != (point.module, point.kind):
            return False
        if point.kind != "toggle":
            return any(fnmatchcase(text_of(point), pattern) for pattern in self.of)
        name, bit = signal_of(point)
        return self.low <= bit <= self.high and any(fnmatchcase(name, literal(pattern)) for pattern in self.of)


@dataclass
class Explained:
    reason: Reason
    points: list[Point] = field(default_factory=list)


def literal(pattern: str) -> str:
    """An index in brackets means itself; * and ? are patterns."""
    return pattern.replace("[", "[[]")


def signal_of(point: Point) -> tuple[str, int]:
    """A bit's signal and its place; a signal of one bit has place 0."""
    indexed = re.fullmatch(r"(.*)\[(\d+)\]", point.what)
    return (indexed[1], int(indexed[2])) if indexed else (point.what, 0)


def text_of(point: Point) -> str:
    """The source line of a line or an arm, an arm's with its name in front; of a cover point its name."""
    if point.kind == "user":
        return point.what
    text = read_text(ROOT / units.source(point.module)).splitlines()[point.line - 1].strip()
    return f"{point.what}: {text}" if point.kind == "branch" else text


_KEYS = {"module", "kind", "of", "bits", "why"}


def _reason(entry: dict[str, Any], where: str) -> Reason:
    unknown = sorted(set(entry) - _KEYS)
    if unknown:
        raise Failure(f"{where}: {unknown[0]}: no such key, expected one of {', '.join(sorted(_KEYS))}")
    for key in ("module", "kind", "why"):
        if not isinstance(entry.get(key), str) or not entry[key]:
            raise Failure(f"{where}: {key}: expected a text, found {entry.get(key)!r}")
    if entry["kind"] not in KINDS:
        raise Failure(f"{where}: kind: expected one of {', '.join(KINDS)}, found {entry['kind']!r}")
    of = entry.get("of")
    if not isinstance(of, list) or not of or not all(isinstance(name, str) for name in of):
        raise Failure(f"{where}: of: expected a list of texts, found {of!r}")
    bits = re.fullmatch(r"(\d+)(?:-(\d+))?", str(entry.get("bits", "0-99999")))
    if not bits or ("bits" in entry and entry["kind"] != "toggle"):
        raise Failure(f"{where}: bits: expected FIRST-LAST, of a toggle alone, found {entry['bits']!r}")
    return Reason(entry["module"], entry["kind"], tuple(of), int(bits[1]), int(bits[2] or bits[1]), entry["why"])


def reasons(unit: str) -> list[Reason]:
    file = Path("tests/signoff/holes") / f"{unit}.toml"
    if not (ROOT / file).is_file():
        return []
    entries = read_toml(ROOT / file).get("hole", [])
    return [_reason(entry, f"{file}, hole {number}") for number, entry in enumerate(entries, 1)]


def explain(holes: list[Point], given: list[Reason]) -> tuple[list[Explained], list[Point]]:
    """Each reason with the holes that it is the first to explain, and the holes that none explains."""
    explained = [Explained(reason) for reason in given]
    bare = []
    for point in holes:
        taker = next((entry for entry in explained if entry.reason.explains(point)), None)
        if taker:
            taker.points.append(point)
        else:
            bare.append(point)
    return explained, bare


def ranges(numbers: list[int]) -> str:
    """[1, 2, 3, 7] as "1-3, 7"."""
    runs: list[list[int]] = []
    for number in sorted(set(numbers)):
        if runs and runs[-1][1] == number - 1:
            runs[-1][1] = number
        else:
            runs.append([number, number])
    return ", ".join(str(first) if first == last else f"{first}-{last}" for first, last in runs)


def grouped(points: list[Point]) -> list[str]:
    """Where points are, a phrase for each signal, for each arm, for all lines of a module."""
    groups: dict[tuple[str, str], list[int]] = {}
    for point in points:
        if point.kind == "toggle":
            name, bit = signal_of(point)
            groups.setdefault((point.module, name), []).append(bit)
        else:
            groups.setdefault((point.module, point.what), []).append(point.line)
    whole = {point.what for point in points}  # a signal of one bit has no index
    phrases = []
    for (_, name), numbers in groups.items():
        if points[0].kind == "toggle":
            phrases.append(f"`{name}`" if name in whole else f"`{name}` {ranges(numbers)}")
        else:
            phrases.append(f"{name + ' of ' if name else ''}line {ranges(numbers)}")
    return phrases
