# SPDX-License-Identifier: Apache-2.0
"""The rows of a plan, without a radius and within one: what was routed, simulated and timed, put together."""
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from flow.boards import LUT_EQ, Board
from flow.headline.data import Coarse, Row, SdramLoad
from flow.headline.formats import formats_relmse
from flow.headline.plans import HeadlinePlan
from flow.headline.simulation import Simulated, Timed
from flow.headline.tops import Top
from flow.package import PlanFacts, describe
from flow.results import Entry
from flow.shell import Failure, field, read_toml

BLOCK_RAM = "DP16KD"
# photonloom's name of any other resource that a gatherer takes -> the part's.
RESOURCES = {"lut": "LUT4", "dsp": "MULT18X18D"}


def gatherers_that_fit(facts: PlanFacts, board: Board) -> dict[str, int]:
    """Resource of the part -> gatherers that it has room for beside what a top has once, as photonloom predicts both: of
    block RAM all memories of the top, of the others the reorder buffer alone. So it is rather too many than too few."""
    each, once = facts["resources"]["photon_gatherer"], facts["resources"].get("reorder_buffer", {})
    totals = enumerate(facts["board_ebr_of_gatherers"], 1)
    most = max((gatherers for gatherers, total in totals if total <= board.resources[BLOCK_RAM]), default=0)
    return {BLOCK_RAM: most, **{part: (board.resources[part] - once.get(name, 0)) // each[name] for name, part in RESOURCES.items()}}


def sdram_load(own: Mapping[str, Any], plain: Mapping[str, Any] | None) -> SdramLoad | None:
    """plain: the same queries as they come, without the reorder buffer."""
    if own["memory"] != "sdram":
        return None
    if not plain:
        raise Failure(f"{own['plan']}: the simulation has no row of r2_max {own['r2_max']} in the pixels' order")
    return {"lines": own["memory_lines_per_gather"], "line_bytes": own["line_bytes"],
            "row_changes": own["row_changes_per_gather"], "row_change_cycles": own["row_change_cycles"],
            "cycles": own["roofline_cycles"], "mhz": own["sdram_mhz"], "reorder_gain": plain["reorder_gain"], "reorder_goal": plain["reorder_goal"]}


def photon_bytes(plan: HeadlinePlan) -> int:
    count: int = field(read_toml(plan.path), plan.path, "photon.photon_bytes", int, "a number of bytes")
    return count


def coarse_of(plan: HeadlinePlan, finer: HeadlinePlan, scene: Path, folder: Path) -> Coarse:
    """What the formats of a plan cost, and those of the plan that it is coarser than."""
    return {"finer": finer.name, "photon_bytes": photon_bytes(plan), "relmse": formats_relmse(plan.path, scene, folder),
            "finer_bytes": photon_bytes(finer), "finer_relmse": formats_relmse(finer.path, scene, folder)}


def rows_of(plan: HeadlinePlan, top: Top, entry: Entry, simulated: Simulated, cores: Mapping[int | None, Timed],
            versions: Mapping[str, str], processor: str, board: Board, coarse: Coarse | None = None) -> list[Row]:
    """The rows of one plan."""
    def simulated_row(order: str, radius: int | None) -> dict[str, Any] | None:
        return next((r for r in simulated.rows if r["order"] == order and r["r2_max"] == radius), None)

    replay = field(read_toml(plan.path), plan.path, "board.replay_queries", int, "a number of queries")
    out: list[Row] = []
    for radius, timed in cores.items():
        own = simulated_row("reordered", radius)
        if not own:
            raise Failure(f"{plan.name}: the simulation has no reordered row with r2_max {radius}")
        row: Row = {"plan": plan.name, "rejected": plan.rejected, "shows": plan.shows, "coarse": coarse,
                    "leaf_limit": timed.leaf_limit,
                    "recall": timed.recall, "lut_eq": entry["resources"][LUT_EQ], "all_cores": timed.all_cores,
                    "memory": own["memory"], "k": own["k"],
                    "within_mean": radius is not None, "gatherers": own["gatherers"], "replay_queries": replay, "digest": top.digest,
                    "clock_mhz": top.clock_mhz, "versions": list(versions.values()), "processor": processor,
                    "seeds": [s["seed"] for s in entry["seeds"]], "fmax_mhz": entry["fmax_mhz"], "clocks": entry["clocks"],
                    "binding": entry["binding"], "fits": gatherers_that_fit(describe(plan.path), board),
                    "cycles_per_gather": own["cycles_per_gather"],
                    "cost": {"nodes": own["nodes"], "leaves": own["leaves"], "insertions": own["insertions"],
                             "bound": own["bound"]},
                    "ports_cycles": own["ports_cycles"], "sdram": sdram_load(own, simulated_row("pixels", radius)), "cores": timed.one, "uart": top.rate}
        if unrouted := entry.get("unrouted"):
            row["unrouted"] = unrouted
        out.append(row)
    return out
