# SPDX-License-Identifier: Apache-2.0
"""The methods of proof. Each says whether the assertions of a harness hold, and how far that was looked at."""
import re
from dataclasses import replace
from pathlib import Path

from flow.shell import Failure

from . import bounds, commands, model, paths
from .outcome import Outcome
from .properties import Property
from .tools import Tools


def prove(tools: Tools, folder: Path, proved: Property, sources: list[Path], work: Path, limit: float) -> Outcome:
    """Whether a property holds; undecided after limit seconds."""
    method = {"pdr": _pdr, "induction": _induction, "exhaustive": _bounded, "bmc": _bounded, "path": _path, "gappa": bounds.prove}[proved.method]
    return method(tools, folder, proved, sources, work, limit)


def refute(tools: Tools, folder: Path, proved: Property, sources: list[Path], work: Path, limit: float) -> Outcome:
    """The same where a run that breaks it is looked for, the shortest first. What breaks has to be the property: a lemma
    that a bug breaks would show nothing."""
    if proved.method == "gappa":
        return bounds.refute(tools, folder, proved, sources, work, limit)
    if proved.method == "path":
        return _path(tools, folder, proved, sources, work, limit)
    if "Lemmas" in proved.parameters:
        proved = replace(proved, parameters={**proved.parameters, "Lemmas": 0})
    # A bound that its bug lies beyond would show nothing.
    depth = 100 if proved.method == "induction" else proved.depth or 100
    found = _search(tools, folder, proved, sources, work, depth, limit)
    if found.verdict == "fails":
        return found
    return Outcome("undecided", found.depth, found.seconds)


def _abc(tools: Tools, aig: Path, command: str, log: Path, limit: float) -> commands.Finished:
    # Constraints are folded into the properties.
    done = commands.run([tools.abc, "-c", f"read_aiger {aig}; fold; strash; {command}"], log, limit)
    if re.search(r"^Error", done.text, re.MULTILINE):
        raise Failure(f"{tools.abc}: refuses {aig} (log: {log})")
    return done


_FAILS = re.compile(r"Output \d+ of miter .* was asserted in frame (\d+)")


def _pdr(tools: Tools, folder: Path, proved: Property, sources: list[Path], work: Path, limit: float) -> Outcome:
    log = work / "log"
    aig = work / "model.aig"
    built = model.aiger(tools, folder, proved, sources, aig, log)
    done = _abc(tools, aig, "pdr -v", log, limit)
    seconds = built + done.seconds
    failed = _FAILS.search(done.text)
    if failed:
        return Outcome("fails", int(failed[1]), seconds)
    if "Property proved." in done.text:
        if "Verification of invariant" in done.text and "was successful" not in done.text:
            raise Failure(f"{tools.abc}: its invariant does not verify (log: {log})")
        return Outcome("holds", None, seconds)
    if done.ended:
        raise Failure(f"{tools.abc}: neither proved nor refuted {proved.name} (log: {log})")
    frames = re.findall(r"^ *(\d+) :", done.text, re.MULTILINE)
    return Outcome("undecided", int(frames[-1]) if frames else 0, seconds)


def _search(tools: Tools, folder: Path, proved: Property, sources: list[Path], work: Path, depth: int,
            limit: float) -> Outcome:
    """Bounded model checking with a SAT solver."""
    log = work / "log"
    aig = work / "model.aig"
    built = model.aiger(tools, folder, proved, sources, aig, log)
    done = _abc(tools, aig, f"bmc3 -v -F {depth}", log, limit)
    seconds = built + done.seconds
    failed = _FAILS.search(done.text)
    if failed:
        return Outcome("fails", int(failed[1]), seconds)
    clean = re.search(r"No output asserted in (\d+) frames", done.text)
    if clean and int(clean[1]) >= depth:
        return Outcome("holds", depth, seconds)
    frames = re.findall(r"^ *(\d+) \S", done.text, re.MULTILINE)
    return Outcome("undecided", int(frames[-1]) if frames else 0, seconds)


def _induction(tools: Tools, folder: Path, proved: Property, sources: list[Path], work: Path, limit: float) -> Outcome:
    """All assertions at once: after depth cycles that keep them, from any state, the next one keeps them."""
    # One cycle from reset more than the step presumes.
    base = _search(tools, folder, proved, sources, work, proved.depth + 1, limit)
    if base.verdict != "holds":
        return base
    done = _abc(tools, work / "model.aig", f"orpos; ind -v -F {proved.depth}", work / "log", limit)
    seconds = base.seconds + done.seconds
    if done.ended and "Networks are equivalent" in done.text:
        return Outcome("holds", None, seconds)
    return Outcome("undecided", base.depth, seconds)


def _bounded(tools: Tools, folder: Path, proved: Property, sources: list[Path], work: Path, limit: float) -> Outcome:
    found = _search(tools, folder, proved, sources, work, proved.depth, limit)
    if found.verdict == "holds" and proved.unbounded:
        return Outcome("holds", None, found.seconds)
    return found


def _path(tools: Tools, folder: Path, proved: Property, sources: list[Path], work: Path, limit: float) -> Outcome:
    del limit
    json = work / "netlist.json"
    seconds = model.netlist(tools, folder, proved, sources, json, work / "log")
    for start, end in proved.paths:
        if paths.leads(json, proved.harness, start, end):
            return Outcome("fails", 0, seconds, f"a path from {start} to {end}")
    return Outcome("holds", None, seconds)
