# SPDX-License-Identifier: Apache-2.0
"""From SystemVerilog to what a solver reads. Registers without an initial value start with any; reset is the harness's."""
from pathlib import Path

from flow.shell import Failure

from . import commands
from .properties import Property
from .tools import Tools

# A minute and a half is thirty times what the largest harness takes.
_LIMIT = 90.0


def _yosys(tools: Tools, script: str, log: Path) -> float:
    done = commands.run([tools.yosys, "-q", "-p", script], log, _LIMIT)
    if done.status != 0:
        said = [line for line in done.text.splitlines() if "ERROR" in line]
        raise Failure(f"yosys: {said[0] if said else 'ended with status ' + str(done.status)} (log: {log})")
    # A name that Yosys makes up is one that it does not find, and any value then: older ones read no fields of a structure in a loop.
    if made_up := [line for line in done.text.splitlines() if "is implicitly declared" in line]:
        raise Failure(f"yosys: {made_up[0]}: {tools.yosys} does not read this as it stands (make formal takes a newer one; log: {log})")
    return done.seconds


def _read(folder: Path, proved: Property, sources: list[Path]) -> str:
    """Flat logic of the harness with its parameters and probes."""
    parameters = "".join(f"chparam -set {name} {value} {proved.harness}; " for name, value in proved.parameters.items())
    # A probe is a wire of the harness that nothing drives there.
    probes = "".join(f"connect -set {wire} {inner}; " for wire, inner in proved.probes.items())
    # A word of a memory is a wire NAME[ADDRESS] once the memory is registers.
    memories = "memory_map; " if proved.probes else ""
    cuts = "".join(f"select -assert-count 1 w:{wire}; cutpoint w:{wire}; " for wire in proved.cuts)
    files = " ".join(str(folder / source) for source in sources)
    return (f"read_verilog -formal -sv {files}; {parameters}prep -flatten -top {proved.harness}; {memories}"
            f"cd {proved.harness}; {probes}{cuts}cd ..; chformal -cover -remove; ")


def aiger(tools: Tools, folder: Path, proved: Property, sources: list[Path], out: Path, log: Path) -> float:
    """An and-inverter graph with a bad state for each assertion and a constraint for each assumption."""
    # Outputs are deleted, since the format would count each as a property.
    # Of one clock each step is an edge; of several the harness says which.
    steps = f"techmap -map {Path(__file__).parent / 'clock_steps.v'}; " if proved.clocks > 1 else ""
    script = _read(folder, proved, sources) + (
        f"async2sync; dffunmap; memory_map; opt_clean; {steps}formalff -setundef -clk2ff -ff2anyinit; setundef -undriven -anyseq; "
        "setattr -unset keep; delete -output; opt -full; techmap; opt -fast; simplemap; dffunmap; abc -g AND -fast; opt_clean; "
        f"write_aiger -I -B -zinit -no-startoffset {out}")
    return _yosys(tools, script, log)


def netlist(tools: Tools, folder: Path, proved: Property, sources: list[Path], out: Path, log: Path) -> float:
    """Gates and registers of the harness as JSON, bit by bit."""
    # Nothing uses the ends of a path once the assertions are gone.
    ends = " ".join(f"w:{wire}" for path in proved.paths for wire in path)
    script = _read(folder, proved, sources) + (
        f"cd {proved.harness}; setattr -set keep 1 {ends}; cd ..; "
        "chformal -assert -assume -remove; memory_map; opt -full; techmap; simplemap; opt -fast; opt_clean; "
        f"write_json {out}")
    return _yosys(tools, script, log)
