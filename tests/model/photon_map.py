# SPDX-License-Identifier: Apache-2.0
"""A photon map: its lines and its tree, after docs/photon_map.md, and its image in hardware, after docs/photon_gatherer.md
and docs/photon_memory.md."""
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from numeric import clog2, oct_decode
from plan import Plan

Packet = dict[str, Any]
Fields = Sequence[tuple[int, int]]


def joined(fields: Fields) -> int:
    """Values and their bits one after the other, the first lowest; of a value as many bits as it is given."""
    word = at = 0
    for value, bits in fields:
        word |= (value & (1 << bits) - 1) << at
        at += bits
    return word


class Word:
    """Fields taken from a number, the lowest first."""

    def __init__(self, word: int) -> None:
        self.word = word

    def take(self, bits: int) -> int:
        value = self.word & (1 << bits) - 1
        self.word >>= bits
        return value


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


def memory(plan: Plan, photons: PhotonMap, number: int) -> list[bytes]:
    """The lines of map `number` in memory: those of its leaves, then further ones (docs/photon_memory.md)."""
    if plan["photon.lines"] == "plain":
        return [plain_line(plan, line) for line in photons.lines]
    return compressed_lines(plan, photons, number)


def leaves(plan: Plan, lines: list[bytes], count: int) -> list[list[Packet]]:
    """The photons of `count` leaves in memory, as packets `map_photon`; unused slots are left out."""
    if plan["photon.lines"] == "plain":
        return [read_plain_line(plan, line) for line in lines[:count]]
    return [read_compressed_leaf(plan, lines, leaf) for leaf in range(count)]


def memory_lines(plan: Plan, section: str) -> int:
    """Lines that a map has room for."""
    count: int = -(-plan[f"{section}.photons"] // plan["photon.bucket"])
    percent: int = plan["photon.further_percent"] if plan["photon.lines"] == "compressed" else 0
    return count + -(-count * percent // 100)


def plain_line(plan: Plan, line: Iterable[Photon]) -> bytes:
    """A line of memory (docs/photon_gatherer.md, "Ports beside the streams")."""
    position_bits, direction_bits = plan["photon.position_bits"], plan["photon.direction_bits"]
    mantissa_bits, exponent_bits = plan["photon.mantissa_bits"], plan["photon.exponent_bits"]
    stride = plan["photon.photon_bytes"]

    def slot_bytes(fields: Fields) -> bytes:
        return joined(fields).to_bytes(stride, "little")

    slots = [slot_bytes([*((p, position_bits) for p in photon.position), *((d, direction_bits) for d in photon.direction),
                         *((m, mantissa_bits) for m in photon.mantissa), (photon.exponent, exponent_bits)]) for photon in line]
    unused = slot_bytes([*[(0, position_bits)] * 3, *[(0, direction_bits)] * 2,
                         *[(0, mantissa_bits)] * plan["photon.channels"], ((1 << exponent_bits) - 1, exponent_bits)])
    return b"".join(slots + [unused] * (plan["photon.bucket"] - len(slots)))


def read_plain_line(plan: Plan, data: bytes) -> list[Packet]:
    """The photons of a plain line."""
    stride, exponent_bits = plan["photon.photon_bytes"], plan["photon.exponent_bits"]
    photons = []
    for start in range(0, len(data), stride):
        field = Word(int.from_bytes(data[start:start + stride], "little")).take
        photon: Packet = {"position": [field(plan["photon.position_bits"]) for _ in range(3)],
                          "direction": [field(plan["photon.direction_bits"]) for _ in range(2)],
                          "mantissa": [field(plan["photon.mantissa_bits"]) for _ in range(plan["photon.channels"])],
                          "exponent": field(exponent_bits)}
        if any(photon["mantissa"]) or photon["exponent"] < (1 << exponent_bits) - 1:
            photons.append(photon)
    return photons


@dataclass(frozen=True)
class Shape:
    """Widths of compressed lines (docs/photon_memory.md, "Compressed lines")."""
    corner: int
    left_out: int  # of each coordinate, by the corner
    part: int      # of the header, in a slot
    record: int
    first: int     # B
    own: int       # A
    address: int


def shape_of(plan: Plan) -> Shape:
    corner = min(plan["photon.position_bits"], 10)
    part = -(-(5 + plan["photon.exponent_bits"] + 3 * corner) // plan["photon.bucket"])
    record = 8 * plan["photon.photon_bytes"] - part
    offsets = record - 2 * plan["photon.direction_bits"] - plan["photon.channels"] * plan["photon.mantissa_bits"]
    least = (offsets - 1) // 3
    lines = max(memory_lines(plan, "global"), memory_lines(plan, "caustic"))
    return Shape(corner, plan["photon.position_bits"] - corner, part, record, least, offsets - 6 - 2 * least, max(1, clog2(lines)))


def others(axis: int) -> tuple[int, int]:
    """The two axes beside a line's own."""
    first, second = (a for a in range(3) if a != min(axis, 2))
    return first, second


def shared_places(shape: Shape, split: int, axis: int) -> list[tuple[str, int]]:
    """What s0 ... s3 are: bits of which field."""
    a, b = shape.own, shape.first
    if axis == 3:
        return [("own", a), ("own", a + 1), ("own", a + 2), (("own", a + 3), ("first", b), ("second", b), ("own", a + 3))[split]]
    return [[("own", a), ("own", a + 1), ("own", a + 2), ("exponent", 2)],
            [("own", a), ("first", b), ("second", b), ("exponent", 2)],
            [("exponent", 3), ("first", b), ("second", b), ("exponent", 2)],
            [("first", b + 1), ("first", b), ("second", b), ("second", b + 1)]][split]


def widths(shape: Shape, split: int, axis: int) -> dict[str, int]:
    """Bits of each field in a layout."""
    fields = [field for field, _ in shared_places(shape, split, axis)]
    least = {"own": shape.own, "first": shape.first, "second": shape.first, "exponent": 2}
    return {field: bits + fields.count(field) for field, bits in least.items()}


@dataclass(frozen=True)
class Header:
    split: int
    axis: int
    exponent: int
    corner: tuple[int, ...]  # position units


def fitting(plan: Plan, photons: list[Photon]) -> Header | None:
    """The header of the first layout in which these photons fit."""
    shape = shape_of(plan)
    low = [min(p.position[c] for p in photons) >> shape.left_out << shape.left_out for c in range(3)]
    needed = [(max(p.position[c] for p in photons) - low[c]).bit_length() for c in range(3)]
    least = min(p.exponent for p in photons)
    if any(not any(p.mantissa) and (p.exponent - least) % 4 == 3 for p in photons):
        return None
    span = (max(p.exponent for p in photons) - least).bit_length()
    for split in range(4):
        for axis in range(4):
            room = widths(shape, split, axis)
            first, second = others(axis)
            if (span <= room["exponent"] and needed[min(axis, 2)] <= room["own"] and needed[first] <= room["first"]
                    and needed[second] <= room["second"]):
                return Header(split, axis, least, tuple(low))
    return None


def record_of(plan: Plan, header: Header, photon: Photon) -> int:
    """A photon's record."""
    shape = shape_of(plan)
    offset = [p - c for p, c in zip(photon.position, header.corner)]
    first, second = others(header.axis)
    value = {"own": offset[min(header.axis, 2)], "first": offset[first], "second": offset[second],
             "exponent": photon.exponent - header.exponent}
    shared = [(value[field] >> bit & 1, 1) for field, bit in shared_places(shape, header.split, header.axis)]
    return joined([(value["first"], shape.first), (value["second"], shape.first), (value["own"], shape.own), *shared,
                   *((d, plan["photon.direction_bits"]) for d in photon.direction), (value["exponent"], 2),
                   *((m, plan["photon.mantissa_bits"]) for m in photon.mantissa)])


def compressed_line(plan: Plan, header: Header, photons: list[Photon], following: int | None) -> bytes:
    """A line with these photons in their slots; `following`: the address of the leaf's next line."""
    shape, bucket = shape_of(plan), plan["photon.bucket"]
    unused = 3 << 2 * shape.first + shape.own + 4 + 2 * plan["photon.direction_bits"]
    records = [unused] * bucket
    if following is not None:
        records[-1] |= following
    for photon in photons:
        records[photon.index % bucket] = record_of(plan, header, photon)
    fields = Word(joined([(header.split, 2), (header.axis, 2), (int(following is not None), 1),
                          (header.exponent, plan["photon.exponent_bits"]),
                          *((c >> shape.left_out, shape.corner) for c in header.corner)]))
    return b"".join((record | fields.take(shape.part) << shape.record).to_bytes(plan["photon.photon_bytes"], "little")
                    for record in records)


def compressed_lines(plan: Plan, photons: PhotonMap, number: int) -> list[bytes]:
    """docs/photon_memory.md, "Compressed lines"."""
    bucket, address_bits = plan["photon.bucket"], shape_of(plan).address
    lines = [b""] * len(photons.lines)
    for leaf, left in enumerate(photons.lines):
        place = leaf
        while (header := fitting(plan, left)) is None:
            count = 1
            while fitting(plan, left[:count + 1]) is not None:
                count += 1
            header = fitting(plan, left[:count])
            assert header is not None  # one photon alone fits
            lines[place] = compressed_line(plan, header, left[:count], len(lines) | number << address_bits)
            place = len(lines)
            lines.append(b"")
            left = left[count:]
        lines[place] = compressed_line(plan, header, left, None)
    return lines


def read_compressed_leaf(plan: Plan, lines: list[bytes], leaf: int) -> list[Packet]:
    """The photons of a leaf, in the order of their slots."""
    shape, stride, bucket = shape_of(plan), plan["photon.photon_bytes"], plan["photon.bucket"]
    found: dict[int, Packet] = {}
    line: int | None = leaf
    while line is not None:
        slots = [int.from_bytes(lines[line][at:at + stride], "little") for at in range(0, bucket * stride, stride)]
        header = Word(joined([(slot >> shape.record, shape.part) for slot in slots]))
        split, axis, more = header.take(2), header.take(2), header.take(1)
        least = header.take(plan["photon.exponent_bits"])
        corner = [header.take(shape.corner) << shape.left_out for _ in range(3)]
        for number, slot in enumerate(slots):
            word = Word(slot)
            value = {"first": word.take(shape.first), "second": word.take(shape.first), "own": word.take(shape.own)}
            shared = [word.take(1) for _ in range(4)]
            direction = [word.take(plan["photon.direction_bits"]) for _ in range(2)]
            value["exponent"] = word.take(2)
            mantissa = [word.take(plan["photon.mantissa_bits"]) for _ in range(plan["photon.channels"])]
            if value["exponent"] == 3 and not any(mantissa):
                continue
            for (field, bit), given in zip(shared_places(shape, split, axis), shared):
                value[field] |= given << bit
            position = list(corner)
            for field, a in zip(("own", "first", "second"), (min(axis, 2), *others(axis))):
                position[a] += value[field]
            found[number] = {"position": position, "direction": direction, "mantissa": mantissa,
                             "exponent": least + value["exponent"]}
        line = slots[-1] & (1 << shape.address) - 1 if more else None
    return [found[slot] for slot in sorted(found)]


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
