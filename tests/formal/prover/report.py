# SPDX-License-Identifier: Apache-2.0
"""The table of results, for a terminal and for docs/formal.md."""
from dataclasses import dataclass
from pathlib import Path

from flow.shell import Failure

from .outcome import Outcome
from .properties import Property
from .steps import Bounds

BEGIN = "<!-- table: written by `scripts/formal --page` after `make formal` -->"
END = "<!-- end of the table -->"
MODULES_BEGIN = "<!-- modules: written with the table above -->"
MODULES_END = "<!-- end of the modules -->"


@dataclass(frozen=True)
class Result:
    proved: Property
    sound: Outcome  # of the sources as they are
    planted: Outcome | None  # of those with the bug; None where the first did not hold

    @property
    def passed(self) -> bool:
        return self.sound.verdict == "holds" and self.planted is not None and self.planted.verdict == "fails"

    @property
    def seconds(self) -> float:
        return self.sound.seconds + (self.planted.seconds if self.planted else 0.0)

    @property
    def depth(self) -> str:
        if self.proved.method == "gappa":
            return "each input"
        return "unbounded" if self.sound.depth is None and self.sound.verdict == "holds" else f"{self.sound.depth} cycles"

    @property
    def verdict(self) -> str:
        if self.sound.verdict == "fails":
            where = "" if self.proved.method == "gappa" else f" in cycle {self.sound.depth}"
            return f"FAILS{where}{': ' + self.sound.note if self.sound.note else ''}"
        if self.sound.verdict == "error":
            return f"NOT RUN: {self.sound.note}"
        if self.sound.verdict == "undecided":
            return f"UNDECIDED ({self.sound.note or 'bounded only'})"
        word = "proved" if self.proved.unbounded else "holds"
        if self.planted is None or self.planted.verdict != "fails":
            return f"{word}, but its planted bug is NOT REFUTED"
        return f"{word}; bug refuted"


def line(result: Result) -> str:
    return (f"{result.proved.name:<32} {result.proved.module:<24} {result.proved.method:<10} {result.depth:<10} "
            f"{result.seconds:7.1f} s  {result.verdict}")


def heading() -> str:
    return f"{'property':<32} {'module':<24} {'method':<10} {'depth':<10} {'':>4}time    verdict"


def _facts(proved: Property) -> list[str]:
    """What a row says of a property whatever came of it: module, words, at, method, planted bug."""
    at = ", ".join([*(f"{name} {value}" for name, value in proved.parameters.items()),
                    *(f"{word} {least} to {greatest}" for word, least, greatest in proved.ranges)])
    return [f"`{proved.module}`", proved.says, at, proved.method, f"`{proved.bug}`"]


def _row(result: Result) -> str:
    *what, bug = _facts(result.proved)
    return "| " + " | ".join([*what, result.depth, f"{max(1, round(result.seconds))} s", bug, result.verdict]) + " |"


def _table(page: Path) -> tuple[str, list[str], str]:
    """What stands before the table, its lines, and what stands behind it."""
    try:
        before, rest = page.read_text().split(BEGIN)
        table, after = rest.split(END)
    except (OSError, ValueError) as error:
        raise Failure(f"{page}: expected the lines {BEGIN} and {END}, once each") from error
    return before, table.strip().splitlines(), after


def check_page(page: Path, table: list[Property]) -> None:
    """That the page has a row of each property, and none of another."""
    rows = []
    for line in _table(page)[1][2:]:
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        rows.append([*cells[:4], cells[6]])
    for proved in table:
        if (found := rows.count(_facts(proved))) != 1:
            raise Failure(f"{page}: has {found} rows of {proved.name} as it is now, expected one; scripts/formal {proved.name} and then with --page writes it")
        rows.remove(_facts(proved))
    if rows:
        raise Failure(f"{page}: has a row of no property, expected none: {' | '.join(rows[0])}")


def write_page(page: Path, results: list[Result], table: list[Property], whole: bool = True) -> None:
    """Puts the table between its marks in the page; of some results their rows alone, in place of those of the same module and
    words, and without rows whose module and words are of no property of the table."""
    before, rows, after = _table(page)
    made = [_row(result) for result in sorted(results, key=lambda result: (result.proved.module, result.proved.name))]
    if whole:
        rows = ["| module | property | at | method | depth | time | planted bug | verdict |", "|---|---|---|---|---|---|---|---|", *made]
    else:
        for row in made:
            same = [place for place, old in enumerate(rows) if old.split("|")[1:3] == row.split("|")[1:3]]
            if len(same) > 1:
                raise Failure(f"{page}: has {len(same)} rows of {row.split('|')[1].strip()} with these words, expected one at most")
            if same:
                rows[same[0]] = row
            else:
                # Behind the rows of modules up to its own.
                rows.insert(max([2, *(place + 1 for place, old in enumerate(rows[2:], 2) if old.split("|")[1] <= row.split("|")[1])]), row)
        known = {tuple(_facts(proved)[:2]) for proved in table}
        rows = rows[:2] + [row for row in rows[2:] if tuple(cell.strip() for cell in row.split("|")[1:3]) in known]
    page.write_text(before + BEGIN + "\n" + "\n".join(rows) + "\n" + END + after)


STEPS_BEGIN = "<!-- proofs: written by `scripts/formal --page` after `make formal` -->"
STEPS_END = "<!-- end of proofs -->"


def write_steps(page: Path, bounds: Bounds, results: list[Result]) -> None:
    """How each bound of the page is shown: the verdicts of its properties, or why there is none."""
    try:
        before, rest = page.read_text().split(STEPS_BEGIN)
        _, after = rest.split(STEPS_END)
    except (OSError, ValueError) as error:
        raise Failure(f"{page}: expected the lines {STEPS_BEGIN} and {STEPS_END}, once each") from error
    rows = ["| step | bound | at | proof |", "|---|---|---|---|"]
    for step, formula in bounds.formulas.items():
        own = [result for result in results if result.proved.step == step]
        ranges = dict.fromkeys(f"every {word} from {least} to {greatest}" for result in own for word, least, greatest in result.proved.ranges)
        at = ", ".join(ranges) or ("every width" if own else "")
        proof = bounds.shown[step].removeprefix("Gappa: ")
        for result in own:
            proof = proof.replace(result.proved.name, f"`{result.proved.name}` ({result.verdict})")
        rows.append(f"| {step} | {formula} | {at} | {proof} |")
    page.write_text(before + STEPS_BEGIN + "\n" + "\n".join(rows) + "\n" + STEPS_END + after)


def write_modules(page: Path, rows: list[str]) -> None:
    """Puts the modules that words go through between their marks in the page."""
    try:
        before, rest = page.read_text().split(MODULES_BEGIN)
        _, after = rest.split(MODULES_END)
    except (OSError, ValueError) as error:
        raise Failure(f"{page}: expected the lines {MODULES_BEGIN} and {MODULES_END}, once each") from error
    page.write_text(before + MODULES_BEGIN + "\n" + "\n".join(rows) + "\n" + MODULES_END + after)
