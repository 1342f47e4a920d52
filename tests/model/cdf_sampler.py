# SPDX-License-Identifier: Apache-2.0
"""The unit cdf_sampler, after docs/cdf_sampler.md."""
from bisect import bisect_right
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from itertools import accumulate
from typing import Any

from numeric import oct_decode, unfold
from plan import Plan

Packet = dict[str, Any]
Vector = tuple[int, int, int]
HEADER, PHOTON, REQUEST = 0, 1, 2


def dot(a: Vector, b: Vector) -> int:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@dataclass(frozen=True)
class Cell:
    """A cell of directions: its centre, its four corners, and J (docs/cdf_sampler.md, Cells and Cosine)."""
    centre: Vector
    corners: tuple[Vector, ...]
    jacobian: int


@cache
def cells_of(cell_bits: int) -> list[Cell]:
    """All cells in the order of their numbers, row * M + column (docs/cdf_sampler.md, Cells, Cosine, Weights)."""
    size = 1 << cell_bits
    cells = []
    for row in range(size):
        for column in range(size):
            centre = oct_decode(column, row, cell_bits)
            corners = tuple(unfold(x, y, size) for x in (2 * column - size, 2 * column + 2 - size)
                            for y in (2 * row - size, 2 * row + 2 - size))
            cells.append(Cell(centre, corners, 28 * 16**cell_bits // dot(centre, centre)**2))
    return cells


def powers(plan: Plan, photons: list[Packet]) -> list[int]:
    """P of each cell (docs/cdf_sampler.md, Photons)."""
    cell_bits = plan["sampler.cell_bits"]
    below = plan["photon.direction_bits"] - cell_bits
    power = [0] * 4**cell_bits
    for photon in photons:
        column, row = (coordinate >> below for coordinate in photon["direction"])
        power[row << cell_bits | column] += sum(photon["mantissa"]) << photon["exponent"]
    return power


def spread(plan: Plan, power: list[int]) -> list[int]:
    """Q of each cell (docs/cdf_sampler.md, Levels)."""
    cell_bits: int = plan["sampler.cell_bits"]
    levels: int = plan["sampler.levels"]
    size = 1 << cell_bits
    result = [0] * len(power)
    for level in range(levels):
        def block(cell: int) -> int:
            return (cell >> cell_bits >> level) * size + ((cell & size - 1) >> level)
        sums: dict[int, int] = {}
        for cell, value in enumerate(power):
            sums[block(cell)] = sums.get(block(cell), 0) + value
        for cell in range(len(power)):
            result[cell] += 4**(levels - 1 - level) * sums[block(cell)]
    return result


def table_weights(plan: Plan, normal_code: list[int], photons: list[Packet]) -> list[int]:
    """w of each cell for a normal and the photons of a table (docs/cdf_sampler.md, Cosine and Weights)."""
    cells = cells_of(plan["sampler.cell_bits"])
    normal = oct_decode(normal_code[0], normal_code[1], plan["gather.normal_bits"])
    cosine = [max(0, dot(cell.centre, normal)) * cell.jacobian for cell in cells]
    cosine_total = sum(cosine)
    power = powers(plan, photons)
    power_total = sum(power)
    density = spread(plan, power)
    levels = plan["sampler.levels"]
    scale = levels * 4**(levels - 1)
    scaled_total = scale * max(power_total, 1)
    bits = scaled_total.bit_length()

    combine = plan["sampler.combine"]
    if combine == "sum":
        exact = [q * cosine_total + b * scaled_total for q, b in zip(density, cosine)]
        bound = bits + cosine_total.bit_length() + 1
    elif combine == "product":
        exact = [(q if power_total else scale) * b for q, b in zip(density, cosine)]
        bound = bits + plan["sampler.cell_bits"] + plan["gather.normal_bits"] + 8
    elif combine == "weighted":
        count, cosine_count = len(photons), plan["sampler.cosine_samples"]
        exact = [count * q * cosine_total + cosine_count * b * scaled_total for q, b in zip(density, cosine)]
        bound = bits + cosine_total.bit_length() + (count + cosine_count).bit_length()
    elif combine == "photons" and power_total:
        exact, bound = density, bits
    else:
        exact, bound = cosine, cosine_total.bit_length()

    shift = max(0, bound - plan["sampler.probability_bits"])
    return [max(1, value >> shift) if any(dot(corner, normal) > 0 for corner in cell.corners) else 0
            for value, cell in zip(exact, cells)]


@dataclass
class Table:
    """A header with its photons; weights and their prefix sums once a request came."""
    header: Packet
    photons: list[Packet]
    weights: list[int] | None = None
    before: list[int] | None = None


def sample(plan: Plan, table: Table, request: Packet) -> Packet:
    """The answer to a request (docs/cdf_sampler.md, Inversion)."""
    if table.weights is None or table.before is None:
        table.weights = table_weights(plan, table.header["normal"], table.photons)
        table.before = [0, *accumulate(table.weights)]
    total = table.before[-1]
    threshold = request["u"] * total >> plan["sampler.u_bits"]
    # The last cell whose F is at most the threshold: cells of weight 0 have the F of the cell behind them.
    index = bisect_right(table.before, threshold) - 1
    cell_bits, v_bits = plan["sampler.cell_bits"], plan["sampler.v_bits"]
    row, column = index >> cell_bits, index & (1 << cell_bits) - 1
    return {
        "pixel": table.header["pixel"], "sample": table.header["sample"], "tag": request["tag"],
        "direction": [column << v_bits | request["v"][0], row << v_bits | request["v"][1]],
        "cell_index": index, "weight": table.weights[index], "total": total,
    }


def run(plan: Plan, packets: Iterable[Packet]) -> list[Packet]:
    """One sample a request (docs/cdf_sampler.md, "The stream")."""
    table: Table | None = None
    requested = False
    samples = []
    for packet in packets:
        if packet["kind"] == HEADER:
            table, requested = Table(packet, []), False
        elif table is None:
            continue
        elif packet["kind"] == PHOTON:
            if not requested and len(table.photons) < plan["gather.k"]:
                table.photons.append(packet)
        elif packet["kind"] == REQUEST:
            requested = True
            samples.append(sample(plan, table, packet))
    return samples
