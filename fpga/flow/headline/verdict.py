# SPDX-License-Identifier: Apache-2.0
"""Whether a row reaches its goal, its stated multiple of one core, and apart from that what bounds it."""
from collections.abc import Sequence
from dataclasses import dataclass

from flow.goals import CoarseGoals, GainGoals, HeadlineGoals
from flow.headline.data import GOLDEN, Row, SdramLoad
from flow.results import clock_name


@dataclass(frozen=True)
class Verdict:
    """Rates in queries a second. library: the fastest but golden. times: of the faster of the two cores, by the medians.
    goal: None of a variant. bound: what this design's own gatherers, at its own clock, could do with the lines that they read; share: of it, reached; share_goal: of it, that
    a row from SDRAM in the default formats is to reach.
    part: resource of the part -> what gatherers that fill it could do at this clock. missed: why the row fails."""
    board: float
    library: str
    times: float
    goal: float | None
    missed_clocks: list[str]
    bound: float
    bound_by: str
    share: float
    share_goal: float | None
    part: dict[str, float]
    missed: list[str]

    @property
    def reached(self) -> bool:
        return (self.goal is None or self.times >= self.goal) and not self.missed_clocks

    @property
    def share_reached(self) -> bool:
        return self.share_goal is None or self.share >= self.share_goal

    @property
    def part_by(self) -> str:
        """The resource of the part that bounds first."""
        return min(self.part, key=lambda name: self.part[name])


def slower_than_golden(row: Row, verdict: Verdict) -> bool:
    return verdict.board < row["cores"][GOLDEN]["median"]


def board_for_size(row: Row, verdict: Verdict) -> float | None:
    """Gathers a second for 1,000 LUT-equivalents of the whole top; None where those were not recorded."""
    return 1000 * verdict.board / row["lut_eq"] if row["lut_eq"] else None


def clocks_missed(row: Row) -> list[str]:
    """The clocks whose median over the seeds is under what they are constrained to."""
    return [f"{clock_name(net)} reaches {c['median']:.1f} MHz of {c['constraint']:g}"
            for net, c in (row["clocks"] or {}).items() if c["median"] < c["constraint"]]


def cycles_without_row_changes(load: SdramLoad) -> float:
    """Cycles of the core in which the SDRAM's pins move a gather's lines, refreshes apart."""
    moved = load["lines"] * load["line_bytes"] / 2
    return load["cycles"] * moved / (moved + load["row_changes"] * load["row_change_cycles"])


def own_bound(row: Row) -> tuple[float, str]:
    """The bound that binds, chosen by cycles."""
    cycles = {"gatherers": row["cost"]["bound"] / row["gatherers"]}
    if row["ports_cycles"]:
        cycles["photon memory"] = row["ports_cycles"]
    if row["sdram"]:
        cycles["SDRAM"] = row["sdram"]["cycles"]
    by = max(cycles, key=lambda name: cycles[name])
    return 1e6 * row["fmax_mhz"]["median"] / cycles[by], by


def part_bounds(row: Row) -> dict[str, float]:
    """Queries a second of as many gatherers as each resource of the part has room for, and of the SDRAM's pins."""
    each = 1e6 * row["fmax_mhz"]["median"] / row["cost"]["bound"]
    bounds = {name: number * each for name, number in row["fits"].items()}
    if load := row["sdram"]:
        bounds["SDRAM pins"] = 1e6 * load["mhz"] / (load["lines"] * load["line_bytes"] / 2)
    return bounds


def rate(row: Row) -> float:
    """Queries a second of the board."""
    return 1e6 * row["fmax_mhz"]["median"] / row["cycles_per_gather"]


@dataclass(frozen=True)
class CoarseVerdict:
    """times: the rate over that of the row in the plan's own formats; None where that one was not measured. missed: why the
    row fails beside what judge() finds."""
    times: float | None
    missed: list[str]


def finer_row(row: Row, rows: Sequence[Row]) -> Row | None:
    """The row that one in coarser formats is judged beside."""
    return next((r for r in rows if row["coarse"] and r["plan"] == row["coarse"]["finer"] and r["within_mean"] == row["within_mean"]),
                None)


def judge_coarse(row: Row, rows: Sequence[Row], goals: CoarseGoals) -> CoarseVerdict:
    coarse, finer, missed = row["coarse"], finer_row(row, rows), []
    assert coarse
    times = rate(row) / rate(finer) if finer else None
    if coarse["relmse"] > goals.relmse:
        missed.append(f"relMSE {coarse['relmse']:.1e}, at most {goals.relmse:.0e}")
    if times is not None and times < goals.times:
        missed.append(f"{times:.2f} times the rate of {coarse['finer']}, goal {goals.times:g}")
    return CoarseVerdict(times, missed)


@dataclass(frozen=True)
class GainVerdict:
    """before: the rate of the earlier commit, queries a second; times: of it; goal: times it was to be. None where the plan has no
    such goal. golden: times golden on one core, golden_goal: what it was to be. missed: why the row fails beside what judge() finds."""
    before: float | None
    times: float | None
    goal: float | None
    golden: float
    golden_goal: float | None
    missed: list[str]


def judge_gain(row: Row, goals: GainGoals) -> GainVerdict:
    """A number of gatherers that will do instead takes the place of the times before, not of those of golden."""
    board, missed = rate(row), []
    before = times = goal = None
    if growth := goals.plans.get(row["plan"]):
        which = 1 if row["within_mean"] else 0
        before, goal, enough = 1e6 * growth.before[which], growth.times[which], growth.or_gatherers[which]
        times = board / before
        if times < goal and not 0 < enough <= row["gatherers"]:
            missed.append(f"{times:.2f} times the rate of {goals.commit}, goal {goal:g}")
    golden, golden_goal = board / row["cores"][GOLDEN]["median"], goals.golden.get(row["memory"])
    if golden_goal is not None and golden < golden_goal:
        missed.append(f"{golden:.2f} times golden on one core, goal {golden_goal:g}")
    return GainVerdict(before, times, goal, golden, golden_goal, missed)


def judge(row: Row, goals: HeadlineGoals) -> Verdict:
    board = rate(row)
    library = max((name for name in row["cores"] if name != GOLDEN), key=lambda name: row["cores"][name]["median"])
    times = board / max(row["cores"][name]["median"] for name in (GOLDEN, library))
    goal = None if row["shows"] or row["coarse"] else goals.times_core(row["memory"], row["k"])
    clocks = clocks_missed(row)
    bound, by = own_bound(row)
    missed = [f"{times:.2f} times one core, goal {goal:g}"] if goal is not None and times < goal else []
    missed += clocks
    if (load := row["sdram"]) and load["reorder_gain"] < load["reorder_goal"]:
        missed.append(f"reordering gains {load['reorder_gain']:.2f}, goal {load['reorder_goal']:g}")
    verdict = Verdict(board, library, times, goal, clocks, bound, by, board / bound,
                      goals.share[by] if load and not row["coarse"] else None, part_bounds(row), missed)
    if not verdict.share_reached:
        missed.append(f"{100 * verdict.share:.0f} % of the bound by the {by}, goal {100 * (verdict.share_goal or 0):.0f} %")
    return verdict
