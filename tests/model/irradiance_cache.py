# SPDX-License-Identifier: Apache-2.0
"""The unit irradiance_cache, after docs/irradiance_cache.md."""
from collections.abc import Iterable
from typing import Any

from plan import Plan

Packet = dict[str, Any]


def squared_distance(a: list[int], b: list[int]) -> int:
    return sum((p - q) ** 2 for p, q in zip(a, b, strict=True))


def weight_of(plan: Plan, record: Packet, point: Packet) -> int:
    """w of a record at a point, 0 where the record does not cover it (docs/irradiance_cache.md, "What it computes", Weight)."""
    weight_bits: int = plan["cache.weight_bits"]
    angle_bits: int = plan["cache.angle_bits"]
    width = weight_bits + 4
    mantissa: int = record["falloff"]
    exponent: int = record["falloff_exponent"]
    distance = squared_distance(record["position"], point["position"])
    turn = squared_distance(record["normal"], point["normal"])
    if distance >> exponent + 1 or turn >> angle_bits:
        return 0
    shift = width - 1 - exponent
    scaled = distance << shift if shift >= 0 else distance >> -shift
    far = scaled * mantissa >> 2 * width - 1 - weight_bits
    turned = (turn << weight_bits) >> angle_bits
    return max(0, (1 << weight_bits) - far - turned)


def run(plan: Plan, packets: Iterable[Packet]) -> list[Packet]:
    """One answer a lookup (docs/irradiance_cache.md, "What it computes", Answer; numbers that mean nothing are 0,
    docs/packets.md)."""
    hits, capacity = plan["cache.hits"], plan["cache.records"]
    records: list[Packet] = []
    answers = []
    for lookup in packets:
        if lookup["clear"]:
            records = []
        covering = []
        for number, record in enumerate(records):
            weight = weight_of(plan, record, lookup)
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
            records.append(lookup)
    return answers
