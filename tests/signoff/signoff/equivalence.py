# SPDX-License-Identifier: Apache-2.0
"""Whether a mutant computes the same: each version of its module in a plan's unit beside the mutated one, register by register.

For the same inputs and the same contents of all registers both give the same outputs and the same next contents. Where the next contents
of some registers differ and no output does, these registers are followed: from the same contents of all, everything else stays the same in
every cycle that comes, by induction. An input that the unit ties to a constant wherever it has the module has that constant. What is
equal only in states that can be reached, or for inputs that come, is not shown."""
import functools
import re
import resource
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from flow.shell import read_json

# Seconds of the processor for a proof, so that what else a machine does changes no verdict.
LIMIT = 120
# Registers to follow; a mutant that changes more of them is none that a few cycles make good.
FOLLOWED = 4


@dataclass(frozen=True)
class Version:
    """A module's parameters, and what the unit ties its inputs to: names and bits, most significant first."""
    parameters: tuple[tuple[str, str], ...]
    tied: tuple[tuple[str, str], ...]


def _yosys(yosys: str, script: str, log: Path) -> bool:
    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_CPU, (LIMIT, LIMIT))

    with log.open("w") as stream:
        done = subprocess.run([yosys, "-q", "-p", script], stdout=stream, stderr=subprocess.STDOUT, preexec_fn=limit)
    return done.returncode == 0


def _versions(yosys: str, unit: str, module: str, files: list[Path]) -> list[Version] | None:
    """Those that the unit's hierarchy has; None where the unit is not read."""
    modules = _hierarchy(yosys, unit, tuple(files))
    if modules is None:
        return None
    names = [name for name in modules if name == module or re.fullmatch(rf"\$paramod(?:\$[0-9a-f]+)?\\{module}(?:\\.*)?", name)]
    found = []
    for name in names:
        parameters = modules[name].get("parameter_default_values", {}) if name != module else {}
        found.append(Version(tuple((key, str(value)) for key, value in parameters.items()), _tied(modules, name)))
    return found


@functools.cache
def _hierarchy(yosys: str, unit: str, files: tuple[Path, ...]) -> dict[str, dict[str, Any]] | None:
    """A plan's unit with all that it instantiates."""
    with tempfile.TemporaryDirectory() as name:
        listing, log = Path(name) / "hierarchy.json", Path(name) / "log"
        if not _yosys(yosys, f"read_verilog -nosynthesis -sv {' '.join(map(str, files))}; hierarchy -check -top {unit}; proc; write_json {listing}", log):
            return None
        found: dict[str, dict[str, Any]] = read_json(listing)["modules"]
        return found


def _tied(modules: dict[str, dict[str, dict[str, dict[str, Any]]]], name: str) -> tuple[tuple[str, str], ...]:
    used = [cell["connections"] for holder in modules.values() for cell in holder["cells"].values() if str(cell["type"]) == name]
    found = []
    for port in modules[name]["ports"] if used else ():
        values = {"".join(str(bit) if bit in ("0", "1") else "?" for bit in reversed(connections.get(port, ["?"]))) for connections in used}
        if len(values) == 1 and "?" not in min(values):
            found.append((port, min(values)))
    return tuple(found)


def proved(yosys: str, unit: str, module: str, files: list[Path], mutated: dict[Path, Path], out: Path) -> bool | None:
    """Whether the module is the same with these files in place of others, in every version that the unit has; None where it has none."""
    out.mkdir(parents=True, exist_ok=True)
    versions = _versions(yosys, unit, module, files)
    if versions is None:
        return False
    gate = [mutated.get(file, file) for file in files]

    def side(name: str, version: Version, sources: list[Path], followed: list[str]) -> str:
        given = "".join(f" -chparam {key} {len(bits)}'b{bits}" for key, bits in version.parameters)
        # A register of the implicit clock is one that expose leaves where it is; it would still make an output of it.
        left = "".join(f"formalff -clk2ff w:{_pattern(register)} %ci1:+$dff[Q]; " for register in followed)
        but = " *" + "".join(f" w:{_pattern(register)} %d" for register in followed) if followed else ""
        return (f"design -reset; read_verilog -defer -nosynthesis -sv {' '.join(map(str, sources))}; hierarchy -check -top {module}{given}; "
                # What the module instantiates is the same on both sides: what comes to it is compared, what comes from it is free.
                f"rename -top {name}; blackbox * {name} %d; proc; chformal -remove; opt_clean; memory_map; dffunmap; opt_clean; "
                f"{left}expose -dff -evert-dff{but}; expose -dff -evert{but}; design -stash {name}; ")

    def both(version: Version, kind: str, followed: list[str]) -> str:
        return (side("gold", version, files, followed) + side("gate", version, gate, followed) +
                "design -copy-from gold -as gold gold; design -copy-from gate -as gate gate; "
                # What both have alike is one once their inputs are.
                f"miter -equiv -flatten {kind} gold gate miter; hierarchy -top miter; opt_merge; opt_clean; ")

    def same(version: Version, number: int) -> bool:
        tied = "".join(f" -set in_{port} {len(bits)}'b{bits}" for port, bits in version.tied)
        miter, listing = out / f"miter{number}.il", out / f"miter{number}.json"
        if not _yosys(yosys, both(version, "-make_outcmp", []) + f"write_rtlil {miter}; write_json {listing}", out / f"miter{number}.log"):
            return False
        differ: list[str] = []
        # Each output alone, with what it is made of: a proof of one does not wait for those of the others.
        for place, port in enumerate(_to_compare(read_json(listing)["modules"]["miter"])):
            if _yosys(yosys, f"read_rtlil {miter}; cd miter; sat -verify{tied} -prove {port} 1 w:{_pattern(port)} %ci*", out / f"equiv{number}_{place}.log"):
                continue
            if not port.endswith(".d") or len(differ) == FOLLOWED:
                return False
            differ.append(port.removeprefix("cmp_").removesuffix(".d"))
        if not differ:
            return True
        begin = "".join(f" -set-at 1 gold.{register} gate.{register}" for register in differ)
        return _yosys(yosys, both(version, "-make_assert", differ) + f"sat -verify -tempinduct -maxsteps 4 -prove-asserts{tied}{begin} miter",
                      out / f"follow{number}.log")

    return all(same(version, number) for number, version in enumerate(versions)) if versions else None


def _to_compare(miter: dict[str, dict[str, dict[str, Any]]]) -> list[str]:
    """The comparisons of outputs that are not made of one and the same logic on both sides."""
    alike = {cell["connections"]["Y"][0] for cell in miter["cells"].values()
             if str(cell["type"]) == "$eqx" and cell["connections"]["A"] == cell["connections"]["B"]}
    return sorted(port for port, wire in miter["ports"].items() if port.startswith("cmp_") and wire["bits"][0] not in alike)


def _pattern(name: str) -> str:
    """A name for a selection, which takes brackets for a set of characters."""
    return re.sub(r"[\[\]]", "?", name)
