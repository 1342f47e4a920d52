# SPDX-License-Identifier: Apache-2.0
"""Kinds of numbers on a command line, for argparse: what they refuse ends a command with status 2 before it does anything; and names and folders."""
import argparse
import math
import os
from collections.abc import Callable, Collection, Sequence
from pathlib import Path

from flow.shell import Failure

# What nextpnr's --seed holds.
LAST_SEED = 2**31 - 1
CLOCKS = (1, 400)  # MHz, of photonloom generate --clock


def whole(least: int, most: int | None = None) -> Callable[[str], int]:
    """A whole number of that range."""
    def read(text: str) -> int:
        try:
            if least <= (number := int(text)) <= (number if most is None else most):
                return number
        except ValueError:
            pass
        raise argparse.ArgumentTypeError(f"is {text}, expected a whole number of at least {least}" +
                                         ("" if most is None else f" and at most {most}"))
    return read


def folder(text: str) -> Path:
    """Where results go; one that is there or will be made."""
    path = Path(text)
    there = next((step for step in (path, *path.parents) if os.path.exists(step)), Path())
    if not there.is_dir():
        raise argparse.ArgumentTypeError(f"{there} is a file, expected a folder")
    return path


def made_folder(path: Path) -> Path:
    """A folder of results, made where it is not there."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise Failure(f"{path}: cannot be made: {error.strerror}") from error
    return path


def check_names(p: argparse.ArgumentParser, names: Sequence[str], known: Collection[str], kind: str = "", option: str = "") -> None:
    """That there are these, and each is named once. kind: what they are; option: by which they are named."""
    where, what = f"{option}: " if option else "", f"{kind} " if kind else ""
    for name in names:
        if name not in known:
            p.error(f"{where}there is no {what}{name}, expected some of {', '.join(known)}")
    if twice := next((name for name in names if names.count(name) > 1), None):
        p.error(f"{where}{what}{twice} is named twice, expected each once")


def refuse_idle(p: argparse.ArgumentParser, o: argparse.Namespace, names: Collection[str], why: str, does: str = "route") -> None:
    """Refuses options, named by what they are kept as and None by default, where they would do nothing. why: what stands in their way;
    does: what it does not do, with them or without."""
    if given := next((name for name in names if not (getattr(o, name) is None or getattr(o, name) is False)), None):  # 0 is given
        p.error(f"--{given.replace('_', '-')} is of what is {does}d, and {why} {does}s nothing; expected none of " +
                ", ".join(f"--{name.replace('_', '-')}" for name in names))


def number_of(text: str) -> float:
    """NaN of what is no number."""
    try:
        return float(text)
    except ValueError:
        return math.nan


def megahertz(text: str) -> float:
    """A clock that a board's core can be asked for."""
    least, most = CLOCKS
    if not least <= (number := number_of(text)) <= most:
        raise argparse.ArgumentTypeError(f"is {text}, expected a number from {least} to {most}")
    return number


def positive(text: str) -> float:
    """A number above zero, no infinity."""
    number = number_of(text)
    if not 0 < number < math.inf:
        raise argparse.ArgumentTypeError(f"is {text}, expected a number above 0")
    return number
