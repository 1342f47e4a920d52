# SPDX-License-Identifier: Apache-2.0
"""The bounds of golden's arithmetic, as tests/extremes/suite/steps.bounds has them."""
import re
from dataclasses import dataclass
from pathlib import Path

from flow.shell import Failure

from .properties import Property


@dataclass(frozen=True)
class Bounds:
    lines: dict[str, str]  # word of the formulas -> line of the plan
    formulas: dict[str, str]  # step -> bound
    shown: dict[str, str]  # step -> properties, or why there is none

    def of(self, proved: Property) -> str:
        if proved.step not in self.formulas:
            raise Failure(f"property {proved.name}: step: there is no {proved.step!r} among the steps")
        return self.formulas[proved.step]


def read(file: Path) -> Bounds:
    bounds = Bounds({}, {}, {})
    try:
        text = file.read_text()
    except OSError as error:
        raise Failure(str(error)) from error
    for line in text.splitlines():
        if line.startswith("//") or not line:
            continue
        # As C reads them: no text has a quote inside.
        entry = re.fullmatch(r'(WORD|STEP)\((.*)\)', line)
        fields = re.findall(r'"([^"]*)"', entry[2]) if entry else []
        if entry and entry[1] == "WORD" and len(fields) == 2:
            bounds.lines[fields[0]] = fields[1]
        elif entry and entry[1] == "STEP" and len(fields) == 4:
            bounds.formulas[fields[0]] = fields[1]
            bounds.shown[fields[0]] = fields[3]
        else:
            raise Failure(f"{file}: '{line}': expected WORD of 2 texts or STEP of 4")
    return bounds


def check(bounds: Bounds, table: list[Property]) -> None:
    """Steps and properties name each other; a step without a property says why."""
    proved = {entry.name: entry.step for entry in table if entry.method == "gappa"}
    named: dict[str, str] = {}
    for step, shown in bounds.shown.items():
        names = re.findall(r"\bbound_\w+", shown)
        if bool(names) != shown.startswith("Gappa: ") or not (names or shown.startswith("not by machine: ")):
            raise Failure(f"step {step}: expected 'Gappa: NAME' or 'not by machine: WHY', found '{shown}'")
        named.update((name, step) for name in names)
    for name in sorted(set(proved) | set(named)):
        if proved.get(name) != named.get(name):
            raise Failure(f"property {name}: is of the step {proved.get(name)!r}, among the steps it is of {named.get(name)!r}")
