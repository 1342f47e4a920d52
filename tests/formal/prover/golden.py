# SPDX-License-Identifier: Apache-2.0
"""The scripts of the bounds beside golden: on the inputs that tests/formal/bounds/values.cpp prints each gives golden's numbers,
and with its planted bug it does not."""
import re
import subprocess
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path

from flow.shell import Failure

from . import bounds, script, sources, steps
from .properties import Property

LEAST = 50  # inputs of a property


@dataclass(frozen=True)
class Line:
    known: tuple[tuple[str, int], ...]  # widths
    inputs: dict[str, Fraction]
    results: dict[str, Fraction]  # golden's, of definitions


def number(text: str) -> Fraction:
    """An integer, a double in hex, a/b, NbE = N * 2^E, a~b = a - b."""
    if "~" in text:
        a, b = text.split("~")
        return number(a) - number(b)
    if "/" in text:
        a, b = text.split("/")
        return number(a) / number(b)
    if match := re.fullmatch(r"(-?\d+)b(-?\d+)", text):
        return int(match[1]) * Fraction(2) ** int(match[2])
    return Fraction(float.fromhex(text)) if "x" in text else Fraction(int(text))


@dataclass(frozen=True)
class Printed:
    lines: dict[str, list[Line]]  # of each property
    ranges: dict[str, tuple[int, int]]  # of each line of the plan


def read(text: str) -> Printed:
    printed = Printed({}, {})

    def entries(part: str) -> list[tuple[str, str]]:
        return [(word, value) for word, _, value in (entry.partition("=") for entry in part.split())]

    for line in text.splitlines():
        fields = line.split("|")
        try:
            if fields[0] == "line":
                printed.ranges[fields[1]] = (int(fields[2]), int(fields[3]))
                continue
            name, known, inputs, results = fields
            printed.lines.setdefault(name, []).append(
                Line(tuple((word, int(value)) for word, value in entries(known)),
                     {word: number(value) for word, value in entries(inputs)}, {word: number(value) for word, value in entries(results)}))
        except (ValueError, IndexError) as error:
            raise Failure(f"golden's values: '{line}': {error}") from error
    return printed


def _difference(text: dict[tuple[tuple[str, int], ...], script.Script], lines: list[Line]) -> str:
    """Where a script and golden differ, or golden is outside of what the script assumes or shows."""
    for line in lines:
        run = text[line.known]
        where = f"{bounds.at(dict(line.known))}: {', '.join(f'{name} = {float(value):.6g}' for name, value in line.inputs.items())}"
        values = dict(line.inputs)
        for name, due in line.results.items():
            got = run.evaluate(run.definitions[name], values) if name in run.definitions else None
            if got != due:
                return f"{where}: {name} is {float(due):.17g} in golden, {'nothing' if got is None else format(float(got), '.17g')} in the script"
        held = script.attempt(run, values)
        if held is None:
            return f"{where}: golden is outside of the hypotheses"
        if not held:
            return f"{where}: golden breaks the bound"
    return ""


def check(root: Path, proved: Property, printed: Printed, copies: Path) -> int:
    """How many inputs of a property were compared."""
    lines = printed.lines.get(proved.name, [])
    if len(lines) < LEAST:
        raise Failure(f"property {proved.name}: {len(lines)} values of golden, expected at least {LEAST}")
    seen = {line.known for line in lines}
    missing = [known for known in bounds.widths(proved) if tuple(known.items()) not in seen]
    if missing:
        raise Failure(f"property {proved.name}: no value of golden at {bounds.at(missing[0])}")
    files = sources.of(root, proved)
    # normal_bits have the range of direction_bits.
    plan = steps.read(root / sources.BOUNDS).lines
    for word, least, greatest in proved.ranges:
        if word not in plan or printed.ranges.get(plan[word]) != (least, greatest):
            raise Failure(f"property {proved.name}: {word} goes from {least} to {greatest}, in a plan {plan.get(word)} from "
                          f"{' to '.join(map(str, printed.ranges.get(plan.get(word, ''), ())))}")

    def scripts(folder: Path, hints: bool) -> dict[tuple[tuple[str, int], ...], script.Script]:
        made = {known: script.read(bounds.filled(folder, proved, files, dict(known))) for known in seen}
        return made if hints else {known: replace(one, hints=[]) for known, one in made.items()}

    different = _difference(scripts(root, True), lines)
    if different:
        raise Failure(f"property {proved.name}: {different}")
    sources.plant(root, proved, files, copies)
    if not _difference(scripts(copies, False), lines):
        raise Failure(f"property {proved.name}: golden's values do not tell the script from one with the bug {proved.bug}")
    return len(lines)


def values(program: Path) -> Printed:
    try:
        done = subprocess.run([str(program)], stdout=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True, check=False)
    except OSError as error:
        raise Failure(f"{program}: {error}") from error
    if done.returncode != 0:
        raise Failure(f"{program}: ended with status {done.returncode}")
    return read(done.stdout)
