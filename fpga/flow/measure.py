# SPDX-License-Identifier: Apache-2.0
"""From a plan to resources, Fmax and bitstreams: synthesis and place-and-route of each unit out of context and of the
board's whole top, with several seeds. Writes build/fpga/BOARD-PLANHASH/report.json and report.md; exit status 1 where a
median misses the clock that it is constrained to. Of an Artix-7 clocks are the tool's estimate, which is not judged."""
import argparse
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from flow.arguments import LAST_SEED, check_names, megahertz, refuse_idle, whole
from flow.boards import BOARDS, FAMILIES, Board, UnknownBoard, board_names, read_board
from flow.headline.netlist import netlist_digest
from flow.measured_pages import README, README_BOARD, parts_of, render, section
from flow.package import UNITS, PackageFacts, describe, digest, generate, lock_of
from flow.results import Entry, Report, add_placements, clock_name, core_clock, entries_of, missed, missed_clocks, report_folder
from flow.routing import DEFAULT_PLACER, PLACERS, NoEnd, place, placements
from flow.shell import ROOT, Failure, UsageError, locked, read_toml, say, warn, write_json
from flow.synthesis import binding, synthesise
from flow.tables import around, markdown, replace_between
from flow.tools import Tools, find_tools

PARTS = UNITS + ["board"]


@dataclass(frozen=True)
class Options:
    """How each part is measured. placers: of nextpnr; of several the one by which a part is faster."""
    plan: Path
    board: Board
    seeds: Sequence[int]
    clock: float | None
    route_speed: int | None
    placers: Sequence[str]
    synthesis_only: bool
    tools_only: bool
    dry_run: bool
    pages_only: str | None = None  # check or render


def package(o: Options, where: Path, versions: dict[str, str]) -> tuple[PackageFacts, str]:
    """Writes the package of a unit or of the board, by the name of its folder: (what package.json says, its digest)."""
    whole = where.name == "board"
    said = generate(o.plan, where, o.board, None if whole else where.name, o.clock if whole else None, versions)
    return said, digest(where, versions)


def measure(o: Options, folder: Path, name: str, tools: Tools) -> Entry:
    """One package through the flow: its entry of the report."""
    where = folder / name
    with locked(lock_of(where)):
        return measure_in(o, where, tools)


def digest_now(o: Options, folder: Path, name: str, tools: Tools) -> str:
    """The digest of today's package, which another command may be placing."""
    with locked(lock_of(folder / name)):
        return package(o, folder / name, tools.versions)[1]


def measure_in(o: Options, where: Path, tools: Tools) -> Entry:
    said, of_sources = package(o, where, tools.versions)
    name = where.name
    top = o.board.top(None if name == "board" else name)
    say(f"{name}: synthesis")
    counts = synthesise(where, o.board, top, top if name == "board" else name, tools)
    entry: Entry = {"name": name, "digest": of_sources, "top": top, "constraint_mhz": said["clock_khz"] / 1000,
                    "resources": counts, "binding": binding(counts, o.board), "seeds": []}
    if o.board.family.estimated:
        entry["estimated"] = True
    if o.synthesis_only:
        return entry
    if o.route_speed:
        entry["route_speed"] = o.route_speed
    full = entry["binding"]
    if full["used"] > full["of"]:  # nextpnr would look for places without end
        raise Failure(f"{o.plan}: its {name} needs {full['used']} {full['resource']}, the part has {full['of']}")
    placed: dict[str, Entry | None] = {placer: routed(entry, o, where, tools, placer) for placer in o.placers}
    return fastest(placed, name)


def routed(unplaced: Entry, o: Options, where: Path, tools: Tools, placer: str) -> Entry | None:
    """The entry with what the seeds give by one placer. None where nextpnr does not end by it and there are others."""
    entry = unplaced.copy()
    if placer != DEFAULT_PLACER:
        entry["placer"] = placer
    alone = len(o.placers) == 1
    try:
        placed = placements(entry["name"], o.seeds, placer, lambda seed, by: place(where, entry["top"], seed, tools, o.route_speed, by), alone)
    except NoEnd as failure:
        if alone:
            raise
        warn(f"{failure}, by the {placer} placer")
        return None
    add_placements(entry, placed, where)
    return entry


def fastest(placed: Mapping[str, Entry | None], name: str) -> Entry:
    """Of one part by several placers: the entry that misses no clock, then the one of the faster core, with the clocks by the others beside it."""
    best = max((e for e in placed.values() if e), key=lambda e: (not missed_clocks(e), e["fmax_mhz"]["median"]), default=None)
    if best is None:
        raise NoEnd(f"{name}: nextpnr does not end by any placer")
    if len(placed) > 1:
        best["other_placers"] = {placer: e["clocks"] if e else {} for placer, e in placed.items() if e is not best}
    return best


def merged(old: Sequence[Entry], new: Sequence[Entry], today: Mapping[str, str] | None) -> list[Entry]:
    """The new entries, and what was measured of the other parts while their sources are the same; where only resources are new, what was
    routed of these. today: name -> digest of the packages of old entries, None where the others do not stay. One without a digest was
    written by another command meanwhile."""
    measured = {e["name"]: e for e in new}
    entries = dict(measured)
    for e in old:
        now = measured.get(e["name"])
        routed_before = now is not None and not now["seeds"] and e["seeds"] and e["digest"] == now["digest"]
        if routed_before or (now is None and today is not None and e["digest"] == today.get(e["name"], e["digest"])):
            entries[e["name"]] = e
    return sorted(entries.values(), key=lambda e: PARTS.index(e["name"]))


def read_entries(path: Path) -> list[Entry]:
    """Those of the report, each of a part."""
    entries = entries_of(path)
    for n, entry in enumerate(entries):
        if entry["name"] not in PARTS:
            raise Failure(f"{path}: entries[{n}].name is {entry['name']}, expected one of {', '.join(PARTS)}")
    return entries


def table(entries: Sequence[Entry]) -> str:
    resources = list(entries[0]["resources"])
    rows = []
    for e in entries:
        full = e["binding"]
        fmax = ["–", "–", "–"]
        if f := e.get("fmax_mhz"):
            fmax = [f"{f['median']:.1f}", f"{f['low']:.1f} – {f['high']:.1f}", str(len(e["seeds"]))]
        short = ", ".join(f"{c['median']:.1f} of {c['constraint']:g}" for _, c in missed_clocks(e))
        short = f" (MISSED: {short})" if short else ""
        rows.append([f"`{e['name']}`"] + [f"{e['resources'][r]:,}" for r in resources] + fmax +
                    [f"{e['constraint_mhz']:g}" + short, f"{full['resource']} {full['used']:,} of {full['of']:,}"])
    placers = sorted({seed["placer"] for e in entries for seed in e["seeds"]} - {DEFAULT_PLACER})
    by_others = "".join(f"\nPlaced by nextpnr's {placer} placer: "
                        f"{', '.join('`' + e['name'] + '`' for e in entries if placer in {seed['placer'] for seed in e['seeds']})}.\n"
                        for placer in placers)
    by_others += "".join(f"\nBy the {placer} placer: {', '.join(reached)}.\n" for placer, reached in slower(entries).items())
    if not any(e.get("estimated") for e in entries):
        return markdown(rows, [""] + resources + ["Fmax, MHz", "range", "seeds", "constraint", "fullest"]) + by_others
    return (markdown(rows, [""] + resources + ["tool's estimate, MHz", "range", "seeds", "asked for", "fullest"]) +
            "\nMHz are what nextpnr estimates. Its delays of this family have not been shown to be those of the part, so no "
            "frequency is claimed; nor is there a bitstream.\n" + by_others)


def slower(entries: Sequence[Entry]) -> dict[str, list[str]]:
    """What parts reach by placers that were tried and are not those of the table, by the placer."""
    found: dict[str, list[str]] = {}
    for e in entries:
        for placer, clocks in e.get("other_placers", {}).items():
            core = core_clock(clocks, e["constraint_mhz"])
            short = [("" if c is core else f"{clock_name(net)} ") + f"{c['median']:.1f} of {c['constraint']:g}" for net, c in missed(clocks)]
            found.setdefault(placer, []).append(f"`{e['name']}` " + ("does not end" if core is None else f"{core['median']:.1f} MHz") +
                                                (f" (MISSED: {', '.join(short)})" if short else ""))
    return found


def has_core(board: Board) -> bool:
    """Whether the board has a top of its own, and not only those around a unit."""
    return any(top != "unit" for top in read_toml(BOARDS / board.name / "board.toml").get("top", {}))


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(prog="fpga", description=__doc__)
    p.add_argument("plan", nargs="?", help="a plan.toml (default: fpga/gatherer.toml, that of make bench-rtl; for up5k "
                                           "the small fpga/up5k.toml; each board.toml names its own)")
    p.add_argument("--board", help=f"{' or '.join(board_names())} (default: {README_BOARD})")
    p.add_argument("--units", help="these alone, separated by commas: photon_gatherer, reorder_buffer, cdf_sampler, "
                                   "board (default: all that the plan has, and the board's top; on a UP5K the reorder buffer)")
    p.add_argument("--seeds", type=whole(1), help="placements of each (default: 3)")
    p.add_argument("--first-seed", type=whole(0, LAST_SEED), help="number of the first one (default: 1)")
    p.add_argument("--clock", type=megahertz, help="MHz of the board's core, if not its default")
    p.add_argument("--route-speed", type=int, choices=(6, 7, 8),
                   help="speed grade of an ECP5 by whose delays the router searches (default: 6, the part's); 8 routes tops "
                        "that 6 does not finish. The result is always analysed at grade 6")
    p.add_argument("--placer", choices=(*PLACERS, "best"),
                   help="of nextpnr (default: heap on an ECP5, static on an Artix-7); static leaves shorter wires in wide tops; best places by "
                        "both, and of each part the one stands that misses no clock, then the one of the faster median, beside what the other reaches")
    p.add_argument("--synthesis-only", action="store_true", help="counts alone")
    only = p.add_mutually_exclusive_group()
    only.add_argument("--tools", action="store_true", help="only say which tools there are, or what is missing")
    only.add_argument("--check", action="store_true", help="only tell whether the pages that have such tables say which rows are of earlier RTL")
    only.add_argument("--render", action="store_true", help="only have these pages say so")
    p.add_argument("--dry-run", action="store_true", help="only tell whether the arguments are right; needs no tools")
    p.add_argument("--readme", action="store_true", help="put the table into README.md too")
    p.add_argument("--page", type=Path, nargs="?", const=ROOT / "docs" / "fpga.md", metavar="FILE",
                   help="put the table into this page too, where it has marks of the board (default: docs/fpga.md)")
    return p


def check_plan(p: argparse.ArgumentParser, plan: Path) -> None:
    """What can be told of a plan without photonloom."""
    if not plan.is_file():
        p.error(f"{plan}: there is no such plan")
    if plan.suffix != ".toml":
        p.error(f"{plan}: is no plan, expected a plan.toml")
    try:
        if not isinstance(read_toml(plan).get("gatherer"), dict):
            p.error(f"{plan}: gatherer is missing, expected a plan with this table")
    except Failure as failure:
        p.error(str(failure))


def options() -> tuple[Options, list[str] | None, dict[Path, str]]:
    """What was asked for: how, which parts (None: the default ones), and the pages that take the table, with its mark."""
    p = parser()
    o = p.parse_args()
    of_seeds = ("seeds", "first_seed", "route_speed", "placer")
    if nothing := next((f"--{name}" for name in ("tools", "check", "render") if getattr(o, name)), None):
        refuse_idle(p, o, (*of_seeds, "units", "clock", "synthesis_only", "readme", "page") + (() if o.tools else ("board",)), nothing, "measure")
        if o.plan is not None:
            p.error(f"{nothing} is of no plan, expected none")
    if o.clock and (o.readme or o.page):
        p.error("--readme, --page: of a board at its default clock, expected no --clock")
    if o.synthesis_only:
        refuse_idle(p, o, of_seeds, "--synthesis-only")
    seeds, first_seed = o.seeds or 3, 1 if o.first_seed is None else o.first_seed
    try:
        board = read_board(README_BOARD if o.board is None else o.board)
    except UnknownBoard as unknown:
        p.error(str(unknown))
    ecp5 = board.family is FAMILIES["ecp5"]
    if o.route_speed and not ecp5:
        p.error("--route-speed is the ulx3s-85f's")
    if o.placer and not board.family.placer:
        p.error(f"--placer: {board.name} has no choice of one")
    if o.placer == "best" and board.family.estimated:
        p.error(f"--placer best: clocks of {board.name} are the tool's estimate, by which no placer is better; expected {' or '.join(PLACERS)}")
    if first_seed + seeds - 1 > LAST_SEED:
        p.error(f"--seeds: the last one is {first_seed + seeds - 1}, expected at most {LAST_SEED}")
    asked = o.units.split(",") if o.units is not None else None
    check_names(p, asked or [], PARTS, option="--units")
    if "board" in (asked or []) and not has_core(board):
        p.error(f"--units: {board.name} has no top of a whole board, expected some of {', '.join(UNITS)}")
    if o.clock and "board" not in (asked or list(board.units) or PARTS):
        p.error("--clock: is the board's, expected board among --units")
    pages = {}
    if o.readme:
        if board.name != README_BOARD:
            p.error(f"--readme: README.md has a table of {README_BOARD}, expected that board or --page")
        pages[README[0]] = README[1]
    if o.page:
        pages[o.page] = board.name
    for page, mark in pages.items():
        try:
            around(page, mark)
        except Failure as failure:
            p.error(str(failure))
    if o.plan == "":
        p.error("the plan has no name, expected a plan.toml")
    plan = board.plan if o.plan is None else Path(o.plan)
    check_plan(p, plan)
    return Options(plan, board, range(first_seed, first_seed + seeds), o.clock, o.route_speed,
                   PLACERS if o.placer == "best" else (o.placer or board.family.placer or DEFAULT_PLACER,),
                   o.synthesis_only, o.tools, o.dry_run, "check" if o.check else "render" if o.render else None), asked, pages


def main() -> int:
    o, asked, pages = options()
    if o.dry_run:
        return 0
    if o.pages_only:
        render(check=o.pages_only == "check")
        return 0
    tools = find_tools(o.board)
    for name, version in tools.versions.items():
        say(f"{name}: {version}")
    if o.tools_only:
        return 0
    what = describe(o.plan)
    units = asked or list(o.board.units) or what["units"] + ["board"]
    for unit in units:
        if unit != "board" and unit not in what["units"]:
            raise UsageError(f"{o.plan}: the plan has no {unit}, only {', '.join(what['units'])}")
    folder = report_folder(o.board, what["hash"])
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "report.json"
    kept = {e["name"] for e in read_entries(path)}  # what is wrong with it, or would be lost of a page, is told before hours
    for page, mark in pages.items():
        for part in parts_of(page, mark, o.plan):
            if part not in units and part not in kept:
                raise UsageError(f"--units: {page} has {part} of this plan and {path} has not, expected it among them")
    new = [measure(o, folder, unit, tools) for unit in units]
    others = [e["name"] for e in read_entries(path) if e["name"] not in units] if asked else []
    today = {name: digest_now(o, folder, name, tools) for name in others} if asked else None
    with locked(lock_of(path)):  # read again, for a digest may have waited for a command that has written it since
        entries = merged(read_entries(path), new, today)
        report: Report = {"board": o.board.name, "plan": what["hash"], "versions": tools.versions, "entries": entries}
        write_json(path, report)
        text, by = table(entries), "; ".join(tools.versions.values())
        (folder / "report.md").write_text(f"{o.board.name}, plan {what['hash']}; {by}\n\n{text}")
    print("\n" + text)
    print(f"wrote {os.path.relpath(path, ROOT)}")
    for page, mark in pages.items():
        # Each entry is of the package that is there.
        replace_between(page, mark, section(text, by, o.plan, {e["name"]: netlist_digest(folder / e["name"]) for e in entries}))
    short = [(e["name"], clock, c) for e in entries for clock, c in missed_clocks(e)]
    for name, clock, c in short:
        warn(f"{name}: {clock} reaches {c['median']:.1f} MHz, constrained to {c['constraint']:.1f} MHz")
    return 1 if short else 0
