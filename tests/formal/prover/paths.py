# SPDX-License-Identifier: Apache-2.0
"""Whether a combinational path leads from one port to another in a netlist of gates."""
import json
from pathlib import Path
from typing import Any

from flow.shell import Failure


def leads(netlist: Path, top: str, start: str, end: str) -> bool:
    module = json.loads(netlist.read_text())["modules"][top]
    goal = set(_bits(module, start, netlist))
    driver: dict[int, dict[str, Any]] = {}
    for cell in module["cells"].values():
        for port, bits in cell["connections"].items():
            if cell["port_directions"][port] == "output":
                driver.update((bit, cell) for bit in bits)
    seen: set[int] = set()
    ahead = _bits(module, end, netlist)
    while ahead:
        bit = ahead.pop()
        if bit in seen:
            continue
        seen.add(bit)
        if bit in goal:
            return True
        cell = driver.get(bit)
        if cell is None or _is_register(cell["type"]):
            continue
        for port, bits in cell["connections"].items():
            if cell["port_directions"][port] == "input":
                ahead += [bit for bit in bits if isinstance(bit, int)]
    return False


def _bits(module: dict[str, Any], wire: str, netlist: Path) -> list[int]:
    if wire not in module["netnames"]:
        raise Failure(f"{netlist}: paths: {wire}: no such wire")
    return [bit for bit in module["netnames"][wire]["bits"] if isinstance(bit, int)]


def _is_register(kind: str) -> bool:
    return "DFF" in kind or "DLATCH" in kind or kind in ("$anyinit", "$ff", "$_FF_")
