# SPDX-License-Identifier: Apache-2.0
"""What is written of the headline's rows: docs/headline.md between its marks, from fpga/headline.json and fpga/goals.toml."""
import math
import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from pathlib import Path

from flow.goals import CoarseGoals, GainGoals, HeadlineGoals
from flow.headline.data import Data, ImageTime, Link, Replay, Row, of_headline
from flow.headline.netlist import SHORT
from flow.headline.plans import base_of, changes_of, coarse_names, rejected_names, variant_names, what_shows, why_rejected
from flow.headline.tables import (IMAGE_COLUMNS, Judged, bound_table, coarse_table, gain_table, goal_table, image_cells, mega, part_table,
                                  predecessors_table, radius_of, sdram_clock_unknown, size_table, top_table, unrecorded, variant_table)
from flow.headline.verdict import judge, judge_gain, slower_than_golden
from flow.shell import ROOT, Failure, read_text
from flow.tables import between, markdown, replace_between

PAGE = ROOT / "docs" / "headline.md"
STALE, STALE_PLAN = "Routed with earlier RTL: ", re.compile(r"`(\w+)`")


def share_text(judged: Judged) -> str:
    """What golden had of the machine while all of its cores were timed."""
    shares = [r["all_cores"]["share"] for r, _ in judged if r["all_cores"]]
    if not shares:
        return "Golden on all cores was not timed for any row.\n"
    return (f"All cores are timed by the clock on the wall. Golden's threads had {100 * min(shares):.0f} to {100 * max(shares):.0f} % of them; "
            "other programs had the rest.\n")


def variants_text(judged: Judged, above: Judged = (), whole: bool = True) -> str:
    """Rows of what published accelerators search for. above: the headline's; whole: plans that were not measured are named too."""
    parts = ["Published accelerators mostly find one nearest neighbour or search approximately; the rows above are exact. k and the leaf "
             "limit are constants of a generated package, no registers, so each of these is a top of its own, routed for itself. Recall is "
             "the part of the exact k nearest that golden, with this row's search, finds among the row's own photons and queries; "
             "the libraries are exact in every row. Back sides are not told apart in it.\n"]
    for name in variant_names():
        if whole or name in measured(judged):
            parts.append(f"`{name}`: {what_shows(name)}" +
                         (".\n" if name in measured(judged) else f"; not measured, `make headline PLAN={name} HEADLINE_FLAGS=--page` does.\n"))
    if judged:
        parts += [made_on(judged, above), variant_table(judged), top_table(judged)]
    return "\n".join(parts)


def coarse_text(judged: Judged, rows: Sequence[Row], goals: CoarseGoals, above: Judged = (), whole: bool = True) -> str:
    """The rows in coarser formats, beside those in the plan's own; no figure of a core stands here."""
    parts = ["An SDRAM moves fewer bytes where a photon has fewer. A photon's slot is a whole number of bytes, and a line a multiple of 16. In "
             f"brackets stand the figures of the plan beside which it stands, in the default formats. The formats may cost a relMSE of at most {goals.relmse:.0e}: golden "
             "arithmetic against reference arithmetic, in the plan's frame of the headline's scene, with its k and all of its photons.\n"]
    for name in coarse_names():
        if whole or name in measured(judged):
            parts.append(f"`{name}` is `{base_of('coarse', name)}` with {', '.join(f'`{line}`' for line in changes_of('coarse', name))}" +
                         (".\n" if name in measured(judged) else f"; not measured, `make headline PLAN={name} HEADLINE_FLAGS=--page` does.\n"))
    if judged:
        parts += [*([f"Made with {tools}.\n"] if (tools := tools_of(judged)) != tools_of(above) else []),
                  coarse_table(judged, rows, goals), top_table(judged)]
    return "\n".join(parts)


def beside_its_base(name: str, judged: Judged, above: Judged) -> str:
    """How fast a rejected plan is, where the one that it was tried against was measured too."""
    base = base_of("rejected", name)
    rates = {row["within_mean"]: verdict.board for row, verdict in above if row["plan"] == base}
    times = [f"{verdict.board / rates[row['within_mean']]:.2f} ({radius_of(row, 'no radius')})" for row, verdict in judged
             if row["plan"] == name and row["within_mean"] in rates]
    return f" Its rates are {' and '.join(times)} times those of `{base}`." if times else ""


def rejected_text(judged: Judged, above: Judged, whole: bool) -> str:
    """Why plans were rejected, and their rows."""
    parts = []
    for name in rejected_names():
        if name in measured(judged):
            parts.append(f"`{name}`: {why_rejected(name)}.{beside_its_base(name, judged, above)}\n")
        elif whole:
            parts.append(f"`{name}`: not measured; `make headline PLAN={name} HEADLINE_FLAGS=--page` does.\n")
    if judged:
        parts += [made_on(judged, above), goal_table(judged), bound_table(judged), top_table(judged)]
    return "\n".join(parts)


def gain_text(judged: Judged, goals: GainGoals) -> str:
    """What the rows gained over an earlier commit."""
    instead = [f"For `{name}` within the mean r², {growth.or_gatherers[1]} gatherers or more in the routed top would do instead."
               for name, growth in goals.plans.items() if growth.or_gatherers[1] and name in measured(judged)]
    return (f"Rates on block RAM were to grow to a multiple of those of commit {goals.commit}, which are of its own page, and no row to be slower than a "
            "multiple of golden on one core. " + " ".join(instead) + "\n\n" + gain_table(judged, goals))


def images_text(images: Sequence[ImageTime], judged: Judged, goals: HeadlineGoals, link: Link) -> str:
    """Whole images, each input named."""
    if not images:
        return "Not measured; `make headline HEADLINE_FLAGS=\"--images-only --page\"` does.\n"
    row, v = next(((r, v) for r, v in judged if r["plan"] == goals.images.plan and r["within_mean"]), (None, None))
    if row is None or v is None:
        return f"Measured, but no row is of `{goals.images.plan}` within the mean r², whose rate is wanted.\n"
    first = images[0]
    threads, runs = first["all"]["threads"], first["one"]["runs"]
    busy = max(image["busy"] for image in images)
    binds = row["uart"] < v.board
    parts = [
        f"Golden renders {first['width']} x {first['height']} pixels, {first['spp']} samples of {first['gather_rays']} final gather rays, "
        f"k = {first['k']}, {first['photons']:,} photons, in the formats of `{first['plan']}`. A board would take over the gathers and the "
        "reorder buffer; rays, photons, maps, sampling and shading stay with the host. Nothing was run on a board:\n",
        f"- golden's seconds: `photonloom render --json`, medians of {runs} runs in turn with the least and the most, on {first['processor']}. "
        f"One core: CPU seconds. All cores: {threads} threads, by the clock on the wall; one thread's wall took up to {busy:.2f} times its "
        "CPU seconds meanwhile.",
        "- host: the frame without the gatherer's and the reorder buffer's calls, of the same runs; files of the image are not counted.",
        f"- gathers of the board: their number in the frame over {mega(v.board)} Mquery/s, the row of `{row['plan']}` within the mean r², "
        f"whose queries are those of `{goals.scene.stem}` whichever scene is rendered.",
        f"- the link: {row['uart'] / 1e3:.1f} thousand queries a second over the UART of {link['baud']:.0f} baud, from the bytes of its frames; the map's "
        "own bytes and the photons that make a sampler's table are not counted.",
        "- host and board take turns in this reckoning, as golden's parts do; the link and the board work at the same time.\n",
        markdown([image_cells(image, row, v) for image in images], IMAGE_COLUMNS)]
    if binds:
        parts.append(f"Over the UART the link binds: it brings a query in {1e6 / row['uart']:.0f} µs, the engine answers one in "
                     f"{1e6 / v.board:.2f} µs. The columns without it are for a link that keeps up.\n")
    return "\n".join(parts)


def busiest_port(row: Row) -> str:
    """Which part of a gatherer takes as many cycles a query as its bound says."""
    cost = row["cost"]
    for name, work, widths in (("tree", cost["nodes"], (1, 2)), ("lists", cost["insertions"], (1, 2, 4)), ("sums", row["k"] + 1, (1, 2, 4))):
        for width in widths:
            if math.isclose(cost["bound"], work / width, rel_tol=1e-6):
                return name if width == 1 else f"{name}, {width} a cycle"
    return f"lanes, {cost['bound'] / cost['leaves']:.3g} cycles a leaf"


def arithmetic(judged: Judged) -> str:
    """How each bound of the design comes about."""
    lines = []
    for r, v in judged:
        cost, fmax = r["cost"], r["fmax_mhz"]["median"]
        text = (f"- `{r['plan']}`, {radius_of(r, 'no radius')}: {cost['nodes']:.1f} nodes, {cost['leaves']:.1f} leaves, "
                f"{cost['insertions']:.1f} insertions a query: {cost['bound']:.1f} cycles of a gatherer's {busiest_port(r)}; {r['gatherers']} x "
                f"{fmax:.1f} MHz: {r['gatherers'] * fmax / cost['bound']:.2f} Mquery/s.")
        if ports := r["ports_cycles"]:
            text += f" Photon memory: {ports:.2f} cycles of its ports: {fmax / ports:.2f} Mquery/s. Bound by the {v.bound_by}."
        if load := r["sdram"]:
            text += (f" SDRAM: {load['lines']:.3f} lines a query * {load['line_bytes'] // 2} cycles of {load['mhz']:g} MHz, "
                     f"{load['row_changes']:.3f} row changes * {load['row_change_cycles']:g}, refreshes apart: "
                     f"{fmax / load['cycles']:.2f} Mquery/s. Bound by the {v.bound_by}.")
        lines.append(text)
    return "\n".join(lines) + "\n"


def told_apart(judged: Judged, what: Callable[[Row], str]) -> str:
    """What all rows have in common, or each that some have, and whose it is."""
    plans: dict[str, set[str]] = {}
    for r, _ in judged:
        plans.setdefault(what(r), set()).add(r["plan"])
    if len(plans) < 2:
        return "".join(plans)
    return "; ".join(f"{said} for {names(of)}" for said, of in plans.items())


def tools_of(judged: Judged) -> str:
    return told_apart(judged, lambda r: ", ".join(r["versions"]))


def made_on(judged: Judged, above: Judged = ()) -> str:
    """The machines on which a section's cores were timed, and its tools, unless they are those of the rows above."""
    tools = tools_of(judged)
    return f"One core of: {told_apart(judged, lambda r: r['processor'])}." + (f" {tools}." if tools != tools_of(above) else "") + "\n"


def measured(judged: Judged) -> set[str]:
    return {r["plan"] for r, _ in judged}


def names(plans: Collection[str]) -> str:
    return ", ".join(f"`{plan}`" for plan in sorted(plans))


def rows_named(rows: Sequence[Row], judged: Judged) -> str:
    """Rows by their plans; one of which not every row is here by its radius too."""
    parts = []
    for plan in sorted({r["plan"] for r in rows}):
        here = [r for r in rows if r["plan"] == plan]
        if len(here) == sum(r["plan"] == plan for r, _ in judged):
            parts.append(f"`{plan}`")
        else:
            parts += [f"`{plan}` " + ("within the mean r²" if r["within_mean"] else "without a radius") for r in here]
    return ", ".join(parts)


def judged_of(rows: Sequence[Row], goals: HeadlineGoals) -> Judged:
    return [(row, judge(row, goals)) for row in rows]


def summary(data: Data, goals: HeadlineGoals, stale: Collection[str]) -> str:
    """The first lines of the page. stale: plans whose netlist is not that of today's RTL."""
    judged = judged_of([r for r in data["rows"] if of_headline(r)], goals)
    if not judged:
        return "No row is of a plan of `fpga/headline`."
    reached = [r for r, v in judged if v.reached]
    slower = sum(slower_than_golden(r, v) for r, v in judged)
    lines = [f"**{len(reached)} of {len(judged)} rows reach their goal" + (f" ({rows_named(reached, judged)})" if reached else "") +
             f"; {slower} {'is' if slower == 1 else 'are'} slower than one core of golden.**",
             f"{sum(not judge_gain(r, goals.gain).missed and not v.missed_clocks for r, v in judged)} of {len(judged)} reach what they were to gain "
             f"over commit {goals.gain.commit} and golden (\"What was gained\")."]
    if shares := [(r, v) for r, v in judged if v.share_goal is not None]:
        missed = [r for r, v in shares if not v.share_reached]
        lines.append(f"{len(shares) - len(missed)} of {len(shares)} rows from SDRAM reach their share of their own bound" +
                     (f"; MISSED by {rows_named(missed, judged)}" if missed else "") + " (\"What bounds a row\").")
    if stale:
        lines.append(f"{STALE}{names(stale)}. Their figures are not those of the RTL beside this page; "
                     "`make headline PLAN=NAME HEADLINE_FLAGS=--page` measures a plan again.")
    if one := {r["plan"] for r in data["rows"] if len(r["seeds"]) < 3 and not r["rejected"]}:
        lines.append(f"Routed with fewer than three seeds: {names(one)}.")
    if unknown := {r["plan"] for r, _ in judged if sdram_clock_unknown(r)}:
        lines.append(f"The clock that the SDRAM's controller reached was not recorded: {names(unknown)}; "
                     "their goal is judged without it.")
    if single := {r["plan"] for r, _ in judged if any(rate["least"] is None for rate in r["cores"].values())}:
        lines.append(f"Of one core the median alone was recorded: {names(single)}.")
    if old := unrecorded(judged):
        lines.append(f"Golden on all cores, recall and the LUT-equivalents of the top were not recorded: {names(old)}.")
    if unseen := {r["plan"] for r, _ in judged if r["memory"] == "block_ram" and r["ports_cycles"] is None}:
        lines.append(f"Cycles of the photon memory's ports were not recorded: {names(unseen)}; their own bound is judged without them.")
    replayed = span(f"{r['replay_queries']:,}" for r, _ in sorted(judged, key=lambda j: j[0]["replay_queries"]))
    sent = span(f"{r['uart'] / 1e3:.1f}" for r, _ in sorted(judged, key=lambda j: j[0]["uart"]))
    lines.append("Rates are the engine's, which gets queries as fast as it takes them. A board is fed by its link, "
                 f"{sent} thousand queries a second, or by a replayer of {replayed} queries. "
                 "Cycles are simulated and clocks are routed; nothing was run on a board.")
    return "\n\n".join(lines)


def span(ascending: Iterable[str]) -> str:
    """Least to most as written, or the one figure."""
    figures = list(ascending)
    return figures[0] if figures[0] == figures[-1] else f"{figures[0]} to {figures[-1]}"


def replay_text(replay: Replay | None, judged: Judged) -> str:
    """The replay on a simulated board beside the engine's row."""
    if not replay:
        return "No replay on the verilated `board_core` was recorded.\n"
    gathers = replay["queries"] * replay["passes"]
    cycles = replay["cycles"] / gathers
    own = next((r for r, _ in judged if r["plan"] == replay["plan"] and not r["within_mean"]), None)
    text = (f"The verilated `board_core` of `{replay['plan']}` replays {replay['queries']:,} queries {replay['passes']} times, "
            f"in the order of the pixels: {cycles:.2f} cycles and {replay['lines_per_gather']:.2f} lines a gather")
    if own:
        fmax = own["fmax_mhz"]["median"]
        text += (f", {fmax / cycles:.2f} Mquery/s at its {fmax:.1f} MHz. The engine's row has {own['cycles_per_gather']:.2f} "
                 "cycles, on a whole frame")
    if own and own["digest"] != replay["digest"]:
        text += f". The replay is of netlist `{replay['digest'][:SHORT]}`, the row's is another"
    return text + ".\n"


def report(data: Data, goals: HeadlineGoals, whole: bool = False) -> str:
    """Everything below the first lines. whole: of the page, which says what was not measured; else of one run, and of its rows alone."""
    judged = judged_of([r for r in data["rows"] if of_headline(r)], goals)
    variants = judged_of([r for r in data["rows"] if r["shows"]], goals)
    rejected = judged_of([r for r in data["rows"] if r["rejected"]], goals)
    coarse = judged_of([r for r in data["rows"] if r["coarse"]], goals)
    link, parts = data["link"], []
    if judged:
        parts.append(made_on(judged))
        if len({r["processor"] for r in data["rows"]}) > 1:
            parts.append("Multiples of one processor's core cannot be set against those of another's, here and below; the boards' rates can.\n")
        parts += [goal_table(judged), "## What was gained\n", gain_text(judged, goals.gain), "## All cores, and for its size\n", size_table(judged),
                  share_text(judged)]
    if variants or whole:
        parts += ["## One neighbour, and few leaves\n", variants_text(variants, judged, whole)]
    if coarse or whole:
        parts += ["## Fewer bytes a photon\n", coarse_text(coarse, data["rows"], goals.coarse, judged, whole)]
    if whole:
        parts += ["## Others' figures\n",
                  "Multiples below are of what stands beside them, so none can be set against another or against ours. Each is from an abstract, "
                  "a catalogue or a vendor's page; none of the hardware is open.\n", predecessors_table()]
    if data["replay"] or whole:
        parts += ["## A board's replayer\n", replay_text(data["replay"], judged)]
    if judged:
        parts += ["## What bounds a row\n", bound_table(judged), "The part's bounds, Mquery/s, and how many gatherers each resource has room for:\n",
                  part_table(judged), "## Tops\n", top_table(judged)]
    if rejected or whole:
        parts += ["## Rejected plans\n", rejected_text(rejected, judged, whole)]
    parts += ["## Arithmetic of the bounds\n", arithmetic([*judged, *variants, *coarse, *rejected]),
              f"UART: {link['baud']:.0f} baud; {link['down']:.1f} bytes a query down and {link['up']:.1f} up, of the tops of "
              f"{link['baud'] / 1e4 / max(link['down'], link['up']):.1f} kquery/s.\n"]
    return "\n" + "\n".join(parts) + "\n"


def images_of(data: Data, goals: HeadlineGoals) -> str:
    """The end of the page."""
    judged = judged_of([r for r in data["rows"] if of_headline(r)], goals)
    return "\n" + images_text(data["images"], judged, goals, data["link"]) + "\n"


def page_texts(data: Data, goals: HeadlineGoals, stale: Collection[str]) -> dict[str, str]:
    """Mark of the page -> what stands there."""
    return {"summary": summary(data, goals, stale) + "\n", "report": report(data, goals, whole=True), "images": images_of(data, goals)}


def write_page(texts: Mapping[str, str], page: Path = PAGE) -> None:
    for mark, text in texts.items():
        replace_between(page, mark, text)


def said_stale(text: str) -> set[str]:
    """The plans that a page's first lines call routed with earlier RTL."""
    line = next((line for line in text.splitlines() if line.startswith(STALE)), "")
    return set(STALE_PLAN.findall(line.split(". ")[0]))


def check_page(data: Data, goals: HeadlineGoals, today: dict[str, str], page: Path = PAGE) -> None:
    """Fails where the page is not that of the data, or hides that a row was routed with other RTL than today's. today:
    plan -> digest of its netlist."""
    text, stale = read_text(page), stale_plans(data, today)
    for row in data["rows"]:
        if row["plan"] in stale - said_stale(text):
            raise Failure(f"{page.name}: row {row['plan']} was routed with earlier RTL (netlist {row['digest'][:SHORT]}, today's "
                          f"is {today[row['plan']][:SHORT]}), and the first lines do not say so; make headline "
                          f"PLAN={row['plan']} HEADLINE_FLAGS=--page measures it again, scripts/headline --render marks it")
    if any(between(page, mark) != expected for mark, expected in page_texts(data, goals, stale).items()):
        raise Failure(f"{page.name}: is not what fpga/headline.json and fpga/goals.toml give; scripts/headline --render "
                      "writes it")


def stale_plans(data: Data, today: dict[str, str]) -> set[str]:
    return {row["plan"] for row in data["rows"] if row["digest"] != today[row["plan"]]}
