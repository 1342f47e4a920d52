# SPDX-License-Identifier: Apache-2.0
"""Kinds of numbers on a command line, for argparse: what they refuse ends a command with status 2 before it does anything."""
import argparse
import math
from collections.abc import Callable

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


def positive(text: str) -> float:
    """A number above zero, no infinity."""
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not 0 < number < math.inf:
        raise argparse.ArgumentTypeError(f"is {text}, expected a number above 0")
    return number
