# SPDX-License-Identifier: Apache-2.0
"""A photon map: its lines and its tree, after docs/photon_map.md, and its image in hardware, after docs/photon_gatherer.md."""
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from numeric import oct_decode
from plan import Plan

Packet = dict[str, Any]


@dataclass(frozen=True)
class Photon:
    """A photon in its slot. facing: o(direction)."""
    index: int
    position: tuple[int, int, int]
    mantissa: tuple[int, ...]
    exponent: int
    direction: tuple[int, int]
    facing: tuple[int, int, int]


@dataclass(frozen=True)
class PhotonMap:
    """lines: the photons of each. nodes: (axis, split) of nodes 1 ... L - 1, number 0 means nothing. addresses: of the
    photons, in the order of the input."""
    lines: list[list[Photon]]
    nodes: list[tuple[int, int]]
    addresses: list[int]


def build(plan: Plan, photons: list[Packet]) -> PhotonMap:
    """docs/photon_map.md, "Layout"."""
    bucket: int = plan["photon.bucket"]
    direction_bits: int = plan["photon.direction_bits"]
    line_count = -(-len(photons) // bucket)
    sizes = [min(bucket, len(photons) - bucket * line) for line in range(line_count)]
    nodes = [(0, 0)] * max(1, line_count)
    members: list[list[int]] = [[] for _ in range(line_count)]

    def room(node: int) -> int:
        """Photons below a node."""
        if node >= line_count:
            return sizes[node - line_count]
        return room(2 * node) + room(2 * node + 1)

    def order(number: int, axis: int) -> tuple[Any, ...]:
        photon = photons[number]
        position = photon["position"]
        return (position[axis], position[(axis + 1) % 3], position[(axis + 2) % 3], photon["direction"], photon["mantissa"],
                photon["exponent"], number)

    def fill(node: int, numbers: list[int]) -> None:
        if node >= line_count:
            members[node - line_count] = sorted(numbers)
            return
        lower, upper = ([choose(photons[n]["position"][axis] for n in numbers) for axis in range(3)] for choose in (min, max))
        edges = [high - low for low, high in zip(lower, upper)]
        axis = edges.index(max(edges))
        numbers = sorted(numbers, key=lambda number: order(number, axis))
        left = room(2 * node)
        nodes[node] = (axis, photons[numbers[left]]["position"][axis])
        fill(2 * node, numbers[:left])
        fill(2 * node + 1, numbers[left:])

    if photons:
        fill(1, list(range(len(photons))))
    addresses = [0] * len(photons)
    lines: list[list[Photon]] = []
    for line, numbers in enumerate(members):
        lines.append([])
        for slot, number in enumerate(numbers):
            photon = photons[number]
            u, v = photon["direction"]
            addresses[number] = line * bucket + slot
            x, y, z = photon["position"]
            lines[line].append(Photon(line * bucket + slot, (x, y, z), tuple(photon["mantissa"]), photon["exponent"], (u, v),
                                      oct_decode(u, v, direction_bits)))
    return PhotonMap(lines, nodes, addresses)


def line_bytes(plan: Plan, line: Iterable[Photon]) -> bytes:
    """A line of memory (docs/photon_gatherer.md, "Ports beside the streams")."""
    position_bits, direction_bits = plan["photon.position_bits"], plan["photon.direction_bits"]
    mantissa_bits, exponent_bits = plan["photon.mantissa_bits"], plan["photon.exponent_bits"]
    stride = plan["photon.photon_bytes"]

    def slot_bytes(fields: list[tuple[int, int]]) -> bytes:
        word = at = 0
        for value, bits in fields:
            word |= value << at
            at += bits
        return word.to_bytes(stride, "little")

    slots = [slot_bytes([*((p, position_bits) for p in photon.position), *((d, direction_bits) for d in photon.direction),
                         *((m, mantissa_bits) for m in photon.mantissa), (photon.exponent, exponent_bits)]) for photon in line]
    unused = slot_bytes([*[(0, position_bits)] * 3, *[(0, direction_bits)] * 2,
                         *[(0, mantissa_bits)] * plan["photon.channels"], ((1 << exponent_bits) - 1, exponent_bits)])
    return b"".join(slots + [unused] * (plan["photon.bucket"] - len(slots)))


def read_line(plan: Plan, data: bytes) -> list[Packet]:
    """The photons of a line of memory, as packets `map_photon`; unused slots are left out."""
    stride, exponent_bits = plan["photon.photon_bytes"], plan["photon.exponent_bits"]
    photons = []
    word = 0

    def field(bits: int) -> int:
        nonlocal word
        value = word & (1 << bits) - 1
        word >>= bits
        return value

    for start in range(0, len(data), stride):
        word = int.from_bytes(data[start:start + stride], "little")
        photon: Packet = {"position": [field(plan["photon.position_bits"]) for _ in range(3)],
                          "direction": [field(plan["photon.direction_bits"]) for _ in range(2)],
                          "mantissa": [field(plan["photon.mantissa_bits"]) for _ in range(plan["photon.channels"])],
                          "exponent": field(exponent_bits)}
        if any(photon["mantissa"]) or photon["exponent"] < (1 << exponent_bits) - 1:
            photons.append(photon)
    return photons


def configuration(plan: Plan, maps: list[PhotonMap], r2_max: list[int]) -> dict[int, int]:
    """Datum by address of the gatherer's configuration (docs/photon_gatherer.md, "Ports beside the streams")."""
    written = {}
    first = 0
    for number, (photons, radius) in enumerate(zip(maps, r2_max)):
        for node, (axis, split) in enumerate(photons.nodes[1:], 1):
            written[first + node] = axis << plan["photon.position_bits"] | split
        written[0x800000 + 2 * number] = len(photons.lines)
        written[0x800001 + 2 * number] = radius
        first = -(-plan["global.photons"] // plan["photon.bucket"])
    return written
