# SPDX-License-Identifier: Apache-2.0
"""Random photons and packets of a plan: every value is legal by docs/packets.md, extremes and ties are frequent."""
from collections.abc import Callable
from dataclasses import dataclass
from random import Random
from typing import Any

from numeric import reciprocal
from plan import Plan

Packet = dict[str, Any]
Point = list[int]


@dataclass(frozen=True)
class Widths:
    """Bits of each field, by packet and field in the order of the packet (`photonloom packets --plan`). elements: of the fields
    that are arrays."""
    bits: dict[str, dict[str, int]]
    elements: dict[tuple[str, str], int]

    def draw(self, random: Random, packet: str, field: str) -> int:
        return random.getrandbits(self.bits[packet][field])


def clamp(value: int, bits: int) -> int:
    return max(0, min((1 << bits) - 1, value))


def points(random: Random, bits: int) -> Callable[[], Point]:
    """A source of positions of one kind: even, clustered, on a line, on a coarse grid, few different, in corners, on a plane."""
    edge = (1 << bits) - 1

    def even() -> Point:
        return [random.randint(0, edge) for _ in range(3)]

    kind = random.randrange(7)
    if kind == 1:
        centres, spread = [even() for _ in range(random.randint(1, 5))], max(1, edge >> random.randint(2, bits))
        return lambda: [clamp(c + round(random.gauss(0, spread)), bits) for c in random.choice(centres)]
    if kind == 2:
        start, step = even(), [random.randint(-8, 8) for _ in range(3)]
        return lambda: [clamp(s + d * t, bits) for t in [random.randint(-edge // 8, edge // 8)] for s, d in zip(start, step)]
    if kind == 3:
        shift = max(0, bits - random.randint(1, 3))
        return lambda: [p >> shift << shift for p in even()]
    if kind == 4:
        few = [even() for _ in range(random.randint(1, 4))]
        return lambda: list(random.choice(few))
    if kind == 5:
        return lambda: [random.choice((0, edge)) for _ in range(3)]
    if kind == 6:
        axis, level = random.randrange(3), random.randint(0, edge)
        return lambda: [level if i == axis else p for i, p in enumerate(even())]
    return even


def near(random: Random, bits: int, point: Point) -> Point:
    """The point itself or one not far from it."""
    reach = 1 << random.randint(0, bits)
    return [clamp(p + random.randint(-reach, reach), bits) for p in point] if random.random() < 0.8 else list(point)


def directions(random: Random, bits: int) -> Callable[[], list[int]]:
    """A source of octahedral codes: even, or not far from one."""
    centre, reach = [random.getrandbits(bits) for _ in range(2)], 1 << random.randint(0, bits)
    if random.random() < 0.5:
        return lambda: [random.getrandbits(bits) for _ in range(2)]
    return lambda: [clamp(c + random.randint(-reach, reach), bits) for c in centre]


def powers(random: Random, plan: Plan) -> Callable[[], Packet]:
    """A source of mantissas and exponents: any, all at the largest, small ones, many without power. Never the code of an
    unused slot, mantissas 0 with the largest exponent (docs/photon_map.md)."""
    mantissa_bits, exponent_bits, channels = (plan[f"photon.{n}"] for n in ("mantissa_bits", "exponent_bits", "channels"))
    kind = random.randrange(4)

    def draw() -> Packet:
        top = (1 << mantissa_bits) - 1
        if kind == 1:
            return {"mantissa": [top] * channels, "exponent": (1 << exponent_bits) - 1}
        if kind == 2:
            return {"mantissa": [random.randint(0, top) for _ in range(channels)], "exponent": 0}
        dark = kind == 3 and random.random() < 0.5
        mantissa = [0 if dark else random.randint(0, top) for _ in range(channels)]
        exponent = random.getrandbits(exponent_bits)
        if not any(mantissa) and exponent == (1 << exponent_bits) - 1:
            exponent = 0
        # A format without exponent has no code for a photon without power.
        return {"mantissa": mantissa if exponent_bits or any(mantissa) else [1] * channels, "exponent": exponent}

    return draw


def map_photons(random: Random, plan: Plan, most: int) -> list[Packet]:
    """Photons of a map, as `photonloom replay --photons` reads them; often few or none."""
    count = random.choice((0, 1, plan["photon.bucket"], most, most, most, most, random.randint(0, most)))
    position = points(random, plan["photon.position_bits"])
    direction = directions(random, plan["photon.direction_bits"])
    power = powers(random, plan)
    return [{"position": position(), **power(), "direction": direction()} for _ in range(min(count, most))]


def gather_queries(random: Random, plan: Plan, widths: Widths, count: int, photons: list[list[Packet]]) -> list[Packet]:
    """Queries at, near and far from photons of the maps; flushes among them."""
    bits = plan["photon.position_bits"]
    elsewhere, normal = points(random, bits), directions(random, plan["gather.normal_bits"])
    flushes = random.choice((0.0, 0.01, 0.2))
    wanted = random.choice((0.0, 0.2, 1.0, 1.0))
    caustic = random.choice((0.0, 0.02, random.random()))
    packets = []
    for _ in range(count):
        which = int(random.random() < caustic)
        some = photons[which]
        position = near(random, bits, random.choice(some)["position"]) if some and random.random() < 0.7 else elsewhere()
        packets.append({
            **{name: widths.draw(random, "gather_query", name) for name in ("pixel", "sample", "tag")},
            "map": which, "flush": int(random.random() < flushes), "want_photons": int(random.random() < wanted),
            "position": position, "normal": normal(),
        })
    return packets


def sampler_inputs(random: Random, plan: Plan, widths: Widths, count: int) -> list[Packet]:
    """Tables with their photons and `count` requests, at least; what docs/packets.md, "As text", refuses is left out."""
    def packet(kind: int, **fields: Any) -> Packet:
        return {"kind": kind, "pixel": 0, "sample": 0, "tag": 0, "normal": [0, 0], "mantissa": [0] * plan["photon.channels"],
                "exponent": 0, "direction": [0, 0], "u": 0, "v": [0, 0]} | fields

    k, u_bits, v_bits = plan["gather.k"], plan["sampler.u_bits"], plan["sampler.v_bits"]
    packets = []

    def photon(direction: Callable[[], list[int]], power: Callable[[], Packet]) -> None:
        packets.append(packet(1, **power(), direction=direction()))

    def request() -> None:
        u = random.choice((0, (1 << u_bits) - 1, *[random.getrandbits(u_bits)] * 6))
        packets.append(packet(2, tag=widths.draw(random, "sampler_input", "tag"), u=u,
                              v=[random.getrandbits(v_bits) for _ in range(2)]))

    requests = 0
    while requests < count:
        packets.append(packet(0, pixel=widths.draw(random, "sampler_input", "pixel"),
                              sample=widths.draw(random, "sampler_input", "sample"),
                              normal=[random.getrandbits(plan["gather.normal_bits"]) for _ in range(2)]))
        direction, power = directions(random, plan["photon.direction_bits"]), powers(random, plan)
        for _ in range(random.choice((0, 1, k, k, random.randint(0, k)))):
            photon(direction, power)
        wanted = random.choice((0, 1, random.randint(1, 64), 64))
        for _ in range(wanted):
            request()
        requests += wanted
    return packets


def cache_lookups(random: Random, plan: Plan, widths: Widths, count: int) -> list[Packet]:
    """Lookups of several tiles, points and normals far apart and close together."""
    bits, weight_bits = plan["photon.position_bits"], plan["cache.weight_bits"]
    normal_bits = plan["gather.normal_bits"]
    packets: list[Packet] = []
    while len(packets) < count:
        position, reach = points(random, bits), random.randint(1, 2 << random.randint(0, bits))
        centre, tilt = [random.getrandbits(normal_bits) for _ in range(3)], 1 << random.randint(0, normal_bits)
        insert = random.choice((0.0, 0.5, 0.9, 1.0, 1.0))
        for number in range(random.randint(1, 4 * plan["cache.records"])):
            squared = max(1, round((reach * random.uniform(0.2, 1))**2))
            falloff = reciprocal(squared, weight_bits + 4)
            place = random.choice(packets)["position"] if packets and random.random() < 0.5 else position()
            packets.append({
                "pixel": widths.draw(random, "cache_lookup", "pixel"), "sample": widths.draw(random, "cache_lookup", "sample"),
                "clear": int(number == 0), "insert": int(random.random() < insert),
                "position": near(random, bits, place),
                "normal": [clamp(c + random.randint(-tilt, tilt), normal_bits) for c in centre],
                "falloff": falloff.mantissa, "falloff_exponent": falloff.exponent,
            })
    return packets[:count]
