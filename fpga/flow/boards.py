# SPDX-License-Identifier: Apache-2.0
"""The boards of fpga/boards, and the families of their parts."""
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field as member
from pathlib import Path

from flow.shell import ROOT, Failure, UsageError, field, read_toml

BOARDS = ROOT / "fpga" / "boards"


class UnknownBoard(UsageError):
    """There is no folder of that name."""


@dataclass(frozen=True)
class Family:
    """What is the same for all parts of a family.

    cells: our name of a resource -> the cells that are one; a name that ends in * stands for all that begin so.
    equivalents: what a part has of a resource -> the name under which cells that share it are counted together, and how many
    of it each of them takes; a resource that is not there is counted as it is.
    lut: the resource that is a LUT. tools: variable of a package's Makefile -> the program. fetched: `make fpga-tools` gets
    them. estimated: clocks are the tool's estimate, of a family whose delays it has not been shown to know: no package has
    met or missed its clock, and there is no bitstream. placer: the placer of nextpnr that its Makefile takes if not told,
    None where that has no choice of one.
    """
    cells: Mapping[str, Sequence[str]]
    tools: Mapping[str, str]
    equivalents: Mapping[str, tuple[str, Mapping[str, int]]] = member(default_factory=dict)
    lut: str = "LUT4"
    fetched: bool = False
    estimated: bool = False
    placer: str | None = None

    @property
    def nextpnr(self) -> str:
        return self.tools["NEXTPNR"]


LUT_EQ = "LUT-eq"
FAMILIES = {
    # A carry cell takes two LUTs of a slice, a 16 x 4 memory four.
    "ecp5": Family({"LUT4": ["LUT4"], "FF": ["TRELLIS_FF"], "CCU2C": ["CCU2C"], "DPR16X4": ["TRELLIS_DPR16X4"],
                    "DP16KD": ["DP16KD"], "MULT18X18D": ["MULT18X18D"]},
                   {"YOSYS": "yosys", "NEXTPNR": "nextpnr-ecp5", "ECPPACK": "ecppack"},
                   {"LUT4": (LUT_EQ, {"LUT4": 1, "CCU2C": 2, "DPR16X4": 4})}, fetched=True, placer="heap"),
    "ice40": Family({"LUT4": ["SB_LUT4"], "FF": ["SB_DFF*"], "SB_RAM40_4K": ["SB_RAM40_4K"], "SB_MAC16": ["SB_MAC16"]},
                    {"YOSYS": "yosys", "NEXTPNR": "nextpnr-ice40", "ICEPACK": "icepack"}),
    # A slice of four LUTs is one 32 x 6 or 64 x 3 memory, or two of 32 x 1 or 64 x 1; carries stand beside the LUTs.
    "xc7": Family({"LUT6": ["LUT*", "INV"], "FF": ["FD*"], "CARRY4": ["CARRY4"], "SRL": ["SRL*"],
                   "RAM64M": ["RAM32M", "RAM64M", "RAM128X1D"], "RAM64X1D": ["RAM32X1D", "RAM64X1D"],
                   "RAMB36E1": ["RAMB36E1"], "RAMB18E1": ["RAMB18E1"], "DSP48E1": ["DSP48E1"]},
                  {"YOSYS": "yosys", "NEXTPNR": "nextpnr-himbaechel-xilinx"},
                  {"LUT6": (LUT_EQ, {"LUT6": 1, "SRL": 1, "RAM64M": 4, "RAM64X1D": 2}),
                   "RAMB18E1": ("RAMB18-eq", {"RAMB18E1": 1, "RAMB36E1": 2})},
                  lut="LUT6", fetched=True, estimated=True, placer="static"),
}


@dataclass(frozen=True)
class Board:
    """name: of its folder. resources: how many of a resource the part has. plan, units: what is measured by default, all
    units of the plan and the board's top where `units` is empty."""
    name: str
    family: Family
    resources: Mapping[str, int]
    plan: Path
    units: Sequence[str]

    def top(self, unit: str | None = None) -> str:
        """The module that is the whole part: around a unit, or the board's own."""
        prefix = self.name.replace("-", "_")
        return f"{prefix}_{unit}_top" if unit else f"{prefix}_top"


def family_of(path: Path) -> str:
    """The family that a board.toml names."""
    known = ", ".join(FAMILIES)
    name = str(field(read_toml(path), path, "part.family", str, f"one of {known}"))
    if name not in FAMILIES:
        raise Failure(f"{path}: part.family is {name}, expected one of {known}")
    return name


def board_names(folder: Path = BOARDS) -> list[str]:
    """The boards that there are."""
    return [path.parent.name for path in sorted(folder.glob("*/board.toml"))]


def read_board(name: str, folder: Path = BOARDS) -> Board:
    """A board by its name."""
    # A name, not a way to a folder elsewhere.
    if name not in board_names(folder):
        raise UnknownBoard(f"there is no board {name}, expected one of {', '.join(board_names(folder))}")
    path = folder / name / "board.toml"
    family, said = FAMILIES[family_of(path)], read_toml(path)
    resources = field(said, path, "part.resources", dict, "a table")
    for resource, number in resources.items():
        if resource not in family.cells:
            raise Failure(f"{path}: part.resources.{resource} is unknown, expected some of {', '.join(family.cells)}")
        if type(number) is not int or number < 1:
            raise Failure(f"{path}: part.resources.{resource} is {number!r}, expected a count")
    if family.lut not in resources:
        raise Failure(f"{path}: part.resources.{family.lut} is missing, expected a count")
    plan = field(said, path, "measure.plan", str, "a plan below the repository's root")
    units = field(said, path, "measure.units", list, "a list of units") if "units" in said["measure"] else []
    return Board(name, family, resources, ROOT / plan, units)
