# SPDX-License-Identifier: Apache-2.0
"""Synthesis of a package by Yosys, and how many of which resource it takes."""
from collections.abc import Mapping
from pathlib import Path
from typing import TypedDict

from flow.boards import Board, Family
from flow.shell import Failure, beside, read_json, run
from flow.tools import Tools

Counts = dict[str, int]


class Binding(TypedDict):
    """The resource of which a part has the least left."""
    resource: str
    used: int
    of: int


def counts_of(stat_file: Path, family: Family, module: str) -> Counts:
    """Resources of a module in the JSON of Yosys' stat, and what the family counts together."""
    modules = read_json(stat_file)["modules"]
    if "\\" + module not in modules:
        raise Failure(f"{stat_file}: has no module {module}, only {', '.join(modules)}")
    cells: dict[str, int] = modules["\\" + module]["num_cells_by_type"]
    counts = {name: sum(n for cell, n in cells.items() if any(is_cell(cell, pattern) for pattern in patterns))
              for name, patterns in family.cells.items()}
    return counts | {together: sum(each * counts[name] for name, each in parts.items())
                     for together, parts in family.equivalents.values()}


def is_cell(cell: str, pattern: str) -> bool:
    """Whether a cell has the name, or the beginning of one before a *."""
    return cell.startswith(pattern[:-1]) if pattern.endswith("*") else cell == pattern


def binding(counts: Mapping[str, int], board: Board) -> Binding:
    """The fullest resource of the part; what the family counts together is counted so."""
    shares = []
    for name, capacity in board.resources.items():
        counted = board.family.equivalents[name][0] if name in board.family.equivalents else name
        shares.append((counts[counted] / capacity, counted, counts[counted], capacity))
    _, name, used, of = max(shares)
    return {"resource": name, "used": used, "of": of}


def synthesise(folder: Path, board: Board, top: str, module: str, tools: Tools) -> Counts:
    """Counts of `module` in the package's top; its netlist is left in the package's build folder."""
    run(["make", "-C", str(folder), "synth"] + tools.variables, log=beside(folder, ".synthesis.log"))
    return counts_of(folder / "build" / f"{top}.stat.json", board.family, module)
