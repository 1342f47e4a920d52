# SPDX-License-Identifier: Apache-2.0
"""What a method of proof found."""
from dataclasses import dataclass


@dataclass(frozen=True)
class Outcome:
    verdict: str  # holds, fails, undecided, error
    depth: int | None  # cycles looked at; None without a bound
    seconds: float  # of the processor
    note: str = ""
