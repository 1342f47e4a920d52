# SPDX-License-Identifier: Apache-2.0
"""A plan's board beside one core, without a radius and within one, and which goals it misses."""
from typing import Any

from flow.goals import HeadlineGoals
from flow.headline.tops import Bench
from flow.results import Entry
from flow.shell import Failure, read_json, run, say

Row = dict[str, Any]


def time_core(name: str, rows: list[Row], bench: Bench) -> list[Row]:
    """Queries a second of each CPU library and of golden, on the photons and queries of the simulation, in its order."""
    radius = next(r["r2_max"] for r in rows if r["r2_max"])
    timed = bench.file(name, ".core.json")
    say(f"times one core on {name}")
    run([str(bench.core), str(timed), "--cloud", str(bench.file(name, ".photons")), str(bench.file(name, ".queries")),
         str(rows[0]["k"]), str(radius)], log=bench.file(name, ".core.log"))
    cores: list[Row] = read_json(timed)
    return cores


def measure(name: str, bench: Bench, goals: HeadlineGoals, routed: Entry, rows: list[Row]) -> list[Row]:
    """Rows of one plan: without a radius and within one."""
    def simulated(order: str, core: Row) -> Row | None:
        return next((r for r in rows if r["order"] == order and r["r2_max"] == core["r2_max"]), None)

    out = []
    for core in time_core(name, rows, bench):
        own = simulated("reordered", core)
        if not own:
            raise Failure(f"{name}: the simulation has no reordered row with r2_max {core['r2_max']}")
        out.append(row_of(name, goals, routed, core["queries_per_second"], own, simulated("pixels", core)))
    return out


def bounds_of(own: Row, fmax: float) -> dict[str, float]:
    """Queries a second that the search itself allows: every gatherer's busiest port at work in every cycle. From SDRAM also
    what its data pins allow."""
    bounds = {"gatherers": 1e6 * fmax * own["gatherers"] / own["bound"]}
    if own["roofline_cycles"]:
        bounds["SDRAM"] = 1e6 * fmax / own["roofline_cycles"]
    return bounds


def row_of(name: str, goals: HeadlineGoals, routed: Entry, rates: dict[str, float], own: Row, plain: Row | None) -> Row:
    """One row. rates: of one core; own: simulated in the reordered order; plain: in that of the pixels, from SDRAM."""
    fmax = routed["fmax_mhz"]["median"]
    golden = rates["photonloom"]
    library, best = max(((n, r) for n, r in rates.items() if n != "photonloom"), key=lambda x: x[1])
    board = 1e6 * fmax / own["cycles_per_gather"]
    bounds = bounds_of(own, fmax)
    limit = min(bounds, key=lambda b: bounds[b])  # the lower roof
    goal = goals.times_core(own["memory"], own["k"])
    times, of_bound, bound_times = (board / max(golden, best), board / bounds[limit], bounds[limit] / max(golden, best))
    times_met = times >= goal or (bound_times < goal and of_bound >= goals.of_bound)
    missed = []
    if not times_met:
        missed.append(f"{times:.2f} times one core, goal {goal:g}; {100 * of_bound:.0f} % of the bound")
    if own["roofline_met"] is False:
        missed.append(own["roofline_verdict"])
    if plain and plain["reorder_gain"] < plain["reorder_goal"]:
        missed.append(f"reordering gains {plain['reorder_gain']:.2f}, goal {plain['reorder_goal']:g}")
    return {"plan": name, "memory": own["memory"], "k": own["k"], "radius": own["r2_max"],
            "gatherers": own["gatherers"], "fmax_mhz": fmax, "seeds": [s["seed"] for s in routed["seeds"]],
            "cycles_per_gather": own["cycles_per_gather"],
            "board": board, "library": library, "library_rate": best, "golden_rate": golden,
            "times_core": times, "goal": goal, "bound": bounds[limit], "bound_by": limit,
            "bound_times_core": bound_times, "of_bound": of_bound,
            "binding": routed["binding"], "simulated": own,
            "reorder_gain": plain["reorder_gain"] if plain else None,
            "reorder_goal": plain["reorder_goal"] if plain else None,
            "times_met": times_met, "missed": missed}
