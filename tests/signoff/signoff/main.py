# SPDX-License-Identifier: Apache-2.0
"""signoff [UNIT...]: what of each unit's RTL its bench reaches, what is proved of it, and every hole with its reason. Status 1 where
a hole has no reason in tests/signoff/holes/UNIT.toml, a reason no hole, or a run a difference, and where all plans together miss a goal."""
import argparse
import os
import re
from pathlib import Path

from flow.shell import ROOT, Failure, read_json, run, say, warn, write_json

from . import cover, coverage, evidence, holes, mutators, page, units

# Modules that are nothing but a memory: their words are no points.
MEMORIES = frozenset({"block_ram", "block_ram_two_reads", "lut_ram", "pool_ram"})
# A bench of more plans runs each case of a plan with one of its stall policies, drawn by plan and case: all plans together have all of them
# many times over, and with all of them a wide plan, whose every bit is counted, was not done after 25 minutes.
ALL_POLICIES = 10
_TOTALS = re.compile(r": golden == rtl: (\d+) packets in \d+ runs, (\d+) with a reset in the middle, 0 differences, (\d+) cycles")


def _run_plan(program: Path, plan: str, policies: list[str], rtl: Path, made_from: str, folder: Path, models: Path, again: bool) -> tuple[int, ...]:
    """Packets, resets in the middle and cycles of a plan, its counts in the folder; kept while what it is made from is the same."""
    done = folder / "done.json"
    made = {"made_from": made_from, "policies": policies}
    if done.is_file() and not again:
        kept = read_json(done)
        if {name: kept.get(name) for name in made} == made:
            return tuple(kept["totals"])
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.iterdir():
        old.unlink()
    os.environ["PHOTONLOOM_COVERAGE"] = str(folder)
    said = run([str(program), "--plan", plan, *policies, "--rtl", str(rtl), "--work", str(models)], folder / "log", ROOT)
    totals = _TOTALS.search(said)
    if not totals or not list(folder.glob("*.dat")):
        raise Failure(f"{program.name} --plan {plan}: left no counts (log: {folder / 'log'})")
    numbers = [int(number) for number in totals.groups()]
    write_json(done, {**made, "totals": numbers})
    say(f"{program.name} --plan {plan}: {numbers[0]} packets, {numbers[2]} cycles")
    return tuple(numbers)


def _unit(unit: str, named: list[str], benches: Path, work: Path, again: bool) -> tuple[page.Evidence, list[coverage.Point]]:
    program = units.bench(benches, unit)
    plans = units.plans_of(program, named)
    rtl = work / unit / "rtl"
    cover.attach(unit, rtl)
    made_from = units.made_from(program, map(units.cover, cover.modules(unit)))
    every = units.plans(program)
    policies = ["--one-policy"] if len(every) > ALL_POLICIES else []
    runs = [_run_plan(program, plan, policies, rtl, made_from, work / unit / plan, work / "models", again) for plan in plans]
    packets, resets, cycles = (sum(numbers) for numbers in zip(*runs, strict=True))
    elaborated = frozenset((module, line) for module in units.modules(unit) for line in mutators.elaborated(
        (ROOT / units.source(module)).read_text(), str(units.source(module))))
    found = coverage.read([file for plan in plans for file in sorted((work / unit / plan).glob("*.dat"))],
                          coverage.Without(MEMORIES, elaborated))
    events = cover.points(unit)
    for entry in events:
        found.add(entry.point, 0)  # of a module that no plan has, too
    modules = {point.module for point in found.counts}
    explained, bare = holes.explain([point for kind in coverage.KINDS for point in found.holes(kind)], holes.reasons(unit))
    return page.Evidence(plans, len(every), bool(policies), packets, resets, cycles, found, events, explained,
                         evidence.proofs(modules), evidence.hand_mutants(unit)), bare


def main() -> int:
    parser = argparse.ArgumentParser(prog="signoff", description=__doc__)
    parser.add_argument("units", nargs="*", metavar="UNIT", help="units by name, all without one")
    parser.add_argument("--plan", action="append", default=[], metavar="PLAN", help="only this plan of the bench; may be repeated (default all)")
    parser.add_argument("--update", action="store_true", help="write the section of docs/UNIT.md; without, print it")
    parser.add_argument("--again", action="store_true", help="run also what was run with this bench and RTL before")
    parser.add_argument("--benches", type=Path, default=ROOT / "build" / "verilator_tb", help="where the benches are (default build/verilator_tb)")
    parser.add_argument("--work", type=Path, default=ROOT / "build" / "signoff", help="where models and counts go (default build/signoff)")
    arguments = parser.parse_args()

    work = arguments.work.resolve()
    faults = 0
    chosen = units.chosen(arguments.units)
    units.check_plans(arguments.benches.resolve(), chosen, arguments.plan)
    for unit in chosen:
        found, bare = _unit(unit, arguments.plan, arguments.benches.resolve(), work, arguments.again)
        said = {figure.kind: f"{page.NAMES[figure.kind]} {figure.percent:.2f} %{'' if figure.met else ' MISSED'}"
                for figure in page.figures(found.coverage) if figure.of}
        say(f"{unit}: {', '.join(said.values())}; {sum(len(hole.points) for hole in found.holes)} holes with a reason, {len(bare)} without")
        for kind in coverage.KINDS:
            for module in sorted({point.module for point in bare if point.kind == kind}):
                at = [point for point in bare if (point.kind, point.module) == (kind, module)]
                for phrase in holes.grouped(at):
                    warn(f"{unit}: {units.source(module)}: {kind}: {phrase}: was not reached, and tests/signoff/holes/{unit}.toml does not say why")
        for hole in found.holes:
            if not hole.points:
                warn(f"tests/signoff/holes/{unit}.toml: {hole.reason.kind} of {hole.reason.module}, {', '.join(hole.reason.of)}: has no hole to explain")
        # Some of the plans alone need not reach the goals.
        missed = [] if arguments.plan else [figure for figure in page.figures(found.coverage) if figure.of and not figure.met]
        faults += len(bare) + sum(not hole.points for hole in found.holes) + len(missed)
        text = page.section(unit, found)
        if not arguments.update:
            print(text)
        elif not bare:
            page.write(ROOT / "docs" / f"{unit}.md", text)
            say(f"wrote docs/{unit}.md")
    return 1 if faults else 0
