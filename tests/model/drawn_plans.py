# SPDX-License-Identifier: Apache-2.0
"""Random plans: every line that docs/plan.md, "Ranges", gives a unit is drawn over its whole range."""
from random import Random
from typing import Any

from numeric import clog2
from photon_map import shape_of
from plan import Plan


def low_often(random: Random, low: int, high: int) -> int:
    """A number of a range, of any number of bits alike, the ends of the range often."""
    if random.random() < 0.2:
        return random.choice((low, high))
    return min(high, low - 1 + random.randint(1, 1 << random.randint(0, (high - low + 1).bit_length())))


def compressed_fits(plan: Plan) -> bool:
    """Whether a compressed line's record has room for what it must hold (docs/photon_memory.md)."""
    shape = shape_of(plan)
    offsets = 6 + 2 * shape.first + shape.own
    return shape.own >= max(1, shape.left_out) and offsets - 2 + 2 * plan["photon.direction_bits"] >= shape.address + 1


def draw_plan(random: Random, base: Plan) -> Plan:
    """A plan with the lines of `base` where no unit reads them. What goes with what: docs/plan.md, "Ranges"."""
    plan = Plan(base)

    def line(name: str, value: Any) -> Any:
        plan[name] = value
        return value

    # Now and then every format is at one end of its range: flux is then wider than a JSON number, or nearly nothing.
    end = random.choice((*[None] * 8, 0, 1))

    def format_bits(low: int, high: int) -> int:
        return random.randint(low, high) if end is None else (low, high)[end]

    position_bits = line("photon.position_bits", format_bits(4, 24))
    direction_bits = line("photon.direction_bits", format_bits(2, 14))
    mantissa_bits = line("photon.mantissa_bits", format_bits(2, 16))
    exponent_bits = line("photon.exponent_bits", format_bits(1, 5))
    channels = line("photon.channels", random.choice((1, 3)))
    bucket = line("photon.bucket", random.choice((2, 4, 8, 16)))
    photon_bits = 3 * position_bits + 2 * direction_bits + channels * mantissa_bits + exponent_bits

    line("scene.extent", random.choice((1.0, random.uniform(0.01, 1000))))
    for section in ("global", "caustic"):
        present = line(f"{section}.present", random.random() < 0.9)
        line(f"{section}.photons", random.choice((1, bucket, bucket + 1, random.randint(1, 3000))) if present else 0)
        line(f"{section}.power_exponent", random.randint(-40, 0) if present else 0)
        reach = random.choice((0.0, random.uniform(0, 0.3), 2.0))
        line(f"{section}.radius", plan["scene.extent"] * reach)

    # Half the plans with compressed lines, from the shortest that they can have.
    line("photon.lines", "plain")
    line("photon.further_percent", low_often(random, 0, 1500))
    whole = [bytes_ for bytes_ in range(4, 33) if bucket * bytes_ % 16 == 0]
    stride = line("photon.photon_bytes", random.choice([bytes_ for bytes_ in whole if 8 * bytes_ >= photon_bits]))
    if random.random() < 0.5:
        line("photon.lines", "compressed")
        line("photon.further_percent", 1500)
        strides = [bytes_ for bytes_ in whole if compressed_fits(Plan({**plan, "photon.photon_bytes": bytes_}))]
        stride = line("photon.photon_bytes", random.choice(strides[:3]))

    k = line("gather.k", random.choice((1, 2, 8, 50, low_often(random, 1, 256))) if end is None else format_bits(1, 256))
    normal_bits = line("gather.normal_bits", random.randint(2, 14))
    line("gather.r2_floor", low_often(random, 1, (4 << 2 * position_bits) - 1))
    line("gather.epsilon_factor", 1)
    line("gather.epsilon_shift", 0)
    if random.random() < 0.6:
        shift = line("gather.epsilon_shift", random.randint(0, 15))
        line("gather.epsilon_factor", random.choice((1 << shift, random.randint(1 << shift, 65535))))
    line("gather.leaf_limit", random.choice((0, 0, low_often(random, 0, 65535))))
    line("gather.reciprocal_bits", random.choice((0, 18, random.randint(8, 24))))

    line("gatherer.lanes", 1 << random.randint(0, clog2(bucket)))
    nodes = line("gatherer.nodes_per_cycle", random.randint(1, 2))
    candidates = line("gatherer.candidates_per_cycle", random.choice((1, 2, 4)))
    line("gatherer.powers_per_cycle", random.choice([w for w in (1, 2, 4) if w <= candidates]))
    line("gatherer.contexts", random.randint(max(nodes, candidates), 64))
    ways = line("gatherer.cache_ways", random.randint(1, 8))
    line("gatherer.cache_bytes", ways * bucket * stride << random.randint(0, 5))
    line("gatherer.cache_misses", random.randint(1, 32))
    taken = 8 * bucket * stride  # a beat divides it
    if plan["photon.lines"] == "plain" and random.random() < 0.25:
        line("gatherer.cache_bytes", 0)
        taken = 8 * plan["gatherer.lanes"] * stride
    line("gatherer.beat_bits", random.choice([bits for bits in range(32, 4097, 8) if taken % bits == 0]))

    line("reorder.key", random.choice(("none", "hilbert", "hilbert", "hash", "hash")))
    line("reorder.drain", random.choice(("sweep", "fullest")))
    line("reorder.packets", low_often(random, 1, 2000))
    cell_bits = line("reorder.cell_bits", random.randint(1, min(7, position_bits)))
    line("reorder.bins", 1 << random.randint(0, 12 if plan["reorder.key"] == "hash" else min(12, 3 * cell_bits)))

    cells = line("sampler.cell_bits", random.randint(1, min(6, direction_bits)))
    probability_bits = line("sampler.probability_bits", random.randint(4, 24))
    line("sampler.u_bits", random.randint(max(16, probability_bits + 2 * cells + 8), 48))
    line("sampler.v_bits", random.randint(1, 12))
    line("sampler.combine", random.choice(("sum", "product", "weighted", "photons", "cosine")))
    line("sampler.levels", random.randint(1, cells + 1))
    power_bits = mantissa_bits + clog2(channels) + 2**exponent_bits - 1 + clog2(k)
    while True:
        levels = plan["sampler.levels"]
        if power_bits + 2 * (levels - 1) + clog2(levels) <= (56 if plan["sampler.combine"] == "weighted" else 64):
            break
        if levels > 1:
            line("sampler.levels", levels - 1)
        else:
            line("sampler.combine", "sum")
    line("sampler.cosine_samples", low_often(random, 1, 255))

    line("cache.present", True)
    line("cache.records", low_often(random, 1, 4096))
    line("cache.hits", random.randint(1, 8))
    line("cache.angle_bits", random.randint(0, min(31, 2 * normal_bits + 2)))
    line("cache.weight_bits", random.randint(4, 12))
    return plan
