# SPDX-License-Identifier: Apache-2.0
"""Kinds of numbers on a command line, for argparse: what they refuse ends a command with status 2 before it does anything; and names and folders."""
import argparse
import math
from collections.abc import Callable, Collection, Sequence
from pathlib import Path

# What nextpnr's --seed holds.
LAST_SEED = 2**31 - 1


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
    if Path(text).exists() and not Path(text).is_dir():
        raise argparse.ArgumentTypeError(f"{text} is a file, expected a folder")
    return Path(text)


def check_names(p: argparse.ArgumentParser, names: Sequence[str], known: Collection[str], kind: str = "", option: str = "") -> None:
    """That there are these, and each is named once. kind: what they are; option: by which they are named."""
    where, what = f"{option}: " if option else "", f"{kind} " if kind else ""
    for name in names:
        if name not in known:
            p.error(f"{where}there is no {what}{name}, expected some of {', '.join(known)}")
    if twice := next((name for name in names if names.count(name) > 1), None):
        p.error(f"{where}{what}{twice} is named twice, expected each once")


def refuse_idle(p: argparse.ArgumentParser, o: argparse.Namespace, names: Collection[str], why: str) -> None:
    """Refuses options, named by what they are kept as and None by default, where they would do nothing. why: what stands in their way."""
    if given := next((name for name in names if not (getattr(o, name) is None or getattr(o, name) is False)), None):  # 0 is given
        p.error(f"--{given.replace('_', '-')} is of what is routed, and {why} routes nothing; expected none of " +
                ", ".join(f"--{name.replace('_', '-')}" for name in names))


def positive(text: str) -> float:
    """A number above zero, no infinity."""
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not 0 < number < math.inf:
        raise argparse.ArgumentTypeError(f"is {text}, expected a number above 0")
    return number
