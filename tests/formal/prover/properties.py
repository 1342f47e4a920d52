# SPDX-License-Identifier: Apache-2.0
"""The table of properties, tests/formal/properties.toml, as values."""
import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from flow.shell import Failure

# How a property is shown, and whether that holds without a bound:
#   pdr        property directed reachability, unbounded
#   induction  no run of depth + 1 cycles from reset breaks it, and none from any state after it was kept for depth cycles:
#              unbounded
#   exhaustive every run of a harness that ends within depth cycles and asserts that it does: all inputs at once, unbounded
#   bmc        every run of at most depth cycles
#   path       no combinational path between two ports, found in the netlist, unbounded
#   gappa      a bound of golden's arithmetic, tests/formal/bounds/HARNESS.g, at each width of ranges and for every input
UNBOUNDED = {"pdr": True, "induction": True, "exhaustive": True, "bmc": False, "path": True, "gappa": True}
NEEDS_DEPTH = {"induction", "exhaustive", "bmc"}


@dataclass(frozen=True)
class Property:
    name: str  # unique
    module: str  # whose property it is
    says: str  # one sentence
    harness: str  # tests/formal/harness/HARNESS.sv, whose top is HARNESS; of a path the module itself; of a bound bounds/HARNESS.g
    method: str
    depth: int  # cycles, 0 where the method needs none
    parameters: dict[str, int]  # of the harness
    probes: dict[str, str]  # wires of the harness that get the value of a wire inside, by its flattened name, or of a word of memory
    cuts: tuple[str, ...]  # wires inside, by flattened name, that take any value in each step: more runs, never fewer
    paths: tuple[tuple[str, str], ...]  # of a path: from input, to output
    bug: str  # tests/formal/bugs/BUG.patch or tests/mutants/rtl/BUG.patch, which must be refuted
    clocks: int  # of the harness; where there are several, a clock input is 1 in the steps that are its edges
    quick: bool  # also a test of a few seconds
    step: str = field(default="", repr=False)  # of a bound: whose it is, in tests/extremes/suite/steps.bounds
    ranges: tuple[tuple[str, int, int], ...] = field(default=(), repr=False)  # of a bound: word of its formula, least and greatest

    @property
    def unbounded(self) -> bool:
        return UNBOUNDED[self.method]


_KEYS = {"name", "module", "says", "harness", "method", "depth", "parameters", "probes", "cuts", "paths", "bug", "clocks", "quick", "step",
         "ranges"}


def _property(entry: dict[str, Any], where: str) -> Property:
    def text(key: str) -> str:
        value = entry.get(key)
        if not isinstance(value, str) or not value:
            raise Failure(f"{where}: {key}: expected a text, found {value!r}")
        return value

    unknown = sorted(set(entry) - _KEYS)
    if unknown:
        raise Failure(f"{where}: {unknown[0]}: no such key, expected one of {', '.join(sorted(_KEYS))}")
    method = text("method")
    if method not in UNBOUNDED:
        raise Failure(f"{where}: method: expected one of {', '.join(UNBOUNDED)}, found {method!r}")
    depth = entry.get("depth", 0)
    if not isinstance(depth, int) or (method in NEEDS_DEPTH) != (depth > 0):
        raise Failure(f"{where}: depth: expected cycles above 0 with {', '.join(sorted(NEEDS_DEPTH))} alone, found {depth!r}")
    parameters = entry.get("parameters", {})
    if not all(isinstance(value, int) for value in parameters.values()):
        raise Failure(f"{where}: parameters: expected whole numbers, found {parameters!r}")
    paths = tuple((str(a), str(b)) for a, b in entry.get("paths", []))
    if bool(paths) != (method == "path"):
        raise Failure(f"{where}: paths: expected pairs of input and output with the method path alone")
    step = entry.get("step", "")
    ranges = entry.get("ranges", {})
    if (bool(step), bool(ranges)) != (method == "gappa", method == "gappa" and bool(ranges)):
        raise Failure(f"{where}: step, ranges: expected with the method gappa alone")
    if not all(isinstance(ends, list) and len(ends) == 2 and ends[0] <= ends[1] for ends in ranges.values()):
        raise Failure(f"{where}: ranges: expected WORD = [LEAST, GREATEST], found {ranges!r}")
    return Property(text("name"), text("module"), text("says"), text("harness"), method, depth, parameters,
                    entry.get("probes", {}), tuple(entry.get("cuts", [])), paths, text("bug"), entry.get("clocks", 1), bool(entry.get("quick", False)), step,
                    tuple((word, least, greatest) for word, (least, greatest) in ranges.items()))


def load(file: Path) -> list[Property]:
    try:
        with file.open("rb") as stream:
            entries = tomllib.load(stream).get("property", [])
    except (OSError, tomllib.TOMLDecodeError) as error:
        raise Failure(f"{file}: {error}") from error
    properties = []
    names: set[str] = set()
    for number, entry in enumerate(entries, 1):
        made = _property(entry, f"{file}: property {entry.get('name', number)}")
        if made.name in names:
            raise Failure(f"{file}: property {made.name}: the name stands twice")
        names.add(made.name)
        properties.append(made)
    if not properties:
        raise Failure(f"{file}: expected entries [[property]], found none")
    return properties
