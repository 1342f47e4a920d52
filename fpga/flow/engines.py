# SPDX-License-Identifier: Apache-2.0
"""Predicted cycles of gather engines beside simulated ones: runs the slow tests that compare them, keeps the figures in
fpga/engines.json and puts them onto docs/planner.md."""
import argparse
import json
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from flow.package import PHOTONLOOM
from flow.shell import ROOT, Failure, read_json, run, say, write_json
from flow.tables import between, markdown, replace_between

DATA = ROOT / "fpga" / "engines.json"
PAGE = ROOT / "docs" / "planner.md"
PROGRAM = ROOT / "build" / "tests" / "test_study_slow"
TESTS = {"frames": "predicted cycles of a frame's engine are within 15 % of simulated ones",
         "sdram": "predicted cycles of engines before an SDRAM are within 15 % of simulated ones",
         "headline": "predicted cycles of the headline's rows from an SDRAM are within 15 % of theirs"}
Engine = dict[str, Any]
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
    for name in o.tables:
        if name not in TESTS:
            p.error(f"there is no table {name}, expected some of {', '.join(TESTS)}")
    if o.check and o.tables:
        p.error("--check is of the whole page, expected no tables")
    marks = {name: f"engines: {name}" for name in TESTS}
    for mark in marks.values():
        between(PAGE, mark)
    engines: list[Engine] = read_json(DATA) if DATA.is_file() else []
    if o.check:
        for name, mark in marks.items():
            if between(PAGE, mark) != table(engines, name):
                raise Failure(f"{PAGE}: its table '{mark}' is not what {DATA} gives; scripts/engine-predictions writes it")
        say("docs/planner.md is that of fpga/engines.json")
        return 0
    for name in o.tables or TESTS:
        engines = [engine for engine in engines if engine["table"] != name] + measured(name)
    write_json(DATA, sorted(engines, key=lambda engine: list(TESTS).index(engine["table"])))
    for name, mark in marks.items():
        replace_between(PAGE, mark, table(engines, name))
    print("\n".join(table(engines, name) for name in TESTS))
    return 0
