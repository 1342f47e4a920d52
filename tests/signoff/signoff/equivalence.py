# SPDX-License-Identifier: Apache-2.0
"""Whether a mutant computes the same: each version of its module in a plan's unit beside the mutated one, register by register.

For the same inputs and the same contents of all registers both give the same outputs and the same next contents. What is equal only in
states that can be reached, or for inputs that come, is not shown."""
import re
import resource
import subprocess
from pathlib import Path

from flow.shell import read_json

# Seconds of the processor for a version, so that what else a machine does changes no verdict.
LIMIT = 120
MEMORIES = ("block_ram", "block_ram_two_reads", "lut_ram")


def _yosys(yosys: str, script: str, log: Path) -> bool:
    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_CPU, (LIMIT, LIMIT))

    with log.open("w") as stream:
        done = subprocess.run([yosys, "-q", "-p", script], stdout=stream, stderr=subprocess.STDOUT, preexec_fn=limit)
    return done.returncode == 0


def _versions(yosys: str, unit: str, module: str, files: list[Path], out: Path) -> list[str]:
    """The names under which the unit's hierarchy has the module, by parameters."""
    listing = out / "hierarchy.json"
    if not _yosys(yosys, f"read_verilog -nosynthesis -sv {' '.join(map(str, files))}; hierarchy -check -top {unit}; proc; write_json {listing}", out / "hierarchy.log"):
        return []
    names = read_json(listing)["modules"]
    return [name for name in names if name == module or re.fullmatch(rf"\$paramod(?:\$[0-9a-f]+)?\\{module}(?:\\.*)?", name)]


def proved(yosys: str, unit: str, module: str, files: list[Path], mutated: dict[Path, Path], out: Path) -> bool:
    """Whether the module is the same with these files in place of others, in every version that the unit has."""
    out.mkdir(parents=True, exist_ok=True)
    versions = _versions(yosys, unit, module, files, out)
    gate = [mutated.get(file, file) for file in files]

    # Memories that are the same on both sides stay what they are: what comes to them is compared, what comes from them is free.
    kept = "" if module in MEMORIES else "".join(f"blackbox *{memory}; blackbox *{memory}\\*; " for memory in MEMORIES)

    def side(name: str, version: str, sources: list[Path]) -> str:
        top = f"\\{version}" if version == module else version
        return (f"design -reset; read_verilog -nosynthesis -sv {' '.join(map(str, sources))}; hierarchy -check -top {unit}; hierarchy -top {top}; "
                f"proc; {kept}flatten; chformal -remove; opt_clean; memory_map; dffunmap; opt_clean; expose -dff -evert-dff; expose -dff -evert; "
                f"rename {top} {name}; design -stash {name}; ")

    def same(version: str, number: int) -> bool:
        script = (side("gold", version, files) + side("gate", version, gate) +
                  "design -copy-from gold -as gold gold; design -copy-from gate -as gate gate; "
                  # What both have alike is one once their inputs are.
                  "miter -equiv -flatten -make_assert gold gate miter; hierarchy -top miter; opt_merge; opt_clean; "
                  "sat -verify -prove-asserts miter")
        return _yosys(yosys, script, out / f"equiv{number}.log")

    return bool(versions) and all(same(version, number) for number, version in enumerate(versions))
