# SPDX-License-Identifier: Apache-2.0
"""Predicted cycles of gather engines beside simulated ones: runs the slow tests that compare them, keeps the figures in
fpga/engines.json and puts them onto docs/planner.md."""
import argparse
import json
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypedDict

from flow.arguments import check_names
from flow.headline.data import of_headline
from flow.headline.data import read_data as read_headline
from flow.package import PHOTONLOOM
from flow.shell import ROOT, Failure, data_lock, run, say, write_json
from flow.tables import between, markdown, replace_between
from flow.typed_json import checked_json, typed

DATA = ROOT / "fpga" / "engines.json"
PAGE = ROOT / "docs" / "planner.md"
PROGRAM = ROOT / "build" / "tests" / "test_study_slow"
TESTS = {"frames": "predicted cycles of a frame's engine are within 15 % of simulated ones",
         "sdram": "predicted cycles of engines before an SDRAM are within 15 % of simulated ones",
         "headline": "predicted cycles of the headline's rows from an SDRAM are within 15 % of theirs"}
Engine = dict[str, Any]


class Predicted(TypedDict):
    """Cycles a gather."""
    table: str
    predicted: float
    simulated: float


class OfFrame(Predicted):
    scene: str
    gatherers: int
    nodes: int
    contexts: int
    cache_bytes: int
    reordered: bool


class OfSdram(Predicted):
    scene: str
    photons: int
    k: int
    gatherers: int
    pool: int


class OfHeadline(Predicted):
    plan: str
    within_mean: bool


KINDS: dict[str, type] = {"frames": OfFrame, "sdram": OfSdram, "headline": OfHeadline}
Columns = dict[str, Callable[[Engine], object]]
CYCLES: Columns = {"cycles a gather, predicted": lambda e: f"{e['predicted']:.2f}", "simulated": lambda e: f"{e['simulated']:.2f}",
                   "off": lambda e: f"{100 * (e['predicted'] / e['simulated'] - 1):+.1f} %"}
COLUMNS: dict[str, Columns] = {
    "frames": {"scene": lambda e: e["scene"], "gatherers": lambda e: e["gatherers"], "nodes a cycle": lambda e: e["nodes"],
               "contexts": lambda e: e["contexts"], "bytes of leaf cache": lambda e: f"{e['cache_bytes']:,}" if e["cache_bytes"] else "none",
               "reorder buffer": lambda e: "yes" if e["reordered"] else "no"},
    "sdram": {"scene": lambda e: e["scene"], "photons": lambda e: f"{e['photons']:,}", "k": lambda e: e["k"], "gatherers": lambda e: e["gatherers"],
              "pool": lambda e: f"{e['pool']:,}"},
    "headline": {"plan": lambda e: e["plan"], "radius": lambda e: "mean r²" if e["within_mean"] else "none"}}


def table(engines: list[Engine], name: str) -> str:
    columns = COLUMNS[name] | CYCLES
    return markdown([[cell(engine) for cell in columns.values()] for engine in engines if engine["table"] == name], list(columns))


def read_data() -> list[Engine]:
    engines = checked_json(DATA, list[dict[str, Any]])
    for n, engine in enumerate(engines):
        if (name := engine.get("table")) not in TESTS:
            raise Failure(f"{DATA}: [{n}].table is {name}, expected one of {', '.join(TESTS)}")
        typed(engine, KINDS[name], DATA, f"[{n}]")
    return engines


def check_rows(engines: list[Engine]) -> None:
    """That the headline's rows are those that are there, which may have been measured again since."""
    have = {(e["plan"], e["within_mean"]): e["simulated"] for e in engines if e["table"] == "headline"}
    are = {(r["plan"], r["within_mean"]): r["cycles_per_gather"] for r in read_headline()["rows"] if of_headline(r) and r["memory"] == "sdram"}
    if other := next((key for key in have.keys() | are.keys() if have.get(key) != are.get(key)), None):
        raise Failure(f"{DATA}: has {have.get(other)} cycles simulated of {other[0]}, expected {are.get(other)} as fpga/headline.json has; "
                      "scripts/engine-predictions headline predicts its rows again")


def measured(name: str) -> list[Engine]:
    """What one of the tests says."""
    say(f"{name}: {TESTS[name]}")
    with tempfile.TemporaryDirectory() as folder:
        said = Path(folder, "predictions")
        os.environ |= {"PHOTONLOOM_PREDICTIONS": str(said), "PHOTONLOOM": PHOTONLOOM, "PHOTONLOOM_SOURCE": str(ROOT),
                       "PHOTONLOOM_RTL": str(ROOT / "rtl")}
        run([str(PROGRAM), TESTS[name]], log=ROOT / "build" / f"engine_predictions_{name}.log")
        if not said.is_file():
            raise Failure(f"{PROGRAM}: its test '{TESTS[name]}' predicted nothing")
        engines: list[Engine] = [json.loads(line) for line in said.read_text().splitlines()]
        return engines


def main() -> int:
    p = argparse.ArgumentParser(prog="engine-predictions", description=__doc__)
    p.add_argument("tables", nargs="*", metavar="TABLE", help=f"of {', '.join(TESTS)}; the others stay as fpga/engines.json has them (default: all)")
    p.add_argument("--check", action="store_true", help="only tell whether docs/planner.md is that of fpga/engines.json")
    o = p.parse_args()
    check_names(p, o.tables, TESTS, "table")
    if o.check and o.tables:
        p.error("--check is of the whole page, expected no tables")
    marks = {name: f"engines: {name}" for name in TESTS}
    for mark in marks.values():
        between(PAGE, mark)
    engines = read_data() if DATA.is_file() else []
    if o.check:
        check_rows(engines)
        for name, mark in marks.items():
            if between(PAGE, mark) != table(engines, name):
                raise Failure(f"{PAGE}: its table '{mark}' is not what {DATA} gives; scripts/engine-predictions writes it")
        say("docs/planner.md is that of fpga/engines.json")
        return 0
    tables = o.tables or list(TESTS)
    new = [engine for name in tables for engine in measured(name)]
    with data_lock(DATA):  # another command may have written meanwhile
        engines = [engine for engine in (read_data() if DATA.is_file() else []) if engine["table"] not in tables] + new
        write_json(DATA, sorted(engines, key=lambda engine: list(TESTS).index(engine["table"])))
        for name, mark in marks.items():
            replace_between(PAGE, mark, table(engines, name))
    print("\n".join(table(engines, name) for name in TESTS))
    return 0
