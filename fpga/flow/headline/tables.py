# SPDX-License-Identifier: Apache-2.0
"""The tables of docs/headline.md, and their cells."""
from collections.abc import Sequence
from pathlib import Path

from flow.goals import CoarseGoals, GainGoals
from flow.headline.data import GOLDEN, FrameTime, ImageTime, Rate, Row, Seconds
from flow.headline.netlist import SHORT
from flow.headline.verdict import (Verdict, board_for_size, cycles_without_row_changes, finer_row, judge_coarse, judge_gain,
                                   rate)
from flow.results import Spread, clock_name, core_clocks
from flow.shell import ROOT, field, read_toml
from flow.tables import markdown

PREDECESSORS = ROOT / "fpga" / "predecessors.toml"
PARTS = {"DP16KD": "block RAM", "LUT4": "LUTs", "MULT18X18D": "multipliers"}
Judged = Sequence[tuple[Row, Verdict]]

GOAL_COLUMNS = ["plan", "k", "radius", "board, Mquery/s", "best library, one core", "golden, one core", "times library",
                "times golden", "goal", "goal reached"]
BOUND_COLUMNS = ["plan", "radius", "cycles a gather, all gatherers", "own bound, Mquery/s", "share of this design's own bound",
                 "by gatherers", "by the photon memory's ports", "by SDRAM, with row changes", "by SDRAM, without", "the part's bound, Mquery/s",
                 "reordering gains"]
SIZE_COLUMNS = ["plan", "radius", "board, Mquery/s", "golden, all cores, Mquery/s", "threads", "times golden, all cores",
                "LUT-equivalents of the top", "gathers a second for 1,000 of them"]
VARIANT_COLUMNS = ["plan", "k", "radius", "leaves at most", "recall", "board, Mquery/s", "best library, one core, exact",
                   "golden, one core, the same search", "golden, all cores", "times library", "times golden",
                   "gathers a second for 1,000 LUT-equivalents"]
PREDECESSOR_COLUMNS = {"source": "source", "does": "what it does", "figure": "its figure", "against": "measured against",
                       "exact": "exact"}
IMAGE_COLUMNS = ["scene", "gathers", "golden, one core, s", "of these gathers", "golden, all cores, s", "of these gathers",
                 "gathers of the board, s", "host on one core and board, s", "host on all cores and board, s",
                 "queries over the link, s", "host on all cores, link and board, s"]
TOP_COLUMNS = ["plan", "gatherers", "core's clock, MHz", "other clocks, MHz", "numbers of its seeds", "netlist", "over the UART, kquery/s",
               "fullest resource of the top"]


def radius_of(row: Row, without: str) -> str:
    return "mean r²" if row["within_mean"] else without


def mega(rate: float) -> str:
    return f"{rate / 1e6:.2f}"


def rate_cell(rate: Rate) -> str:
    """The median, and least and most where they were recorded."""
    if rate["least"] is None or rate["most"] is None:
        return mega(rate["median"])
    return f"{mega(rate['median'])} ({mega(rate['least'])} – {mega(rate['most'])})"


def times_cell(board: float, rate: Rate) -> str:
    """Times a core by its median; the ends come from its most and its least."""
    text = f"{board / rate['median']:.2f}"
    if rate["least"] is None or rate["most"] is None:
        return text
    return f"{text} ({board / rate['most']:.2f} – {board / rate['least']:.2f})"


def size_cell(row: Row, v: Verdict) -> str:
    rate = board_for_size(row, v)
    return "–" if rate is None else f"{rate:,.0f}"


def clock_cell(clock: Spread, seeds: int) -> str:
    return f"{clock['median']:.1f}" + (f" ({clock['low']:.1f} – {clock['high']:.1f})" if seeds > 1 else "")


def core_cell(row: Row) -> str:
    """The core's clock beside what it was asked for; the constraint is that in whole picoseconds."""
    clocks = row["clocks"] or {}
    asked = min((clocks[net]["constraint"] for net in core_clocks(clocks, row["clock_mhz"])), default=row["clock_mhz"])
    return (f"{clock_cell(row['fmax_mhz'], len(row['seeds']))} of {row['clock_mhz']:g}" +
            (" **missed**" if row["fmax_mhz"]["median"] < asked else ""))


def sdram_clock_unknown(row: Row) -> bool:
    return row["memory"] == "sdram" and row["clocks"] is None


def other_clocks(row: Row) -> str:
    """Every clock but the core's beside its constraint."""
    if row["clocks"] is None:
        return "not recorded" if sdram_clock_unknown(row) else "–"
    core = core_clocks(row["clocks"], row["clock_mhz"])
    cells = [f"{clock_name(net)} {clock_cell(c, len(row['seeds']))} of {c['constraint']:g}" +
             (" **missed**" if c["median"] < c["constraint"] else "")
             for net, c in row["clocks"].items() if net not in core]
    return ", ".join(cells) or "–"


def goal_cell(row: Row, v: Verdict) -> str:
    """yes, or no with the figure that misses."""
    if v.goal is None:
        return "none" if v.reached else f"none, **missed**: {'; '.join(v.missed_clocks)}"
    if v.reached:
        return "yes, the SDRAM's clock not recorded" if sdram_clock_unknown(row) else "yes"
    misses = [f"{v.times:.2f} of {v.goal:g}"] if v.times < v.goal else []
    return f"no, **missed**: {'; '.join(misses + v.missed_clocks)}"


def goal_table(judged: Judged) -> str:
    return markdown([[r["plan"], r["k"], radius_of(r, "none"), mega(v.board),
                      f"{rate_cell(r['cores'][v.library])} {v.library}", rate_cell(r["cores"][GOLDEN]),
                      times_cell(v.board, r["cores"][v.library]), times_cell(v.board, r["cores"][GOLDEN]),
                      "–" if v.goal is None else f"{v.goal:g}", goal_cell(r, v)] for r, v in judged], GOAL_COLUMNS)


def gain_table(judged: Judged, goals: GainGoals) -> str:
    """Rates beside those of an earlier commit, and beside golden."""
    lines = []
    for r, v in judged:
        gain = judge_gain(r, goals)
        instead = gain.times is not None and gain.goal is not None and gain.times < gain.goal
        missed = [*gain.missed, *v.missed_clocks]
        reached = "no, **MISSED**: " + "; ".join(missed) if missed else f"yes: {r['gatherers']} gatherers" if instead else "yes"
        lines.append([r["plan"], radius_of(r, "none"), mega(v.board), mega(gain.before) if gain.before else "–",
                      f"{gain.times:.2f}" if gain.times else "–", f"{gain.goal:g}" if gain.goal else "–", f"{gain.golden:.2f}",
                      f"{gain.golden_goal:g}" if gain.golden_goal else "–", reached])
    return markdown(lines, ["plan", "radius", "board, Mquery/s", f"at {goals.commit}", "times", "goal", "times golden, one core", "goal",
                            "goals reached"])


def size_table(judged: Judged) -> str:
    """The whole machine beside a board, and what a board does for its size."""
    rows = []
    for r, v in judged:
        cores = r["all_cores"]
        rows.append([r["plan"], radius_of(r, "none"), mega(v.board), rate_cell(cores["rate"]) if cores else "–",
                     cores["threads"] if cores else "–", times_cell(v.board, cores["rate"]) if cores else "–",
                     f"{r['lut_eq']:,}" if r["lut_eq"] else "–", size_cell(r, v)])
    return markdown(rows, SIZE_COLUMNS)


def recall_cell(row: Row) -> str:
    return "–" if row["recall"] is None else f"{row['recall']:.4f}"


def variant_table(judged: Judged) -> str:
    rows = []
    for r, v in judged:
        cores = r["all_cores"]
        rows.append([r["plan"], r["k"], radius_of(r, "none"), r["leaf_limit"] or "no limit", recall_cell(r), mega(v.board),
                     f"{rate_cell(r['cores'][v.library])} {v.library}", rate_cell(r["cores"][GOLDEN]),
                     f"{rate_cell(cores['rate'])}, {cores['threads']} threads" if cores else "–",
                     times_cell(v.board, r["cores"][v.library]), times_cell(v.board, r["cores"][GOLDEN]), size_cell(r, v)])
    return markdown(rows, VARIANT_COLUMNS)


def coarse_table(judged: Judged, rows: Sequence[Row], goals: CoarseGoals) -> str:
    lines = []
    for r, v in judged:
        c, beside, finer = r["coarse"], judge_coarse(r, rows, goals), finer_row(r, rows)
        assert c
        missed = [*beside.missed, *v.missed]
        reached = "no, **missed**: " + "; ".join(missed) if missed else "yes" if beside.times else "–"
        lines.append([r["plan"], radius_of(r, "none"), f"{c['photon_bytes']} ({c['finer_bytes']})",
                      f"{c['relmse']:.1e} ({c['finer_relmse']:.1e})", mega(v.board) + (f" ({mega(rate(finer))})" if finer else ""),
                      f"{beside.times:.2f}" if beside.times else "–", f"{goals.times:g}", reached])
    return markdown(lines, ["plan", "radius", "bytes a photon", "relMSE of the formats", "board, Mquery/s", "times", "goal", "goal reached"])


def predecessors_table(path: Path = PREDECESSORS) -> str:
    """What others published, and what they measured it against."""
    said = read_toml(path)
    entries: list[dict[str, str]] = field(said, path, "predecessor", list, "a list of tables")
    rows = [[field(entry, path, name, str, "a text") for name in PREDECESSOR_COLUMNS] for entry in entries]
    return markdown(rows, list(PREDECESSOR_COLUMNS.values()))


def seconds_cell(seconds: Seconds) -> str:
    return f"{seconds['median']:.2f} ({seconds['least']:.2f} – {seconds['most']:.2f})"


def image_cells(image: ImageTime, row: Row, v: Verdict) -> list[str]:
    """Golden's frame, then a board in the place of its gathers; nothing overlaps, but the link and the board's work on it."""
    def golden(time: FrameTime) -> list[str]:
        return [seconds_cell(time["frame"]), seconds_cell(time["gathers"])]

    def with_board(host: Seconds, board: float) -> str:
        return seconds_cell({"least": host["least"] + board, "median": host["median"] + board, "most": host["most"] + board})

    engine, link = image["queries"] / v.board, image["queries"] / row["uart"]
    hosts = image["one"]["host"], image["all"]["host"]
    return [image["scene"], f"{image['queries']:,}", *golden(image["one"]), *golden(image["all"]), f"{engine:.2f}",
            with_board(hosts[0], engine), with_board(hosts[1], engine), f"{link:.0f}", with_board(hosts[1], max(link, engine))]


def unrecorded(judged: Judged) -> set[str]:
    """Plans whose rows lack what earlier forms of the data did not have."""
    return {r["plan"] for r, _ in judged if r["all_cores"] is None or r["lut_eq"] is None or r["recall"] is None}


def gain_cell(row: Row) -> str:
    load = row["sdram"]
    if not load:
        return "–"
    return f"{load['reorder_gain']:.1f} (goal {load['reorder_goal']:g})" + (
        " **missed**" if load["reorder_gain"] < load["reorder_goal"] else "")


def share_cell(v: Verdict) -> str:
    if v.share_goal is None:
        return f"{100 * v.share:.0f} %"
    goal = f" (goal {100 * v.share_goal:.0f} %)" + ("" if v.share_reached else " **MISSED**")
    # One that is missed is not rounded up to its goal.
    return f"{100 * v.share:.{0 if v.share_reached or round(100 * v.share) < round(100 * v.share_goal) else 1}f} %{goal}"


def bound_table(judged: Judged) -> str:
    rows = []
    for r, v in judged:
        mhz, load = 1e6 * r["fmax_mhz"]["median"], r["sdram"]
        rows.append([r["plan"], radius_of(r, "none"), f"{r['cycles_per_gather']:.2f}", f"{mega(v.bound)} ({v.bound_by})",
                     share_cell(v), mega(mhz * r["gatherers"] / r["cost"]["bound"]),
                     mega(mhz / r["ports_cycles"]) if r["ports_cycles"] else "–",
                     mega(mhz / load["cycles"]) if load else "–",
                     mega(mhz / cycles_without_row_changes(load)) if load else "–",
                     f"{mega(v.part[v.part_by])} ({PARTS.get(v.part_by, v.part_by)})", gain_cell(r)])
    return markdown(rows, BOUND_COLUMNS)


def part_table(judged: Judged) -> str:
    """What each resource of the part would allow."""
    names = list(dict.fromkeys(name for _, v in judged for name in v.part))

    def cell(row: Row, v: Verdict, name: str) -> str:
        if name not in v.part:
            return "–"
        return mega(v.part[name]) + (f" ({row['fits'][name]})" if name in row["fits"] else "")

    return markdown([[r["plan"], radius_of(r, "none")] + [cell(r, v, name) for name in names] for r, v in judged],
                    ["plan", "radius"] + [PARTS.get(name, name) for name in names])


def seeds_cell(row: Row) -> str:
    without_end = ", ".join(map(str, row.get("unrouted", [])))
    return ", ".join(map(str, row["seeds"])) + (f"; not routed: {without_end}" if without_end else "")


def top_table(judged: Judged) -> str:
    """One line a plan."""
    tops = {r["plan"]: r for r, _ in judged}
    return markdown([[r["plan"], r["gatherers"], core_cell(r), other_clocks(r),
                      seeds_cell(r), f"`{r['digest'][:SHORT]}`", f"{r['uart'] / 1e3:.1f}",
                      f"{r['binding']['resource']} {r['binding']['used']:,} of {r['binding']['of']:,}"]
                     for r in tops.values()], TOP_COLUMNS)
