# SPDX-License-Identifier: Apache-2.0
"""The program photonloom: plans checked, units asked, packets read and written (docs/packets.md)."""
import json
import re
import shlex
import subprocess
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from drawing import Widths
from plan import Plan

Packet = dict[str, Any]
WIDEST_NUMBER = 53  # bits of an integer that JSON writes as a number
# Arrays whose length is a line of the plan: of one element they are arrays still (docs/packets.md, "As text").
ARRAYS = {("gather_result", "flux"), ("gather_photon", "mantissa"), ("sampler_input", "mantissa"), ("map_photon", "mantissa"),
          ("cache_result", "record"), ("cache_result", "weight")}


class Failure(Exception):
    """Why a run cannot go on."""


class Program:
    """A photonloom."""

    def __init__(self, path: str) -> None:
        self.path = path

    def command(self, *arguments: str | Path) -> list[str]:
        return [self.path, *map(str, arguments)]

    def run(self, *arguments: str | Path) -> str:
        """What it prints; a command that fails is a failure."""
        command = self.command(*arguments)
        try:
            done = subprocess.run(command, capture_output=True, text=True)
        except OSError as error:
            raise Failure(f"{self.path}: {error.strerror}, expected the program (make build, or --photonloom)") from None
        if done.returncode:
            raise Failure(f"{shlex.join(command)}\n  exit status {done.returncode}: {done.stderr.strip()}")
        return done.stdout

    def widths(self, plan: Path) -> Widths:
        """Fields of all packets of a plan, from its tables; refuses a plan that cannot be built."""
        widths = Widths({}, {})
        packet = ""
        for line in self.run("packets", "--plan", plan).splitlines():
            if heading := re.match(r"`(\w+)`, \d+ bits", line):
                packet = heading[1]
                widths.bits[packet] = {}
            elif field := re.match(r"\| `(\w+)` \| (?:(\d+) x )?(\d+) \|", line):
                widths.bits[packet][field[1]] = int(field[3])
                if field[2] or (packet, field[1]) in ARRAYS:
                    widths.elements[packet, field[1]] = int(field[2] or 1)
        return widths


def write_packets(path: Path, packets: Iterable[Packet]) -> None:
    """docs/packets.md, "As text"."""
    path.write_text("".join(json.dumps(packet) + "\n" for packet in packets), encoding="utf-8")


def read_packets(path: Path, bits: dict[str, int]) -> list[Packet]:
    """docs/packets.md, "As text": decimal strings where, and only where, a field is wider than 53 bits."""
    packets: list[Packet] = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        packet: Packet = {}
        for name, value in json.loads(line).items():
            written = str if bits.get(name, 0) > WIDEST_NUMBER else int
            elements = value if isinstance(value, list) else [value]
            if any(type(element) is not written for element in elements):
                raise Failure(f"{path}:{number}: {name} is {value!r}, expected {written.__name__} for {bits.get(name)} bits")
            packet[name] = [int(element) for element in elements] if isinstance(value, list) else int(value)
        packets.append(packet)
    return packets


def write_plan(path: Path, plan: Plan) -> None:
    """A plan file with every line, without comments (docs/plan.md)."""
    lines: list[str] = []
    section = ""
    for name, value in plan.items():
        before, key = name.split(".")
        if before != section:
            lines.append(f"[{before}]")
            section = before
        lines.append(f"{key} = {json.dumps(value)}")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
