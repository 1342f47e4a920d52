# SPDX-License-Identifier: Apache-2.0
"""Queries a second that a board's serial link carries, from the packets and the clock divider of its package."""
import re
from dataclasses import dataclass
from pathlib import Path

from flow.shell import Failure, read_text

# Bytes of frames beside their words, docs/host-link.md: two ENDs, id, command and CRC; then a PUSH's position, its answer's
# position and room, a PULL's position, number and keep, its answer's position and end. 64 words a frame; stuffing doubles 2 of
# 256 byte values.
FRAME, PUSH, PUSHED, PULL, PULLED, WORDS, STUFFED = 8, 4, 8, 9, 8, 64, 1 + 2 / 256


@dataclass(frozen=True)
class Link:
    """rate: queries a second. down, up: bytes a query, to the board and back."""
    rate: float
    baud: float
    down: float
    up: float


def constant_of(path: Path, name: str, pattern: str) -> int:
    """A whole number that a generated source gives a name."""
    found = re.search(pattern, read_text(path))
    if not found:
        raise Failure(f"{path.name}: has no {name}")
    return int(found.group(1))


def packet_words(package: Path, name: str) -> int:
    """Words of a packet: its width in the generated package."""
    camel = "".join(part.capitalize() for part in name.split("_")) + "PacketBits"
    return -(-constant_of(package, camel, rf" {camel} = (\d+);") // 32)


def link_of(where: Path, constraint_khz: float) -> Link:
    """The link of a package whose core runs at its constraint."""
    package, top = where / "rtl" / "photonloom_pkg.sv", where / "rtl" / "board_pkg.sv"
    baud = 1000 * constraint_khz / constant_of(top, "ClocksPerBit", r" ClocksPerBit = (\d+);")
    query, record = packet_words(package, "gather_query"), 1 + packet_words(package, "gather_result")
    down = (query * (4 + (FRAME + PUSH) / WORDS) + record * (FRAME + PULL) / WORDS) * STUFFED
    up = (record * (4 + (FRAME + PULLED) / WORDS) + query * (FRAME + PUSHED) / WORDS) * STUFFED
    return Link(baud / 10 / max(down, up), baud, down, up)
