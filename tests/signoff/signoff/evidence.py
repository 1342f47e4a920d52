# SPDX-License-Identifier: Apache-2.0
"""What else speaks for a unit: properties proved of its modules, planted bugs that its bench catches."""
import re
from dataclasses import dataclass
from pathlib import Path

from flow.shell import ROOT, Failure, read_text

PROOFS = Path("docs/formal.md")
MUTANTS = Path("tests/mutants/rtl")


@dataclass(frozen=True)
class Proof:
    module: str
    says: str
    depth: str  # "unbounded", or cycles
    holds: bool


def proofs(modules: set[str]) -> list[Proof]:
    """The rows of these modules in the table that `scripts/formal --page` wrote."""
    found = []
    for line in read_text(ROOT / PROOFS).splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        module = re.fullmatch(r"`(\w+)`", cells[0])
        if module and len(cells) == 8 and module[1] in modules:
            found.append(Proof(module[1], cells[1], cells[4], cells[7].endswith("; bug refuted")))
    if not found:
        raise Failure(f"{PROOFS}: has no row of a module among {', '.join(sorted(modules))}")
    return found


def hand_mutants(unit: str) -> list[str]:
    """Patches of `make mutate` that this unit's bench must catch, or that are of the unit's own files."""
    found = []
    for patch in sorted((ROOT / MUTANTS).glob("*.patch")):
        text = patch.read_text()
        if re.search(rf"^bench: *{unit}$", text, re.MULTILINE) or f"+++ b/rtl/{unit}/" in text:
            found.append(patch.stem)
    return found
