# SPDX-License-Identifier: Apache-2.0
"""What a kernel package records (docs/hls.md, "The kernel package"): packed packets, memory and nodes that were drawn for a plan,
and what golden gave. Shows that packets are packed as docs/packets.md has it."""
import re
from pathlib import Path
from typing import Any

import cdf_sampler
import irradiance_cache
import photon_gatherer
import photon_map
import reorder_buffer
from comparing import Tally
from drawing import Widths
from plan import Plan
from program import Failure

Packet = dict[str, Any]
STREAM_UNITS = {"reorder_buffer": reorder_buffer.run, "cdf_sampler": cdf_sampler.run, "irradiance_cache": irradiance_cache.run}


def numbers(text: str, name: str) -> list[int]:
    """The numbers of an array of the recording."""
    found = re.search(rf"\b{name}\[\d?\] = {{(.*?)}};", text, re.DOTALL)
    if not found:
        raise Failure(f"the recording has no array {name}")
    return [int(number, 0) for number in re.findall(r"0x[0-9a-f]+|\d+", found[1])]


def unpack(widths: Widths, packet: str, word: int) -> Packet:
    """docs/packets.md, "In hardware": the first field in the most significant bits, element 0 of an array lowest."""
    result: Packet = {}
    for name, bits in reversed(widths.bits[packet].items()):
        count = widths.elements.get((packet, name))
        values = []
        for _ in range(count or 1):
            values.append(word & (1 << bits) - 1)
            word >>= bits
        result[name] = values if count else values[0]
    return result


def packets(text: str, widths: Widths, name: str) -> tuple[str, list[Packet]]:
    """Kind and packets of a stream, whose packets are words of 32 bits, the least significant first (docs/host-link.md)."""
    heading = re.search(rf"// (\w+), (\d+) words each\nconstexpr unsigned {name}_packets", text)
    if not heading:
        raise Failure(f"the recording has no stream {name}")
    packet, size = heading[1], int(heading[2])
    words = numbers(text, name)
    joined = [sum(word << 32 * i for i, word in enumerate(words[at:at + size])) for at in range(0, len(words), size)]
    return packet, [unpack(widths, packet, word) for word in joined]


def rebuilt(plan: Plan, data: bytes, leaves: int, number: int, tally: Tally) -> photon_map.PhotonMap:
    """Map `number` of a memory image. Built again of the photons in it, its lines are the same. Photons that are equal in all
    their bits may lie in two leaves, so they go in by leaves from left to right, as their numbers in the input did."""
    line_bytes = plan["photon.bucket"] * plan["photon.photon_bytes"]
    lines = [data[start:start + line_bytes] for start in range(0, len(data), line_bytes)]
    stored = photon_map.leaves(plan, lines, leaves)

    def below(node: int) -> list[Packet]:
        return stored[node - leaves] if node >= leaves else below(2 * node) + below(2 * node + 1)

    built = photon_map.build(plan, below(1) if leaves else [])
    tally.compare("photon_gatherer", "memory line", [{"bytes": line.hex()} for line in lines],
                  [{"bytes": line.hex()} for line in photon_map.memory(plan, built, number)])
    return built


def compare_gatherer(plan: Plan, widths: Widths, text: str, tally: Tally) -> None:
    """Memory, nodes, results and photons."""
    leaves = numbers(text, "map_lines")
    maps = [rebuilt(plan, b"".join(word.to_bytes(4, "little") for word in numbers(text, name)), leaves[number], number, tally)
            for number, name in enumerate(("global", "caustic"))]
    radii = numbers(text, "map_r2_max")
    nodes = numbers(text, "nodes")
    modelled = {address: datum for address, datum in photon_map.configuration(plan, maps, radii).items() if address < 0x800000}
    tally.compare("photon_gatherer", "node", [{"address": a, "datum": d} for a, d in sorted(zip(nodes[::2], nodes[1::2]))],
                  [{"address": address, "datum": datum} for address, datum in sorted(modelled.items())])
    queries = packets(text, widths, "in")[1]
    results, wanted = photon_gatherer.run(plan, maps, radii, queries)
    tally.compare("photon_gatherer", "gather_result", packets(text, widths, "result")[1], results, queries)
    tally.compare("photon_gatherer", "gather_photon", packets(text, widths, "photon")[1], wanted)


def compare_package(plan: Plan, widths: Widths, data: Path, tally: Tally) -> None:
    """Every recording of a package."""
    for path in sorted(data.glob("*.hpp")):
        text = path.read_text(encoding="utf-8")
        if path.stem in STREAM_UNITS:
            packet, out = packets(text, widths, "out")
            tally.compare(path.stem, packet, out, STREAM_UNITS[path.stem](plan, packets(text, widths, "in")[1]))
        else:
            compare_gatherer(plan, widths, text, tally)
