# SPDX-License-Identifier: Apache-2.0
"""Recorded frames: every unit's packets, the memory image of the frame's maps (docs/photon_map.md, "In a package"), and the
recordings of the kernel package of their plan."""
from pathlib import Path
from random import Random
from typing import Any

import cdf_sampler
import irradiance_cache
import photon_gatherer
import photon_map
import reorder_buffer
from comparing import Tally
from drawn_plans import compressed_fits, draw_plan
from packages import compare_package, rebuilt
from plan import Plan, r2_max, read_plan
from program import Program, read_packets

Packet = dict[str, Any]
SECTIONS = ("photon", "gather", "gatherer", "reorder", "sampler", "cache")
OF_THE_PHOTONS = ("photon.channels", "photon.exponent_bits")  # the planner knows what they need


def record(program: Program, scene: Path, random: Random, base: Plan, folder: Path) -> Plan:
    """A frame with drawn lines: `record` has its packets, `hw` its package, `plan.toml` is its plan."""
    plan = draw_plan(random, base)
    lines = {name: value for name, value in plan.items()
             if name.split(".")[0] in SECTIONS and name not in OF_THE_PHOTONS}
    lines["gather.k"] = max(2, plan["gather.k"])  # an image takes no estimate of one photon
    # A stride for whatever width of a photon the planner takes: the widest, or the least that all of them can have.
    stride = lines["photon.photon_bytes"] = 32
    if lines["photon.lines"] == "compressed":
        stride = lines["photon.photon_bytes"] = min(
            bytes_ for bytes_ in range(4, 33) if lines["photon.bucket"] * bytes_ % 16 == 0
            and all(compressed_fits(Plan({**plan, "photon.photon_bytes": bytes_, "photon.channels": channels,
                                          "photon.exponent_bits": exponent, "global.photons": 1200, "caustic.photons": 300}))
                    for channels in (1, 3) for exponent in range(1, 6)))
    lines["gatherer.cache_bytes"] = stride * lines["photon.bucket"] * lines["gatherer.cache_ways"]
    lines["gatherer.beat_bits"] = random.choice((32, 64, 128))
    lines["board.photon_memory"] = "block_ram"  # an SDRAM, which much room for further lines would ask for, has wider beats
    path = folder / "plan.toml"
    program.run("plan", scene, "--size", "12x12", "--spp", "2", "--gather-rays", "6",
                "--photons", "1200", "--caustic-photons", "300", "-o", path,
                *(word for name, value in lines.items() for word in ("--set", f"{name}={str(value).lower()}")))
    program.run("render", scene, "--plan", path, "-o", folder / "frame.exr", "--record", folder / "record")
    program.run("generate", scene, "--plan", path, "-o", folder / "hw", "--hls")
    return read_plan(path)


def compare_maps(plan: Plan, images: Path, tally: Tally) -> list[photon_map.PhotonMap]:
    """The maps of a package's images, and the configuration: their inner nodes, lines and radii."""
    # Sorted: the order of writes means nothing.
    writes = sorted(line.split() for line in (images / "cfg.hex").read_text(encoding="utf-8").splitlines())
    written = {int(address, 16): int(datum, 16) for address, datum in writes}
    maps = []
    for number, section in enumerate(("global", "caustic")):
        beats = (images / f"{section}_lines.hex").read_text(encoding="utf-8").split()
        data = b"".join(bytes.fromhex(beat)[::-1] for beat in beats)
        maps.append(rebuilt(plan, data, written[0x800000 + 2 * number], number, tally))
    modelled = photon_map.configuration(plan, maps, [r2_max(plan, "global"), r2_max(plan, "caustic")])
    tally.compare("photon_gatherer", "configuration",
                  [{"address": int(address, 16), "datum": int(datum, 16)} for address, datum in writes],
                  [{"address": address, "datum": datum} for address, datum in sorted(modelled.items())])
    return maps


def compare_frame(program: Program, scene: Path, random: Random, base: Plan, folder: Path, tally: Tally) -> None:
    """Every stream of a frame (docs/packets.md; a unit that the plan lacks has none)."""
    plan = record(program, scene, random, base, folder)
    widths = program.widths(folder / "plan.toml")
    bits = widths.bits
    compare_package(plan, widths, folder / "hw" / "hls" / "data", tally)
    maps = compare_maps(plan, folder / "hw" / "images", tally)

    def recorded(stream: str, packet: str) -> list[Packet]:
        file = folder / "record" / f"{stream}.jsonl"
        return read_packets(file, bits[packet]) if file.exists() else []

    queries = recorded("gather_query", "gather_query")
    results, wanted = photon_gatherer.run(plan, maps, [r2_max(plan, "global"), r2_max(plan, "caustic")], queries)
    tally.compare("photon_gatherer", "gather_result", recorded("gather_result", "gather_result"), results, queries)
    tally.compare("photon_gatherer", "gather_photon", recorded("gather_photon", "gather_photon"), wanted)
    tally.compare("reorder_buffer", "gather_query", recorded("reorder_out", "gather_query"),
                  reorder_buffer.run(plan, recorded("reorder_in", "gather_query")))
    tally.compare("cdf_sampler", "sample", recorded("sample", "sample"),
                  cdf_sampler.run(plan, recorded("sampler_input", "sampler_input")))
    lookups = recorded("cache_lookup", "cache_lookup")
    tally.compare("irradiance_cache", "cache_result", recorded("cache_result", "cache_result"),
                  irradiance_cache.run(plan, lookups), lookups)
