# SPDX-License-Identifier: Apache-2.0
"""Routed tops of the headline's plans, each seed kept apart.

build/headline/tops/NAME-KEY has what belongs to one netlist, one flow and one set of tools: the package, top.json with what was
synthesized, and a file of each seed. KEY is made of netlist, flow and tools, so that such folders of several checkouts can be copied together
and a seed that is there is not routed again."""
import hashlib
import json
import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TypedDict

from flow.boards import Board
from flow.headline.link import link_of
from flow.headline.data import Link
from flow.headline.netlist import netlist_digest
from flow.headline.plans import HeadlinePlan
from flow.package import generate
from flow.results import Entry, add_placements
from flow.routing import Placement, forget, place, placements
from flow.shell import Failure, locked, read_text, say, write_json
from flow.synthesis import Binding, Counts, binding, synthesise
from flow.tools import Tools
from flow.typed_json import checked_json


@dataclass(frozen=True)
class Routing:
    """What a top is routed with. seeds: as many, from first_seed on; clock: MHz of the core where it is not to be the plan's or the
    board's; again: even what is kept."""
    board: Board
    tools: Tools
    seeds: int
    first_seed: int
    clock: float | None
    route_speed: int
    placer: str
    again: bool


@dataclass(frozen=True)
class Top:
    """A plan's top before it is routed. folder: where what is kept of it lies."""
    name: str
    digest: str
    folder: Path
    clock_mhz: float
    link: Link
    rate: float

    @property
    def package(self) -> Path:
        return self.folder / "package"

    @property
    def lock(self) -> Path:
        """Several commands may route seeds of the same top; also by folders that were copied together."""
        return self.folder / "lock"


class Synthesized(TypedDict):
    """top.json."""
    digest: str
    versions: dict[str, str]
    resources: Counts
    binding: Binding


class Seed(TypedDict):
    """A file of one seed; placed: None where nextpnr did not come to an end."""
    placed: Placement | None


def top_key(digest: str, flow: str, versions: dict[str, str]) -> str:
    """flow: the package's Makefile, which has part, speed grade and options of the tools."""
    return hashlib.sha256(json.dumps([digest, flow, versions], sort_keys=True).encode()).hexdigest()[:16]


def prepare(plan: HeadlinePlan, work: Path, o: Routing) -> Top:
    """Generates the package, and keeps it if none of the same netlist, flow and tools is there."""
    (work / "tops").mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=work) as made:
        package = Path(made, "package")
        try:
            clock_mhz = generate(plan.path, package, o.board, None, o.clock or plan.clock)["clock_khz"] / 1000
        except Failure as failure:
            asked = f"--clock {o.clock:g}" if o.clock else f"clock.{plan.name} of fpga/headline.toml" if plan.clock else "the board's default clock"
            raise Failure(f"{plan.name}, by {asked}: {failure}") from failure
        digest = netlist_digest(package)
        link = link_of(package, 1000 * clock_mhz)
        key = top_key(digest, read_text(package / "Makefile"), o.tools.versions)
        top = Top(plan.name, digest, work / "tops" / f"{plan.name}-{key}", clock_mhz,
                  {"baud": link.baud, "down": link.down, "up": link.up}, link.rate)
        with locked(top.lock):
            if not top.package.is_dir():
                shutil.copytree(package, top.package)
    return top


def synthesized(top: Top, o: Routing) -> Synthesized:
    """What the top takes, synthesized unless that is kept."""
    kept = top.folder / "top.json"
    with locked(top.lock):
        if kept.is_file():
            return checked_json(kept, Synthesized)
        say(f"{top.name}: synthesis")
        module = o.board.top()
        counts = synthesise(top.package, o.board, module, module, o.tools)
        found: Synthesized = {"digest": top.digest, "versions": o.tools.versions, "resources": counts, "binding": binding(counts, o.board)}
        write_json(kept, found)
        return found


def seed_file(top: Top, seed: int, placer: str, route_speed: int) -> Path:
    return top.folder / f"seed{seed}-{placer}-route{route_speed}.json"


def route_seed(top: Top, seed: int, placer: str, o: Routing) -> Placement | None:
    """One seed, routed unless it is kept, or is being routed by another command. None where nextpnr does not come to an end."""
    kept, netlist = seed_file(top, seed, placer, o.route_speed), o.board.top()
    with locked(kept.with_suffix(".lock")):
        if kept.is_file() and not o.again:
            return checked_json(kept, Seed)["placed"]
        full = synthesized(top, o)["binding"]
        if full["used"] > full["of"]:  # nextpnr would look for places without end
            raise Failure(f"{top.name}: its board needs {full['used']} {full['resource']}, the part has {full['of']}")
        if not (top.package / "build" / f"{netlist}.json").is_file():  # top.json came from another checkout
            with locked(top.lock):
                synthesise(top.package, o.board, netlist, netlist, o.tools)
        if o.again:
            forget(top.package, netlist, seed, placer, o.route_speed)
        placed = place(top.package, netlist, seed, o.tools, o.route_speed, placer)
        write_json(kept, {"placed": placed})
        return placed


def route_seeds(top: Top, o: Routing, without_end: list[int], else_default: bool = True) -> list[Placement]:
    """All seeds that are asked for; further ones for those with which nextpnr does not end, which are added to without_end."""
    def one(seed: int, placer: str) -> Placement | None:
        placed = route_seed(top, seed, placer, o)
        if placed is None:
            without_end.append(seed)
        return placed

    return placements(top.name, range(o.first_seed, o.first_seed + o.seeds), o.placer, one, else_default)


def route(top: Top, o: Routing) -> Entry:
    """The top's entry, as one of scripts/fpga, of all seeds that are asked for."""
    without_end: list[int] = []
    placed = route_seeds(top, o, without_end)
    said = synthesized(top, o)
    entry: Entry = {"name": "board", "digest": top.digest, "top": o.board.top(), "constraint_mhz": top.clock_mhz,
                    "resources": said["resources"], "binding": said["binding"], "seeds": [],
                    "route_speed": o.route_speed, "placer": o.placer}
    add_placements(entry, placed, top.folder)
    if unrouted := sorted(set(without_end) - {p["seed"] for p in placed}):
        entry["unrouted"] = unrouted
    return entry
