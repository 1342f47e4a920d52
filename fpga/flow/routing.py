# SPDX-License-Identifier: Apache-2.0
"""Placement and routing of a package by nextpnr, with several seeds."""
import itertools
import math
import os
import re
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NotRequired, TypedDict, TypeVar

from flow.shell import ROOT, Failure, beside, complaint, read_text, say, started
from flow.tools import Tools
from flow.typed_json import checked_json

STATIC_ROUNDS = 900  # after which nextpnr's static placer is ended; a placement that ended took some 600
# Seconds are those of a core: beside other work, or while it is stopped, nextpnr has fewer than the clock on the wall.
LEGALISING_LEAST, LEGALISING_SHARE = 300, 2  # it is ended too when it has legalised for so many s, and for so many times its rounds
ROUTER_LEAST, ROUTER_MORE = 900, 10800  # s after which nextpnr's router is judged, and that it may need more at its pace
SPARE_SEEDS = 2
POLL = 2.0  # s between looks at the logs
PLACERS = ("heap", "static")  # of nextpnr, the default one first
DEFAULT_PLACER = PLACERS[0]
PART_SPEED = 6  # grade by whose delays the Makefile has the router search if not told
Found = TypeVar("Found")


class Clock(TypedDict):
    """MHz."""
    achieved: float
    constraint: float


class Placement(TypedDict):
    """What one seed gave; `bitstream` is below the repository's root, where the family has one."""
    seed: int
    placer: str
    clocks: dict[str, Clock]
    utilization: dict[str, Any]
    bitstream: NotRequired[str]


class Report(TypedDict):
    """Of nextpnr's --report."""
    fmax: dict[str, Clock]
    utilization: dict[str, Any]


def constrained(clock: Clock) -> float:
    """MHz that a package asks for. nextpnr cuts a period to whole picoseconds and says what frequency that is, a little too high;
    a PLL made it by small dividers, so it is the simplest fraction whose period is cut to the same."""
    period = round(1e6 / clock["constraint"])  # ps
    simple = (math.floor(denominator * 1e6 / period) / denominator for denominator in itertools.count(1))
    return next(mhz for mhz in simple if mhz > 1e6 / (period + 1))


def clocks_of(report_file: Path) -> tuple[dict[str, Clock], dict[str, Any]]:
    """Clocks and use of the part in the JSON of nextpnr's --report."""
    report = checked_json(report_file, Report)
    clocks: dict[str, Clock] = {name: {"achieved": c["achieved"], "constraint": c["constraint"]}
                                for name, c in report["fmax"].items()}
    if not clocks:
        raise Failure(f"{report_file}: nextpnr reports no clock")
    return clocks, report["utilization"]


def static_rounds(log: str) -> int:
    """Rounds of nextpnr's static placer so far."""
    rounds = re.findall(r"^Info: iter=(\d+) ", log, re.M)
    return int(rounds[-1]) if rounds else 0


def legalises_for_ever(log: str, until: float, since: float) -> bool:
    """Whether nextpnr's static placer does not get cells legal: the last that it said, after `until` s, is that it begins to, and it has
    said nothing for the `since` s that followed."""
    return (log.rstrip().rpartition("\n")[2].startswith("Info: Strict legalising") and
            since > max(LEGALISING_LEAST, LEGALISING_SHARE * until))


def arcs_left(log: str) -> int | None:
    """Arcs that nextpnr's router has left, of which it says after each thousand steps; None before these."""
    said = re.findall(r"^Info: +\d+ \|[^|]*\|[^|]*\| *(\d+)\|", log, re.M)
    return int(said[-1]) if said else None


def routes_for_ever(looks: Sequence[tuple[float, int]]) -> bool:
    """Whether nextpnr's router does not come near its end: at its pace in the last third of its time, it would need ROUTER_MORE s more.
    looks: (s of a core that nextpnr had had, arcs left), from the first time on that it said these."""
    if not looks or looks[-1][0] - looks[0][0] < ROUTER_LEAST:
        return False
    begun, (now, left) = looks[0][0], looks[-1]
    before, left_before = next(look for look in reversed(looks) if look[0] - begun <= (now - begun) * 2 / 3)
    return left * (now - before) > ROUTER_MORE * max(0, left_before - left)


def seconds_of_group(group: int) -> float:
    """What the processes of a group that run have had of a core so far, and their children that have ended."""
    ticks = 0
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rpartition(")")[2].split()  # those behind the program's name, from the state on
        except OSError:  # it has ended
            continue
        if int(fields[2]) == group:
            ticks += sum(map(int, fields[11:15]))
    return ticks / os.sysconf("SC_CLK_TCK")


def watch(command: Sequence[str], log: Path, placer_log: Path | None, router_log: Path) -> bool:
    """Runs a placement. False where it does not come to an end. nextpnr's static placer goes round with the same overlap of block RAMs
    for ever, which tops whose photon memory is stored in pairs of blocks were seen to do (docs/headline.md), or it looks for ever for
    places of cells that stand together, of which a LUT RAM has six LUTs of one tile's eight. The router hardly gets on where wires are
    scarce. placer_log: of the static placer; None of another, which is left alone."""
    with open(log, "w") as out:
        said, said_at = "", 0.0
        looks: list[tuple[float, int]] = []
        with started(command, out) as running:
            while running.poll() is None:
                time.sleep(POLL)
                had = seconds_of_group(running.pid)
                if router_log.is_file() and (left := arcs_left(read_text(router_log))) is not None:
                    looks.append((had, left))
                    if routes_for_ever(looks):
                        return False
                if not placer_log or not placer_log.is_file():
                    continue
                if (text := read_text(placer_log)) != said:
                    said, said_at = text, had
                if static_rounds(said) > STATIC_ROUNDS or legalises_for_ever(said, said_at, had - said_at):
                    return False
    if running.returncode != 0:
        raise complaint(command, read_text(log), log)
    return True


def routed_name(top: str, seed: int, placer: str, route_speed: int | None) -> str:
    """What the package's Makefile calls the files of one placement."""
    return (f"{top}_seed{seed}" + (f"_{placer}" if placer != DEFAULT_PLACER else "") +
            (f"_route{route_speed}" if route_speed not in (None, PART_SPEED) else ""))


def forget(folder: Path, top: str, seed: int, placer: str, route_speed: int | None) -> None:
    """Removes what one placement left, so that it is made again."""
    for path in (folder / "build").glob(f"{routed_name(top, seed, placer, route_speed)}.*"):
        path.unlink()


def place(folder: Path, top: str, seed: int, tools: Tools, route_speed: int | None = None,
          placer: str = DEFAULT_PLACER) -> Placement | None:
    """One seed; `.bit` beside it. None where nextpnr does not come to an end."""
    log, built = beside(folder, f".seed{seed}.log"), folder / "build"
    command = (["make", "-C", str(folder), f"SEED={seed}", f"PLACER={placer}", "NEXTPNR_FLAGS=--timing-allow-fail"] +
               ([f"ROUTE_SPEED={route_speed}"] if route_speed else []) + tools.variables)
    routed = routed_name(top, seed, placer, route_speed)
    in_one = route_speed in (None, PART_SPEED)  # else placed by one delay and routed by another
    logs = [built / (routed + end + ".log") for end in (("", "") if in_one else (".placed", ".routed"))]
    if not (built / f"{routed}.json").is_file():  # make would take the rest for done
        forget(folder, top, seed, placer, route_speed)
    if not watch(command, log, logs[0] if placer == "static" else None, logs[1]):
        return None
    clocks, utilization = clocks_of(built / f"{routed}.json")
    placed: Placement = {"seed": seed, "placer": placer, "clocks": clocks, "utilization": utilization}
    if (bitstream := built / f"{routed}.bit").is_file():
        placed["bitstream"] = os.path.relpath(bitstream, ROOT)
    return placed


class NoEnd(Failure):
    """nextpnr does not come to an end with any seed."""


def placements(name: str, seeds: Sequence[int], placer: str, place_one: Callable[[int, str], Found | None],
               else_default: bool = True) -> list[Found]:
    """What place_one(seed, placer) gives for each seed, None where nextpnr does not come to an end: a further seed is taken for it, when
    there have been SPARE_SEEDS of these, the default placer if it may be, and where that does not end either, the others have to do."""
    placed, waiting, spare = [], list(seeds), SPARE_SEEDS
    for seed in waiting:  # which grow meanwhile
        say(f"{name}: seed {seed}" + (f", {placer} placer" if placer != DEFAULT_PLACER else ""))
        found = place_one(seed, placer)
        if found is None and spare:
            say(f"{name}: seed {seed}: nextpnr does not end; takes seed {waiting[-1] + 1} for it")
            waiting.append(waiting[-1] + 1)
            spare -= 1
            continue
        if found is None and else_default and placer != DEFAULT_PLACER:
            say(f"{name}: seed {seed}: nextpnr does not end; takes the default placer")
            found = place_one(seed, DEFAULT_PLACER)
        if found is None:
            say(f"{name}: seed {seed}: nextpnr does not end; goes without it")
            continue
        placed.append(found)
    if not placed:
        raise NoEnd(f"{name}: nextpnr does not end with any seed of {', '.join(map(str, waiting))}")
    return placed
