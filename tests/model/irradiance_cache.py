# SPDX-License-Identifier: Apache-2.0
"""The unit irradiance_cache, after docs/irradiance_cache.md."""
from collections.abc import Iterable
from typing import Any, NamedTuple

from plan import Plan

Packet = dict[str, Any]


class Record(NamedTuple):
    """A point that others share: position, normal, and the reciprocal of its squared reach, m and e."""
    position: list[int]
    normal: list[int]
    mantissa: int
    exponent: int


def weight_of(weight_bits: int, angle_bits: int, record: Record, position: list[int], normal: list[int]) -> int:
    """w of a record at a point, 0 where the record does not cover it (docs/irradiance_cache.md, "What it computes", Weight)."""
    (ax, ay, az), (bx, by, bz) = record.position, position
    distance = (ax - bx) * (ax - bx) + (ay - by) * (ay - by) + (az - bz) * (az - bz)
    if distance >> record.exponent + 1:
        return 0
    (ax, ay, az), (bx, by, bz) = record.normal, normal
    turn = (ax - bx) * (ax - bx) + (ay - by) * (ay - by) + (az - bz) * (az - bz)
    if turn >> angle_bits:
        return 0
    width = weight_bits + 4
    shift = width - 1 - record.exponent
    scaled = distance << shift if shift >= 0 else distance >> -shift
    far = scaled * record.mantissa >> 2 * width - 1 - weight_bits
    turned = (turn << weight_bits) >> angle_bits
    return max(0, (1 << weight_bits) - far - turned)


def run(plan: Plan, packets: Iterable[Packet]) -> list[Packet]:
    """One answer a lookup (docs/irradiance_cache.md, "What it computes", Answer; numbers that mean nothing are 0,
    docs/packets.md)."""
    hits, capacity = plan["cache.hits"], plan["cache.records"]
    weight_bits, angle_bits = plan["cache.weight_bits"], plan["cache.angle_bits"]
    records: list[Record] = []
    answers = []
    for lookup in packets:
        if lookup["clear"]:
            records = []
        position, normal = lookup["position"], lookup["normal"]
        covering = []
        for number, record in enumerate(records):
            weight = weight_of(weight_bits, angle_bits, record, position, normal)
            if weight > 0:
                covering.append((-weight, number))
        heaviest = sorted(covering)[:hits]
        wanted = lookup["insert"] == 1 and not heaviest
        inserted = wanted and len(records) < capacity
        behind = [0] * (hits - len(heaviest))
        answers.append({
            "pixel": lookup["pixel"], "sample": lookup["sample"], "count": len(heaviest),
            "record": [number for _, number in heaviest] + behind,
            "weight": [-negated for negated, _ in heaviest] + behind,
            "inserted": int(inserted), "full": int(wanted and not inserted),
            "number": len(records) if inserted else 0,
        })
        if inserted:
            records.append(Record(position, normal, lookup["falloff"], lookup["falloff_exponent"]))
    return answers
