# SPDX-License-Identifier: Apache-2.0
"""What scripts/fpga, scripts/area-check and scripts/fpga-plans share: packages for a board, synthesis, placement, counts.

Resources are a dict by the names in RESOURCES. LUT-equivalents are LUT4 + 2 CCU2C + 4 DPR16X4: a carry cell takes two
LUTs of a slice, a 16 x 4 memory four.
"""
import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PHOTONLOOM = os.environ.get("PHOTONLOOM", os.path.join(ROOT, "build", "photonloom"))
UNITS = ["photon_gatherer", "reorder_buffer", "cdf_sampler"]

# Our name of a resource, the cells that are one, and what an LFE5U-85F has (docs/data.md).
ECP5 = {
    "LUT4": (["LUT4"], 83640),
    "FF": (["TRELLIS_FF"], 83640),
    "CCU2C": (["CCU2C"], None),
    "DPR16X4": (["TRELLIS_DPR16X4"], None),
    "DP16KD": (["DP16KD"], 208),
    "MULT18X18D": (["MULT18X18D"], 156),
}
ICE40 = {
    "LUT4": (["SB_LUT4"], 5280),
    "FF": (None, 5280),  # every SB_DFF...
    "SB_RAM40_4K": (["SB_RAM40_4K"], 30),
    "SB_MAC16": (["SB_MAC16"], 8),
}
BOARDS = {"ulx3s-85f": ECP5, "up5k": ICE40}
RESOURCES = list(ECP5)
STATIC_ROUNDS = 900  # of nextpnr's static placer; see watch_static


class Failure(Exception):
    """Something the user is told in one sentence."""


def fail(text, status=1):
    print(f"{os.path.basename(sys.argv[0])}: {text}", file=sys.stderr)
    sys.exit(status)


def complaint(command, output, log):
    """What a command that failed said, in one sentence."""
    words = [line for line in output.splitlines() if line.strip()]
    said = next((line for line in words if "ERROR" in line), words[-1] if words else "it said nothing")
    return Failure(f"{' '.join(command[:2])} failed: {said}" + (f" (all of it: {log})" if log else ""))


def run(command, log=None, **options):
    """Runs a command; a Failure names its log, or carries its last words."""
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)
    except OSError as error:
        raise Failure(f"{command[0]}: cannot be started: {error.strerror}") from error
    if log:
        with open(log, "w") as f:
            f.write(done.stdout)
    if done.returncode != 0:
        raise complaint(command, done.stdout, log)
    return done.stdout


def first_line(command):
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    except OSError:
        return None
    return done.stdout.splitlines()[0] if done.stdout else None


def yosys_version(yosys):
    """'0.23' of 'Yosys 0.23 (git sha1 ...)'; None where it does not start."""
    found = re.match(r"Yosys (\d+\.\d+)", first_line([yosys, "-V"]) or "")
    return found.group(1) if found else None


def find_tools(board):
    """Paths and versions of what the board's flow runs: those of make fpga-tools, else of PATH."""
    names = {"ulx3s-85f": ["yosys", "nextpnr-ecp5", "ecppack"], "up5k": ["yosys", "nextpnr-ice40", "icepack"]}[board]
    tools, versions = {}, {}
    for name in names:
        ours = os.path.join(ROOT, "build", "fpga-tools", "bin", name)
        path = ours if board == "ulx3s-85f" and os.access(ours, os.X_OK) else shutil.which(name)
        if not path:
            raise Failure(f"{name} is not there; run 'make fpga-tools'" if board == "ulx3s-85f" else
                          f"{name} is not on PATH; install Debian's package of it")
        tools[name] = path
        version = first_line([path, "-V" if name in ("yosys", "nextpnr-ice40") else "--version"])
        versions[name] = version if version and name != "icepack" else "as the distribution has it"
    return tools, versions


def generate(plan, folder, board, unit=None, clock=None, settings=()):
    """A package for a board, in `folder`; returns what package.json says."""
    command = [PHOTONLOOM, "generate", plan, "--board", board, "-o", folder]
    if unit:
        command += ["--unit", unit]
    if clock:
        command += ["--clock", str(clock)]
    for line in settings:
        command += ["--set", line]
    kept = os.path.join(folder, "build")
    aside = folder.rstrip("/") + ".built"
    shutil.rmtree(aside, ignore_errors=True)
    before = tree(folder)
    times = {path: os.stat(os.path.join(folder, path)).st_mtime_ns for path in before}
    if os.path.isdir(kept):
        os.rename(kept, aside)  # generate replaces the folder; what was built of the same files stays good
    try:
        run(command)
    finally:
        if os.path.isdir(aside):
            if tree(folder) == before:
                os.rename(aside, kept)
                for path, time in times.items():  # or make takes the files for newer than what was built of them
                    os.utime(os.path.join(folder, path), ns=(time, time))
            else:
                shutil.rmtree(aside)
    with open(os.path.join(folder, "package.json")) as f:
        return json.load(f)


def tree(folder):
    """Path -> bytes of all files of a package, what was built apart."""
    files = {}
    for where, folders, names in os.walk(folder):
        if where == folder and "build" in folders:
            folders.remove("build")
        for name in names:
            path = os.path.join(where, name)
            with open(path, "rb") as f:
                files[os.path.relpath(path, folder)] = f.read()
    return files


def digest(folder, tools):
    """SHA-256 of what a package's result depends on: its RTL and constraints, the plan's hash apart, and the tools."""
    text = "".join(f"{path}\0{content!r}\0" for path, content in sorted(tree(folder).items())
                   if path.startswith(("rtl/", "board/")))
    text = re.sub(r"PlanHash = 64'h[0-9a-f]{16}|plan [0-9a-f]{16}", "", text)
    return hashlib.sha256((text + json.dumps(tools)).encode()).hexdigest()


def counts_of(stat_file, board, module):
    """Resources of a module in the JSON of Yosys' stat."""
    with open(stat_file) as f:
        modules = json.load(f)["modules"]
    if "\\" + module not in modules:
        raise Failure(f"{stat_file}: has no module {module}, only {', '.join(modules)}")
    cells = modules["\\" + module]["num_cells_by_type"]
    counts = {}
    for name, (types, _) in BOARDS[board].items():
        counts[name] = sum(n for cell, n in cells.items() if (cell in types if types else cell.startswith("SB_DFF")))
    if board == "ulx3s-85f":
        counts["LUT-eq"] = counts["LUT4"] + 2 * counts["CCU2C"] + 4 * counts["DPR16X4"]
    return counts


def binding(counts, board):
    """The resource of which the part has the least left: (name, used, of)."""
    shares = []
    for name, (_, capacity) in BOARDS[board].items():
        if capacity and name != "LUT4":
            shares.append((counts[name] / capacity, name, counts[name], capacity))
    lut = counts.get("LUT-eq", counts["LUT4"])
    capacity = BOARDS[board]["LUT4"][1]
    shares.append((lut / capacity, "LUT-eq" if "LUT-eq" in counts else "LUT4", lut, capacity))
    _, name, used, of = max(shares)
    return {"resource": name, "used": used, "of": of}


def flow_variables(board, tools):
    if board == "ulx3s-85f":
        return [f"YOSYS={tools['yosys']}", f"NEXTPNR={tools['nextpnr-ecp5']}", f"ECPPACK={tools['ecppack']}"]
    return [f"YOSYS={tools['yosys']}", f"NEXTPNR={tools['nextpnr-ice40']}", f"ICEPACK={tools['icepack']}"]


def synthesise(folder, board, top, module, tools):
    """Counts of `module` in the package's top; its netlist is left in the package's build folder."""
    run(["make", "-C", folder, "synth"] + flow_variables(board, tools), log=folder.rstrip("/") + ".synthesis.log")
    return counts_of(os.path.join(folder, "build", top + ".stat.json"), board, module)


def watch_static(command, log, placer_log):
    """Runs a placement by nextpnr's static placer. False where it does not come to an end: it has been seen to go round with
    the same overlap of block RAMs for ever; a placement that ended took some 600 rounds."""
    with open(log, "w") as out:
        running = subprocess.Popen(command, stdout=out, stderr=subprocess.STDOUT, start_new_session=True)
        try:
            while running.poll() is None:
                time.sleep(2)
                if os.path.isfile(placer_log):
                    with open(placer_log) as f:
                        rounds = re.findall(r"^Info: iter=(\d+) ", f.read(), re.M)
                    if rounds and int(rounds[-1]) > STATIC_ROUNDS:
                        return False
        finally:
            if running.poll() is None:
                os.killpg(running.pid, signal.SIGTERM)
                running.wait()
    if running.returncode != 0:
        with open(log) as f:
            raise complaint(command, f.read(), log)
    return True


def place(folder, board, top, seed, tools, route_speed=None, placer="heap"):
    """Fmax in MHz of each clock and the placed use, with one seed; `.bit` beside it. None where the static placer does not
    end."""
    log = f"{folder.rstrip('/')}.seed{seed}.log"
    command = (["make", "-C", folder, f"SEED={seed}", "NEXTPNR_FLAGS=--timing-allow-fail"] +
               ([f"ROUTE_SPEED={route_speed}"] if route_speed else []) + flow_variables(board, tools))

    def routed_name(placer):  # as in the Makefile
        return (f"{top}_seed{seed}" + (f"_{placer}" if placer != "heap" else "") +
                (f"_route{route_speed}" if route_speed not in (None, 6) else ""))

    if placer == "static":
        placer_log = os.path.join(folder, "build", routed_name(placer) + (".placed" if route_speed not in (None, 6) else "") + ".log")
        if os.path.isfile(placer_log) and not os.path.isfile(os.path.join(folder, "build", routed_name(placer) + ".config")):
            os.remove(placer_log)  # of a run that was cut short
        if not watch_static(command + ["PLACER=static"], log, placer_log):
            return None
    else:
        run(command, log=log)
    routed = routed_name(placer)
    with open(os.path.join(folder, "build", routed + ".json")) as f:
        report = json.load(f)
    clocks = {name: {"achieved": c["achieved"], "constraint": c["constraint"]} for name, c in report["fmax"].items()}
    if not clocks:
        raise Failure(f"{folder}: nextpnr reports no clock")
    return {"seed": seed, "placer": placer, "clocks": clocks, "utilization": report["utilization"],
            "bitstream": os.path.relpath(os.path.join(folder, "build", routed + ".bit"), ROOT)}


def median(values):
    ordered = sorted(values)
    middle = len(ordered) // 2
    return ordered[middle] if len(ordered) % 2 else (ordered[middle - 1] + ordered[middle]) / 2


def markdown(rows, header):
    """A Markdown table."""
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    for row in rows:
        lines.append("| " + " | ".join(str(x) for x in row) + " |")
    return "\n".join(lines) + "\n"


def replace_between(path, mark, text):
    """Puts text between <!-- mark --> and <!-- end of mark --> of a page."""
    with open(path) as f:
        page = f.read()
    start, end = f"<!-- {mark} -->\n", f"<!-- end of {mark} -->"
    if start not in page or end not in page:
        raise Failure(f"{path}: has no marks '{start.strip()}' and '{end}'")
    head, rest = page.split(start, 1)
    tail = rest.split(end, 1)[1]
    with open(path, "w") as f:
        f.write(head + start + text + end + tail)
