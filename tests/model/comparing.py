# SPDX-License-Identifier: Apache-2.0
"""Each unit's packets beside the model's, compared with ==."""
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from typing import Any

import cdf_sampler
import irradiance_cache
import photon_gatherer
import photon_map
import reorder_buffer
from drawing import Widths, cache_lookups, gather_queries, map_photons, sampler_inputs
from plan import Plan, r2_max
from program import Failure, Program, read_packets, write_packets

Packet = dict[str, Any]


@dataclass
class Tally:
    """Packets that were equal, by unit and stream."""
    packets: dict[str, dict[str, int]] = field(default_factory=dict)

    def compare(self, unit: str, stream: str, expected: Sequence[Packet], modelled: Sequence[Packet],
                asked: Sequence[Packet] = ()) -> None:
        """Fails at the first packet that is not equal. asked: what each packet answers, where it answers one."""
        difference = first_difference(expected, modelled, asked)
        if difference:
            raise Failure(f"{unit}, {stream}: {difference}")
        streams = self.packets.setdefault(unit, {})
        streams[stream] = streams.get(stream, 0) + len(expected)


def first_difference(expected: Sequence[Packet], modelled: Sequence[Packet], asked: Sequence[Packet] = ()) -> str | None:
    """Words for the first packet that is not equal, None where all are."""
    for number, (golden, model) in enumerate(zip(expected, modelled)):
        if golden == model:
            continue
        lines = [f"packet {number} of {len(expected)} differs"]
        lines += [f"    {name}: golden {golden.get(name, 'absent')}, model {model.get(name, 'absent')}"
                  for name in {**golden, **model} if golden.get(name) != model.get(name)]
        lines += [f"  input  {asked[number]}"] if number < len(asked) else []
        return "\n".join([*lines, f"  golden {golden}", f"  model  {model}"])
    if len(expected) != len(modelled):
        return f"golden has {len(expected)} packets, the model {len(modelled)}"
    return None


@dataclass
class Case:
    """A plan, and what packets are drawn for it."""
    program: Program
    plan: Plan
    widths: Widths
    folder: Path
    random: Random
    packets: int
    backend: str
    tally: Tally

    def replay(self, unit: str, packets: list[Packet], *more: str | Path) -> Path:
        """Feeds the unit; the file of its answers. The plan is `plan.toml` of the folder."""
        for stale in self.folder.glob("out.*"):
            stale.unlink()
        write_packets(self.folder / "in.jsonl", packets)
        answers = self.folder / "out.jsonl"
        self.program.run("replay", unit, "--plan", self.folder / "plan.toml", "--packets", self.folder / "in.jsonl",
                         "--backend", self.backend, "-o", answers, *more)
        return answers


def compare_gatherer(case: Case) -> None:
    """Maps of photons, then queries: addresses of the photons, results, photons that queries want."""
    unit, plan, bits, folder = "photon_gatherer", case.plan, case.widths.bits, case.folder
    photons = [map_photons(case.random, plan, plan[f"{section}.photons"]) for section in ("global", "caustic")]
    queries = gather_queries(case.random, plan, case.widths, case.packets, photons)
    more: list[str | Path] = []
    for option, some in zip(("--photons", "--caustics"), photons):
        if some:
            write_packets(folder / f"in{option}.jsonl", some)
            more += [option, folder / f"in{option}.jsonl"]
    answers = case.replay(unit, queries, *more)
    maps = [photon_map.build(plan, some) for some in photons]
    for name, some, built in zip(("addresses", "caustic_addresses"), photons, maps):
        if some:
            case.tally.compare(unit, "address", read_packets(folder / f"out.{name}.jsonl", bits["map_photon"]),
                               [{"index": address, **photon} for address, photon in zip(built.addresses, some)])
    results, wanted = photon_gatherer.run(plan, maps, [r2_max(plan, "global"), r2_max(plan, "caustic")], queries)
    case.tally.compare(unit, "gather_result", read_packets(answers, bits["gather_result"]), results, queries)
    left = folder / "out.photons.jsonl"  # not there where no photon leaves
    case.tally.compare(unit, "gather_photon", read_packets(left, bits["gather_photon"]) if left.exists() else [], wanted)


def stream_unit(unit: str, out: str, draw: Callable[[Case], list[Packet]], asks: Callable[[Packet], bool] | None,
                model: Callable[[Plan, list[Packet]], list[Packet]]) -> Callable[[Case], None]:
    """The comparison of a unit with one stream in and one out. asks: which packets are answered, where each has one answer."""
    def compare(case: Case) -> None:
        packets = draw(case)
        answers = read_packets(case.replay(unit, packets), case.widths.bits[out])
        case.tally.compare(unit, out, answers, model(case.plan, packets), [p for p in packets if asks(p)] if asks else [])
    return compare


UNITS: dict[str, Callable[[Case], None]] = {
    "photon_gatherer": compare_gatherer,
    "reorder_buffer": stream_unit(
        "reorder_buffer", "gather_query",
        lambda case: gather_queries(case.random, case.plan, case.widths, case.packets, [[], []]), None, reorder_buffer.run),
    "cdf_sampler": stream_unit(
        "cdf_sampler", "sample", lambda case: sampler_inputs(case.random, case.plan, case.widths, case.packets),
        lambda packet: bool(packet["kind"] == cdf_sampler.REQUEST), cdf_sampler.run),
    "irradiance_cache": stream_unit(
        "irradiance_cache", "cache_result", lambda case: cache_lookups(case.random, case.plan, case.widths, case.packets),
        lambda _: True, irradiance_cache.run),
}
