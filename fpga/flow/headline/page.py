# SPDX-License-Identifier: Apache-2.0
"""What is written of the headline's rows."""
from collections.abc import Sequence

from flow.headline.link import Link
from flow.headline.rows import Row
from flow.tables import markdown

COLUMNS = ["plan", "k", "radius", "gatherers", "Fmax, MHz", "cycles/gather, all", "board, Mquery/s",
           "best library, one core", "golden, one core", "times library", "times golden", "goal",
           "bound, Mquery/s, reached", "of the gatherers' bound", "of the SDRAM's roofline",
           "reordering gains", "binding resource of the top", "over the UART, kquery/s"]


def against(text: str, goal: str, met: bool) -> str:
    """A cell: what is reached beside its goal."""
    return f"{text} (goal {goal})" + ("" if met else " **missed**")


def radius_of(row: Row, without: str) -> str:
    return "mean r²" if row["radius"] else without


def memory_cells(r: Row) -> list[str]:
    """Share of the gatherers' bound, of the SDRAM's roofline, and what reordering gains."""
    s = r["simulated"]
    gatherers = f"{100 * s['of_gatherers']:.0f} %"
    if s["memory"] != "sdram":
        return [gatherers, "–", "–"]
    # Where the SDRAM's roofline is out of the gatherers' reach, their bound has the goal.
    by_gatherers = s["bound_by_gatherers"]
    roofline = against(f"{100 * s['of_roofline']:.0f} %", f"{100 * s['roofline_goal']:.0f} %", s["roofline_met"] or by_gatherers)
    if by_gatherers:
        roofline += ", bound by the gatherers"
        gatherers = against(gatherers, f"{100 * s['gatherers_goal']:.0f} %", s["roofline_met"])
    return [gatherers, roofline,
            against(f"{r['reorder_gain']:.1f}", f"{r['reorder_goal']:g}", r["reorder_gain"] >= r["reorder_goal"])]


def table(rows: Sequence[Row]) -> str:
    out = []
    for r in rows:
        b, seeds = r["binding"], ", ".join(map(str, r["seeds"]))
        out.append([r["plan"], r["k"], radius_of(r, "none"), r["gatherers"],
                    f"{r['fmax_mhz']:.1f} ({'seed' if len(r['seeds']) == 1 else 'seeds'} {seeds})",
                    f"{r['cycles_per_gather']:.2f}", f"{r['board'] / 1e6:.2f}",
                    f"{r['library_rate'] / 1e6:.2f} ({r['library']})", f"{r['golden_rate'] / 1e6:.2f}",
                    f"{r['board'] / r['library_rate']:.1f}", f"{r['board'] / r['golden_rate']:.1f}",
                    f"{r['goal']:g}{'' if r['times_met'] else ' **missed**'}",
                    f"{r['bound'] / 1e6:.2f} ({r['bound_by']}), {100 * r['of_bound']:.0f} %", *memory_cells(r),
                    f"{b['resource']} {b['used']:,} of {b['of']:,}", f"{r['uart'] / 1e3:.1f}"])
    return markdown(out, COLUMNS)


def arithmetic(rows: Sequence[Row]) -> str:
    """How each bound comes about."""
    lines = []
    for r in rows:
        s = r["simulated"]
        text = (f"- `{r['plan']}`, {radius_of(r, 'no radius')}: {s['nodes']:.1f} nodes, {s['leaves']:.1f} leaves, "
                f"{s['insertions']:.1f} insertions a query: {s['bound']:.1f} cycles of a gatherer; {r['gatherers']} x "
                f"{r['fmax_mhz']:.1f} MHz: {r['gatherers'] * r['fmax_mhz'] / s['bound']:.2f} Mquery/s.")
        if s["roofline_cycles"]:
            text += (f" SDRAM: {s['memory_lines_per_gather']:.3f} lines a query * {s['line_bytes'] // 2} cycles of "
                     f"{s['sdram_mhz']:g} MHz, {s['row_changes_per_gather']:.3f} row changes * "
                     f"{s['row_change_cycles']:g}, refreshes apart: {r['fmax_mhz'] / s['roofline_cycles']:.2f} Mquery/s. "
                     f"Cycles of the core: {s['roofline_verdict']}.")
        if r["reorder_gain"]:
            text += f" Reordering gains {r['reorder_gain']:.1f} times."
        lines.append(text)
    return "\n".join(lines) + "\n"


def report(rows: Sequence[Row], link: Link) -> str:
    """report.md, and what docs/headline.md takes."""
    return ("Simulated cycles times routed frequency; not run on a board. The goal is against the faster of the two cores.\n\n" +
            table(rows) + "\nBounds:\n\n" + arithmetic(rows) +
            f"\nUART: {link.baud:.0f} baud, {link.down:.1f} bytes a query down, {link.up:.1f} up.\n")
