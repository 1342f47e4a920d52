# SPDX-License-Identifier: Apache-2.0
"""What the commands judge by: fpga/goals.toml."""
import math
from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from flow.shell import ROOT, Failure, field, read_toml

GOALS = ROOT / "fpga" / "goals.toml"
HEADLINE = ROOT / "fpga" / "headline"  # its plans
MEMORIES = ("block_ram", "sdram")  # board.photon_memory of a plan


@dataclass(frozen=True)
class AreaGoals:
    """growth: share of its baseline by which a resource may grow. ci_yosys: the version that must have a baseline. runs: of Yosys, whose median
    is a unit's size."""
    growth: float
    ci_yosys: str
    runs: int


@dataclass(frozen=True)
class ImageGoals:
    """Frames that are timed: of which scenes, with the formats of which plan of fpga/headline."""
    scenes: tuple[Path, ...]
    plan: str
    width: int
    height: int
    spp: int
    gather_rays: int


@dataclass(frozen=True)
class CoarseGoals:
    """Of a row in coarser formats: most relMSE against reference arithmetic, and times the rate of the plan's own formats."""
    relmse: float
    times: float


@dataclass(frozen=True)
class Growth:
    """Of a plan, without a radius and within the mean r²: its rate before in Mquery/s, times that, and how many gatherers of a
    routed top will do instead (0: no number)."""
    before: tuple[float, float]
    times: tuple[float, float]
    or_gatherers: tuple[int, int]


@dataclass(frozen=True)
class GainGoals:
    """commit: of the rates before. golden: photon memory -> times golden on one core. plans: what each is to gain."""
    commit: str
    golden: dict[str, float]
    plans: dict[str, Growth]


@dataclass(frozen=True)
class HeadlineGoals:
    """board: where queries a second are those of its routed top. scene: whose photons and queries are gathered. replay: the
    plan whose replayer is simulated. images: what is timed of whole images. times: multiples of one core, photon memory -> k as text -> multiple.
    gain: beside an earlier commit and golden. share: what binds a row from SDRAM -> share of its own bound. coarse: of rows in
    coarser formats."""
    board: str
    scene: Path
    replay: str
    images: ImageGoals
    times: dict[str, dict[str, float]]
    gain: GainGoals
    share: dict[str, float]
    coarse: CoarseGoals
    path: Path

    def times_core(self, memory: str, k: int) -> float:
        """Times one core that a plan is to do."""
        goal = self.times.get(memory, {}).get(str(k))
        if goal is None:
            raise Failure(f"{self.path}: headline.times_core.{memory}.{k} is missing, expected a goal for this plan")
        return goal


@dataclass(frozen=True)
class FastGoals:
    """board: where the gatherers are routed alone. seeds: placements of each. mhz: k -> what their median is to reach. rates:
    k -> gathers a second for 1,000 LUT-equivalents, where not those of the narrow plan count."""
    board: str
    seeds: int
    mhz: dict[int, float]
    rates: dict[int, float]
    path: Path

    def megahertz(self, k: int) -> float:
        if k not in self.mhz:
            raise Failure(f"{self.path}: fast.mhz.{k} is missing, expected a goal for this k")
        return self.mhz[k]


@dataclass(frozen=True)
class PlannedGoals:
    """Scenes whose engines for a board are routed; options: of photonloom plan beside --board."""
    board: str
    options: tuple[str, ...]
    scenes: tuple[Path, ...]


def headline_names() -> list[str]:
    """The plans of fpga/headline."""
    return [path.stem for path in sorted(HEADLINE.glob("*.toml"))]


def refuse_unknown(table: dict[str, Any], path: Path, name: str, known: Collection[str]) -> None:
    """A key that is misspelt would be a goal that nothing is judged by."""
    if unknown := next((key for key in table if key not in known), None):
        raise Failure(f"{path}: {name}.{unknown} is unknown, expected some of {', '.join(known)}")


def texts(said: dict[str, Any], path: Path, name: str, expected: str) -> tuple[str, ...]:
    found = field(said, path, name, list, expected)
    if not all(isinstance(text, str) for text in found):
        raise Failure(f"{path}: {name} is {found}, expected {expected}")
    return tuple(found)


def scenes_of(said: dict[str, Any], path: Path, name: str) -> tuple[Path, ...]:
    return tuple(ROOT / scene for scene in texts(said, path, name, "a list of scenes"))


def count(said: dict[str, Any], path: Path, name: str) -> int:
    found: int = field(said, path, name, int, "a count of at least 1")
    if found < 1:
        raise Failure(f"{path}: {name} is {found}, expected a count of at least 1")
    return found


def planned_goals(path: Path = GOALS) -> PlannedGoals:
    said = read_toml(path)
    return PlannedGoals(field(said, path, "planned.board", str, "a board"), texts(said, path, "planned.options", "a list of options"),
                        scenes_of(said, path, "planned.scenes"))


def area_goals(path: Path = GOALS) -> AreaGoals:
    said = read_toml(path)
    growth: float = field(said, path, "area.growth", (int, float), "a share of at least 0, below 1")
    if not 0 <= growth < 1:  # nor nan, beside which nothing would be more
        raise Failure(f"{path}: area.growth is {growth}, expected a share of at least 0, below 1")
    return AreaGoals(growth,
                     field(said, path, "area.ci_yosys", str, "a version of Yosys"),
                     count(said, path, "area.runs"))


def gain_goals(said: dict[str, Any], path: Path) -> GainGoals:
    gain: dict[str, Any] = field(said, path, "headline.gain", dict, "a table")
    refuse_unknown(gain, path, "headline.gain", ("commit", "golden", *headline_names()))

    def pair(plan: str, name: str, expected: str, right: Callable[[Any], bool]) -> tuple[Any, Any]:
        found = field(said, path, f"headline.gain.{plan}.{name}", list, expected)
        if len(found) != 2 or not all(right(number) for number in found):
            raise Failure(f"{path}: headline.gain.{plan}.{name} is {found}, expected {expected}")
        return found[0], found[1]

    def rates(plan: str, name: str) -> tuple[float, float]:
        return pair(plan, name, "two numbers above 0", lambda number: type(number) in (int, float) and 0 < number < math.inf)

    refuse_unknown(field(said, path, "headline.gain.golden", dict, "a table"), path, "headline.gain.golden", MEMORIES)
    golden = {memory: float(field(said, path, f"headline.gain.golden.{memory}", (int, float), "a multiple of one core")) for memory in MEMORIES}
    plans = {plan: Growth(rates(plan, "before"), rates(plan, "times"),
                          pair(plan, "or_gatherers", "two counts", lambda number: type(number) is int and number >= 0))
             for plan in gain if plan not in ("commit", "golden")}
    return GainGoals(field(said, path, "headline.gain.commit", str, "a commit"), golden, plans)


def headline_goals(path: Path = GOALS) -> HeadlineGoals:
    said = read_toml(path)
    times: dict[str, Any] = field(said, path, "headline.times_core", dict, "a table")
    refuse_unknown(times, path, "headline.times_core", MEMORIES)
    for memory in times:
        for k in field(said, path, f"headline.times_core.{memory}", dict, "a table"):
            field(said, path, f"headline.times_core.{memory}.{k}", (int, float), "a multiple of one core")
    plan = field(said, path, "headline.images.plan", str, "a plan of fpga/headline")
    if plan not in headline_names():
        raise Failure(f"{path}: headline.images.plan is {plan}, expected one of {', '.join(headline_names())}")
    images = ImageGoals(scenes_of(said, path, "headline.images.scenes"), plan,
                        *(count(said, path, f"headline.images.{name}") for name in ("width", "height", "spp", "gather_rays")))
    return HeadlineGoals(field(said, path, "headline.board", str, "a board"),
                         ROOT / field(said, path, "headline.scene", str, "a scene below the repository's root"),
                         field(said, path, "headline.replay", str, "a plan of fpga/headline"), images, times, gain_goals(said, path),
                         {by: float(field(said, path, f"headline.share.{by}", (int, float), "a share")) for by in ("SDRAM", "gatherers")},
                         CoarseGoals(*(field(said, path, f"headline.coarse.{name}", (int, float), "a number") for name in ("relmse", "times"))), path)


def fast_goals(path: Path = GOALS) -> FastGoals:
    said = read_toml(path)

    def of_k(name: str) -> dict[int, float]:
        table: dict[str, Any] = field(said, path, name, dict, "a table")
        if unknown := next((k for k in table if not k.isdecimal()), None):
            raise Failure(f"{path}: {name}.{unknown} is unknown, expected a k, a whole number")
        return {int(k): float(field(said, path, f"{name}.{k}", (int, float), "a number")) for k in table}

    return FastGoals(field(said, path, "fast.board", str, "a board"), count(said, path, "fast.seeds"),
                     of_k("fast.mhz"), of_k("fast.rates"), path)
