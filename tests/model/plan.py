# SPDX-License-Identifier: Apache-2.0
"""A plan as its file gives it, and what follows from its lines, after docs/plan.md."""
import tomllib
from math import floor
from pathlib import Path
from typing import Any


class Plan(dict[str, Any]):
    """Lines of a plan by `section.key`."""


def read_plan(path: Path) -> Plan:
    """Every line of a plan file (docs/plan.md)."""
    sections = tomllib.loads(path.read_text(encoding="utf-8"))
    return Plan({f"{section}.{key}": value for section, lines in sections.items() for key, value in lines.items()})


def r2_max(plan: Plan, section: str) -> int:
    """r2_max of the map `global` or `caustic` (docs/plan.md, "What follows from what")."""
    position_bits: int = plan["photon.position_bits"]
    largest = (4 << 2 * position_bits) - 1
    if plan[f"{section}.radius"] == 0:
        return largest
    unit: float = plan["scene.extent"] / (1 << position_bits)
    radius: float = plan[f"{section}.radius"]
    return min(largest, floor((radius / unit)**2))
