# SPDX-License-Identifier: Apache-2.0
"""The cycles of a plan's gathers at the clocks that its top reaches, and one core on the same photons and queries.

build/headline/simulations/NAME-KEY has the rows of throughput_gather_cluster and the photons and queries that it drew. KEY is
made of everything that they come from: netlist, plan, scene and its meshes, both clocks, program and its options."""
import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypedDict
from xml.etree import ElementTree

from flow.headline.data import Cores, Rate
from flow.headline.plans import HeadlinePlan
from flow.results import Entry, core_clocks
from flow.shell import ROOT, Failure, field, read_json, read_toml, run, say, warn, write_json
from flow.typed_json import checked_json

CLOUDS = (".photons", ".queries")
LEAST_RUNS = 7  # of one core, interleaved


@dataclass(frozen=True)
class Bench:
    """work: where results are kept. throughput, core: the programs that simulate the board and that time cores. options: further
    ones of the simulation."""
    work: Path
    scene: Path
    throughput: Path = ROOT / "build" / "verilator_tb" / "throughput" / "throughput_gather_cluster"
    core: Path = ROOT / "build" / "bench" / "bench_gather"
    options: tuple[str, ...] = ()


class Kept(TypedDict):
    """rows.json. key: what it was made from; clouds: digests of photons and queries."""
    key: dict[str, Any]
    clouds: dict[str, str]
    rows: list[dict[str, Any]]


@dataclass(frozen=True)
class Simulated:
    """folder: where photons and queries lie, as NAME.photons and NAME.queries."""
    name: str
    folder: Path
    rows: list[dict[str, Any]]


def sha256(path: Path) -> str:
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as error:
        raise Failure(f"{path}: cannot be read: {error.strerror}") from error


def scene_sha256(path: Path) -> str:
    """Of a scene and of the files that it names."""
    try:
        named = [path.parent / text.get("value", "") for text in ElementTree.parse(path).iter("string") if text.get("name") == "filename"]
    except (OSError, ElementTree.ParseError) as error:
        raise Failure(f"{path}: cannot be read: {error}") from error
    return hashlib.sha256("".join(map(sha256, [path, *named])).encode()).hexdigest()


def sdram_mhz(entry: Entry) -> float | None:
    """The SDRAM's clock to simulate: what it is constrained to, or what it reaches where that is slower; the controller
    counts the chip's times in cycles of the constraint. None where the top has no such clock."""
    core = core_clocks(entry["clocks"], entry["constraint_mhz"])
    clocks = [clock for net, clock in entry["clocks"].items() if net not in core]
    if len(clocks) > 1:
        raise Failure(f"{entry['top']}: has {len(clocks)} clocks beside the core's, expected the SDRAM's alone")
    return min(clocks[0]["median"], clocks[0]["constraint"]) if clocks else None


def clock_options(entry: Entry) -> list[str]:
    mhz = sdram_mhz(entry)
    return (["--core-mhz", f"{entry['fmax_mhz']['median']:.2f}"] + (["--sdram-mhz", f"{mhz:.2f}"] if mhz else []))


def made_from(plan: HeadlinePlan, entry: Entry, bench: Bench) -> dict[str, Any]:
    """Everything that a simulation comes from."""
    return {"netlist": entry["digest"], "plan": sha256(plan.path), "scene": scene_sha256(bench.scene),
            "program": sha256(bench.throughput), "options": [*clock_options(entry), *bench.options]}


def simulate(plan: HeadlinePlan, entry: Entry, bench: Bench) -> Simulated:
    """Simulates a plan, unless what it was made from is kept."""
    key = made_from(plan, entry, bench)
    short = hashlib.sha256(json.dumps(key, sort_keys=True).encode()).hexdigest()[:16]
    folder = bench.work / "simulations" / f"{plan.name}-{short}"
    kept, written = folder / "rows.json", folder / "written.json"
    clouds = {end: folder / (plan.name + end) for end in CLOUDS}
    if kept.is_file() and all(path.is_file() for path in clouds.values()):
        before = checked_json(kept, Kept)
        if before["key"] == key and before["clouds"] == {end: sha256(path) for end, path in clouds.items()}:
            return Simulated(plan.name, folder, before["rows"])
    folder.mkdir(parents=True, exist_ok=True)
    for path in (kept, written):
        path.unlink(missing_ok=True)
    say(f"simulates {plan.name}")
    try:
        run([str(bench.throughput), str(plan.path), "--radius", *clock_options(entry), "--json", str(written), "--dump",
             str(folder), "--scene", str(bench.scene), *bench.options], log=folder / "log", cwd=ROOT)
    except Failure:
        if not written.is_file():
            raise
        warn(f"{plan.name}: a goal of the simulation is missed, see {folder / 'log'}")
    rows = read_json(written)["gather_cluster"]
    written.unlink()
    write_json(kept, {"key": key, "clouds": {end: sha256(path) for end, path in clouds.items()}, "rows": rows}, indent=None)
    return Simulated(plan.name, folder, rows)


def rate_of(said: Mapping[str, Any], name: str, path: Path) -> Rate:
    if said["runs"] < LEAST_RUNS:
        raise Failure(f"{path}: {name} was timed {said['runs']} times, expected at least {LEAST_RUNS}")
    return {"least": said["least"], "median": said["median"], "most": said["most"], "runs": said["runs"]}


@dataclass(frozen=True)
class Timed:
    """one: library, and photonloom for golden -> its rate on one core. all_cores: golden on the whole machine. recall: of golden,
    which visits leaf_limit leaves at most where that is not 0, beside the libraries, which are exact."""
    one: dict[str, Rate]
    all_cores: Cores
    leaf_limit: int
    recall: float


def time_core(plan: HeadlinePlan, simulated: Simulated, bench: Bench) -> dict[int | None, Timed]:
    """r2_max -> what was timed; in the order of the simulation. Golden searches as the plan says."""
    rows, path = simulated.rows, simulated.folder / "core.json"
    radius = next(r["r2_max"] for r in rows if r["r2_max"])
    said = read_toml(plan.path)
    limit = field(said, plan.path, "gather.leaf_limit", int, "a number of leaves")
    bucket = field(said, plan.path, "photon.bucket", int, "a number of photons")
    say(f"times one core and all on {simulated.name}")
    run([str(bench.core), str(path), "--cloud", *(str(simulated.folder / (simulated.name + end)) for end in CLOUDS),
         "-k", str(rows[0]["k"]), "--r2-max", str(radius)] + (["--leaf-limit", str(limit), "--bucket", str(bucket)] if limit else []), log=simulated.folder / "core.log")
    return {core["r2_max"]: Timed({name: rate_of(rate, name, path) for name, rate in core["spread"].items()},
                                  {"threads": core["all_cores"]["threads"], "share": core["all_cores"]["share"],
                                   "rate": rate_of(core["all_cores"], "all cores", path)}, limit, core["recall"])
            for core in read_json(path)}
