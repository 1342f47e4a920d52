# SPDX-License-Identifier: Apache-2.0
"""usage: headline_clocks.py THROUGHPUT: make bench-rtl's rows of the boards are at the clocks of fpga/headline.json, from which
docs/headline.md is written, and have its goals of the share of a bound, on a few queries."""
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from flow.goals import headline_goals
from flow.headline.data import DATA
from flow.headline.plans import find_plan
from flow.shell import Failure, exit_with, read_json, write_json

FEW = ("--size", "8", "--samples", "1", "--gather-rays", "16")
PLANS = ("sdram_k8", "block_ram_k8")


def clocks(throughput: Path, work: Path, *options: str) -> dict[str, tuple[float, float]]:
    """MHz of core and SDRAM of each plan's row. Of few queries the goals may be missed, status 1."""
    out = work / "rows.json"
    out.unlink(missing_ok=True)
    command = [str(throughput), *(str(find_plan(name, work).path) for name in PLANS), *FEW, "--json", str(out), *options]
    ran = subprocess.run(command, capture_output=True, text=True)
    if not out.is_file():
        raise Failure(f"{command}: status {ran.returncode}, wrote no rows: {ran.stderr}")
    rows: list[dict[str, Any]] = json.loads(out.read_text())["gather_cluster"]
    for row in rows:
        expect({"SDRAM": row["roofline_goal"], "gatherers": row["gatherers_goal"]}, headline_goals().share, "goals of fpga/goals.toml")
    return {row["plan"]: (row["core_mhz"], row["sdram_mhz"]) for row in rows}


def expect(found: object, expected: object, of: str) -> None:
    if found != expected:
        raise Failure(f"{of}: {found}, expected {expected}")


def main() -> int:
    throughput = Path(sys.argv[1])
    said = {row["plan"]: row for row in read_json(DATA)["rows"]}
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        expect(clocks(throughput, work),
               {"sdram_k8": (said["sdram_k8"]["fmax_mhz"]["median"], said["sdram_k8"]["sdram"]["mhz"]),
                "block_ram_k8": (said["block_ram_k8"]["fmax_mhz"]["median"], 100)}, "clocks of fpga/headline.json")
        other = work / "other.json"
        write_json(other, {"rows": [{"plan": "sdram_k8", "fmax_mhz": {"median": 40.0}, "sdram": {"mhz": 80.0}}]})
        expect(clocks(throughput, work, "--clocks", str(other)), {"sdram_k8": (40, 80), "block_ram_k8": (60, 100)},
               "clocks of another file, without a row of block_ram_k8")
        expect(clocks(throughput, work, "--clocks", str(other), "--core-mhz", "50", "--sdram-mhz", "90"),
               {"sdram_k8": (50, 90), "block_ram_k8": (50, 90)}, "clocks of options")
        other.write_text("{}")
        refused = subprocess.run([throughput, "--clocks", other], capture_output=True, text=True)
        if refused.returncode == 0 or str(other) not in refused.stderr:
            raise Failure(f"a file without rows: status {refused.returncode}, {refused.stderr!r}, expected a message that names it")
    return 0


if __name__ == "__main__":
    exit_with(main)
