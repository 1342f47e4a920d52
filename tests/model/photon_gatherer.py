# SPDX-License-Identifier: Apache-2.0
"""The unit photon_gatherer, after docs/photon_gatherer.md."""
from bisect import insort
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from numeric import oct_decode, reciprocal
from photon_map import Photon, PhotonMap
from plan import Plan

Packet = dict[str, Any]
Found = tuple[int, int, Photon]


@dataclass
class Search:
    """What one query found: candidates as (d^2, index, photon), nearest first, and its counts."""
    found: list[Found]
    nodes: int = 0
    leaves: int = 0
    insertions: int = 0


def facing_of(plan: Plan, query: Packet) -> tuple[int, int, int]:
    """o(n) of a query's normal."""
    u, v = query["normal"]
    return oct_decode(u, v, plan["gather.normal_bits"])


def search(plan: Plan, photons: PhotonMap, r2_max: int, query: Packet) -> Search:
    """docs/photon_gatherer.md, "The order of one query"."""
    result = Search([])
    if not photons.lines:
        return result
    found = result.found
    k, leaf_limit = plan["gather.k"], plan["gather.leaf_limit"]
    factor, shift = plan["gather.epsilon_factor"], plan["gather.epsilon_shift"]
    line_count = len(photons.lines)
    position = query["position"]
    x, y, z = position
    normal_x, normal_y, normal_z = facing_of(plan, query)
    bound = r2_max
    stack: list[tuple[int, tuple[int, int, int]]] = []
    node, offset = 1, (0, 0, 0)
    while True:
        while node < line_count:
            result.nodes += 1
            axis, split = photons.nodes[node]
            right = int(position[axis] >= split)
            far = abs(position[axis] - split)
            stack.append((2 * node + 1 - right, (offset[:axis] + (far,) + offset[axis + 1:])))  # type: ignore[arg-type]
            node = 2 * node + right
        for photon in photons.lines[node - line_count]:
            px, py, pz = photon.position
            d2 = (px - x) * (px - x) + (py - y) * (py - y) + (pz - z) * (pz - z)
            # The bound is r2_max or the k-th d^2: what is beyond it is no candidate or cannot enter.
            if d2 > bound:
                continue
            fx, fy, fz = photon.facing
            if fx * normal_x + fy * normal_y + fz * normal_z <= 0:
                continue
            if len(found) < k:
                insort(found, (d2, photon.index, photon))
                result.insertions += 1
            elif (d2, photon.index) < found[-1][:2]:
                found.pop()
                insort(found, (d2, photon.index, photon))
                result.insertions += 1
            if len(found) == k:
                bound = found[-1][0]
        result.leaves += 1
        if result.leaves == leaf_limit:
            return result
        while stack:
            node, offset = stack.pop()
            if (offset[0] * offset[0] + offset[1] * offset[1] + offset[2] * offset[2]) * factor <= bound << shift:
                break
        else:
            return result


def nearest(plan: Plan, photons: PhotonMap, r2_max: int, query: Packet) -> list[Found]:
    """The definition without an order: the k candidates smallest in (d^2, index) (docs/photon_gatherer.md, "What it
    computes"). Search gives the same where it is exact and unlimited."""
    normal = facing_of(plan, query)
    candidates = []
    for line in photons.lines:
        for photon in line:
            d2 = sum((a - b) ** 2 for a, b in zip(photon.position, query["position"]))
            if d2 <= r2_max and sum(a * b for a, b in zip(photon.facing, normal)) > 0:
                candidates.append((d2, photon.index, photon))
    return sorted(candidates, key=lambda candidate: candidate[:2])[:plan["gather.k"]]


def answer(plan: Plan, query: Packet, r2_max: int, searched: Search | None) -> tuple[Packet, list[Packet]]:
    """Result and photons of a query, or of a flush, which has searched nothing (docs/photon_gatherer.md, "What it
    computes"; docs/packets.md for the fields)."""
    width = plan["gather.reciprocal_bits"]
    result: Packet = {name: query[name] for name in ("pixel", "sample", "tag")}
    found = searched.found if searched else []
    full = len(found) == plan["gather.k"]
    r2 = (found[-1][0] if full else r2_max) if searched else 0
    floored = max(r2, plan["gather.r2_floor"])
    result |= {
        "map": query["map"] if searched else 0,
        "flush": int(searched is None),
        "count": len(found),
        "r2": r2,
        "flux": [sum(photon.mantissa[channel] << photon.exponent for _, _, photon in found)
                 for channel in range(plan["photon.channels"])],
    }
    if width:
        mantissa, exponent = reciprocal(floored, width) if searched else (0, 0)
        result |= {"reciprocal": mantissa, "reciprocal_exponent": exponent}
    result |= {
        "full": int(full),
        "clamped": int(searched is not None and r2 < plan["gather.r2_floor"]),
        "nodes": searched.nodes if searched else 0,
        "leaves": searched.leaves if searched else 0,
        "insertions": searched.insertions if searched else 0,
    }
    if plan.get("board.parity"):
        result["faulty"] = 0  # memories of a model are right
    photons = []
    if searched and query["want_photons"]:
        photons = [{"index": index, "d2": d2, "mantissa": list(photon.mantissa), "exponent": photon.exponent,
                    "direction": list(photon.direction), "last": int(place == len(found))}
                   for place, (d2, index, photon) in enumerate(found, 1)]
    return result, photons


def run(plan: Plan, maps: list[PhotonMap], r2_max: list[int], packets: Iterable[Packet]) -> tuple[list[Packet], list[Packet]]:
    """Both output streams: results, photons. maps, r2_max: of the global and of the caustic map."""
    results, photons = [], []
    for query in packets:
        which = query["map"]
        searched = None if query["flush"] else search(plan, maps[which], r2_max[which], query)
        result, wanted = answer(plan, query, r2_max[which], searched)
        results.append(result)
        photons += wanted
    return results, photons
