# SPDX-License-Identifier: Apache-2.0
"""The method gappa: a bound of golden's arithmetic at each width. A bug is refuted where Gappa does not prove it and an input
is found that breaks the bound."""
import itertools
from dataclasses import replace
from pathlib import Path

from flow.shell import Failure

from . import commands, script, steps
from .outcome import Outcome
from .properties import Property
from .tools import Tools

_TRIES = 20000


def widths(proved: Property) -> list[dict[str, int]]:
    words = [word for word, _, _ in proved.ranges]
    return [dict(zip(words, point)) for point in itertools.product(*(range(least, greatest + 1) for _, least, greatest in proved.ranges))]


def at(known: dict[str, int]) -> str:
    return ", ".join(f"{word} = {value}" for word, value in known.items())


def filled(folder: Path, proved: Property, sources: list[Path], known: dict[str, int]) -> str:
    bounds, template = sources
    return script.fill((folder / template).read_text(), known, steps.read(folder / bounds).of(proved))


def _proves(tools: Tools, text: str, file: Path, log: Path, limit: float, planted: bool = False) -> tuple[bool, float]:
    file.write_text(text)
    done = commands.run([tools.gappa, "-Eprecision=128", str(file)], log, limit)
    # What Gappa warns of it takes for granted. A bug may make a hint of the sound script wrong: then nothing is proved.
    if planted and "Warning" in done.text:
        return False, done.seconds
    refused = [line for line in done.text.splitlines() if "Warning" in line or "syntax error" in line]
    if refused:
        raise Failure(f"{tools.gappa}: {file}: {refused[0]}")
    if done.ended and done.status == 0:
        return True, done.seconds
    if done.ended and "were not satisfied" not in done.text and "no contradiction was found" not in done.text:
        raise Failure(f"{tools.gappa}: neither proves nor disproves {file} (log: {log})")
    return False, done.seconds


def _breaks(text: str, tries: int, planted: bool = False) -> str:
    """An input that breaks the script's goals; a Failure where none satisfies its hypotheses, for then a proof says nothing."""
    read = script.read(text)
    if planted:
        read = replace(read, hints=[])
    tried = script.search(read, tries)
    if tried.inputs == 0:
        raise Failure(f"no input of {tries} satisfies the hypotheses")
    return script.shown(read, tried.breaks) if tried.breaks else ""


def prove(tools: Tools, folder: Path, proved: Property, sources: list[Path], work: Path, limit: float) -> Outcome:
    seconds = 0.0
    for known in widths(proved):
        text = filled(folder, proved, sources, known)
        holds, spent = _proves(tools, text, work / "script.g", work / "log", limit)
        seconds += spent
        broken = _breaks(text, _TRIES // 100)
        if broken and holds:
            raise Failure(f"{proved.name}: {at(known)}: Gappa proves what {broken} breaks")
        if broken:
            return Outcome("fails", None, seconds, f"{at(known)}: {broken}")
        if not holds:
            return Outcome("undecided", None, seconds, f"not proved at {at(known)}")
    return Outcome("holds", None, seconds)


def refute(tools: Tools, folder: Path, proved: Property, sources: list[Path], work: Path, limit: float) -> Outcome:
    seconds = 0.0
    for known in widths(proved):
        text = filled(folder, proved, sources, known)
        holds, spent = _proves(tools, text, work / "script.g", work / "log", limit, planted=True)
        seconds += spent
        if holds:
            continue
        broken = _breaks(text, _TRIES, planted=True)
        if broken:
            return Outcome("fails", None, seconds, f"{at(known)}: {broken}")
    return Outcome("undecided", None, seconds)
