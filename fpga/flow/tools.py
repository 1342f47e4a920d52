# SPDX-License-Identifier: Apache-2.0
"""Where the tools are and which version they say they are."""
import os
import re
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from flow.boards import Board
from flow.shell import ROOT, Failure, first_line

FETCHED = ROOT / "build" / "fpga-tools" / "bin"


@dataclass(frozen=True)
class Tools:
    """variables: how a package's Makefile is told of them. versions: program -> what it calls itself."""
    variables: list[str]
    versions: dict[str, str]


def version_said(name: str, path: str) -> str:
    """What a program calls itself; icepack does not say."""
    said = first_line([path, "-V" if name in ("yosys", "nextpnr-ice40") else "--version"])
    return said if said and name != "icepack" else "as the distribution has it"


def find_tools(board: Board) -> Tools:
    """What the board's flow runs: the tools of make fpga-tools, else those of PATH."""
    variables, versions = [], {}
    for variable, name in board.family.tools.items():
        ours = str(FETCHED / name)
        path = ours if board.family.fetched and os.access(ours, os.X_OK) else shutil.which(name)
        if not path:
            raise Failure(f"{name} is not there; run 'make fpga-tools BOARD={board.name}'" if board.family.fetched else
                          f"{name} is not on PATH; install Debian's package of it")
        variables.append(f"{variable}={path}")
        versions[name] = version_said(name, path)
    return Tools(variables, versions)


def require_same(kept: Mapping[str, str], tools: Tools, path: Path, all_again: str) -> None:
    """Fails where rows that stay in a data file were made by other tools than these, for it names one version of each."""
    for name, version in kept.items():
        if tools.versions.get(name) != version:
            raise Failure(f"{path}: its rows were made by {version}, but {name} is {tools.versions.get(name, 'not used')}; {all_again} makes all "
                          "of them again")


def yosys_version(said: str | None) -> str | None:
    """'0.23' of 'Yosys 0.23 (git sha1 ...)'; None of anything else."""
    found = re.match(r"Yosys (\d+\.\d+)", said or "")
    return found.group(1) if found else None


def nextpnr_version(said: str) -> str | None:
    """'0.11.1' of '... (Version 0.11.1+dfsg-5+b1)'; None of anything else."""
    found = re.search(r"Version \D*([\d.]+\d)", said)
    return found.group(1) if found else None


def nextpnr_is_slow(said: str) -> bool:
    """Whether this nextpnr is 0.7 or older, whose router takes twice as long on wide tops."""
    version = nextpnr_version(said)
    return version is not None and [int(part) for part in version.split(".")][:2] <= [0, 7]
