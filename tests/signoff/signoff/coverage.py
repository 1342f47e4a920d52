# SPDX-License-Identifier: Apache-2.0
"""What the simulator counted, as points of the source: lines, branches, bits that toggle, points that a user put there.

A point is one of a module's source, whatever the parameters: it is covered where it was reached in some instance of some plan. A bit
is covered where one instance saw it change twice in one run, so that it rose and fell."""
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from flow.shell import Failure, read_text

KINDS = ("line", "branch", "toggle", "user")


@dataclass(frozen=True, order=True)
class Point:
    module: str  # whose source file has the name
    kind: str
    line: int
    what: str = ""  # of a branch the arm, of a toggle the bit, of a user's point its name


@dataclass
class Coverage:
    counts: dict[Point, int] = field(default_factory=dict)  # the most of all instances, plans and runs

    def add(self, point: Point, count: int) -> None:
        self.counts[point] = max(count, self.counts.get(point, 0))

    def of(self, kind: str) -> list[Point]:
        return sorted(point for point in self.counts if point.kind == kind)

    def covered(self, point: Point) -> bool:
        return self.counts[point] >= (2 if point.kind == "toggle" else 1)

    def holes(self, kind: str) -> list[Point]:
        return [point for point in self.of(kind) if not self.covered(point)]


_FIELD = re.compile(r"\x01([^\x02]*)\x02([^\x01']*)")
_ENTRY = re.compile(r"C '(.*)' (\d+)$")
# A word of a memory, whose data is watched at its ports.
_STORED = re.compile(r"\[\d+\]\[\d+\]$")


def _lines(text: str) -> Iterator[int]:
    """The numbers of "3,5-7"."""
    for part in text.split(","):
        first, _, last = part.partition("-")
        yield from range(int(first), int(last or first) + 1)


@dataclass(frozen=True)
class Without:
    """What is no point: words of modules that are memories, lines that elaboration alone runs."""
    memories: frozenset[str] = frozenset()
    elaborated: frozenset[tuple[str, int]] = frozenset()  # module and line


def points(keys: dict[str, str], without: Without) -> Iterator[Point]:
    """The points that one counter is of: an arm's counter is also that of its lines."""
    kind = keys["page"].split("/")[0]
    module, line, what = Path(keys["f"]).stem, int(keys["l"]), keys.get("o", "")
    if kind == "v_toggle":
        if not (module in without.memories and _STORED.search(what)):
            yield Point(module, "toggle", line, what)
        return
    if kind == "v_user":
        yield Point(module, "user", line, what)
        return
    if kind not in ("v_line", "v_branch"):
        raise Failure(f"a counter of a kind that is not known: {keys['page']}")
    for number in _lines(keys["S"]) if "S" in keys else ():
        if (module, number) not in without.elaborated:
            yield Point(module, "line", number)
    # An item of a case is an arm, counted as a line's.
    if (kind == "v_branch" or what == "case") and (module, line) not in without.elaborated:
        yield Point(module, "branch", line, what)


# Wider signals are bundles of others, which are watched where they are made.
WIDEST = 256
_BIT = re.compile(r"(.*)\[(\d+)\]")


def _without_bundles(found: Coverage) -> Coverage:
    widths: dict[tuple[str, str], int] = {}
    for point in found.counts:
        bit = _BIT.fullmatch(point.what) if point.kind == "toggle" else None
        if bit:
            widths[point.module, bit[1]] = max(int(bit[2]) + 1, widths.get((point.module, bit[1]), 0))
    kept = {}
    for point, count in found.counts.items():
        bit = _BIT.fullmatch(point.what) if point.kind == "toggle" else None
        if not bit or widths[point.module, bit[1]] <= WIDEST:
            kept[point] = count
    return Coverage(kept)


def read(files: Iterable[Path], without: Without = Without()) -> Coverage:
    """All files of a run."""
    found = Coverage()
    known: dict[str, list[Point]] = {}
    for file in files:
        for number, text in enumerate(read_text(file).splitlines(), 1):
            if text.startswith("#"):
                continue
            entry = _ENTRY.match(text)
            if not entry:
                raise Failure(f"{file}, line {number}: is no counter of the simulator's")
            # The instance, last in a counter's name, makes no difference to the point.
            name = re.sub(r"\x01h\x02[^\x01]*", "", entry[1])
            if name not in known:
                known[name] = list(points(dict(_FIELD.findall(name)), without))
            for point in known[name]:
                found.add(point, int(entry[2]))
    return _without_bundles(found)
