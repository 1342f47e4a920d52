# SPDX-License-Identifier: Apache-2.0
"""What a proof reads: the harness, the modules it names, and the same with a planted bug."""
import re
import shutil
import subprocess
from pathlib import Path

from flow.shell import Failure

from .properties import Property

HARNESSES = Path("tests/formal/harness")
SCRIPTS = Path("tests/formal/bounds")
BOUNDS = Path("tests/extremes/suite/steps.bounds")
PACKAGE = HARNESSES / "narrow_pkg.sv"  # packets of the proofs, where a harness has no line '// package: FILE'
BUGS = (Path("tests/formal/bugs"), Path("tests/mutants/rtl"))


def of(root: Path, proved: Property) -> list[Path]:
    """The sources of a property, below root, in the order in which they are read."""
    if proved.method == "gappa":
        script = SCRIPTS / f"{proved.harness}.g"
        if not (root / script).is_file():
            raise Failure(f"property {proved.name}: {script}: no such script")
        return [BOUNDS, script]
    harness = HARNESSES / f"{proved.harness}.sv"
    if not (root / harness).is_file():
        raise Failure(f"property {proved.name}: {harness}: no such harness")
    package = PACKAGE
    named: list[Path] = []
    for line in (root / harness).read_text().splitlines():
        if line.startswith("// sources:"):
            named += [Path(word) for word in line.removeprefix("// sources:").split()]
        if line.startswith("// package:"):
            package = Path(line.removeprefix("// package:").strip())
    missing = [path for path in [package, *named] if not (root / path).is_file()]
    if missing:
        raise Failure(f"{harness}: sources: {missing[0]}: no such file")
    if not named:
        raise Failure(f"{harness}: expected a line '// sources: FILE...'")
    check_package(root, package, [*named, harness])
    return [package, *named, harness]


def check_package(root: Path, package: Path, users: list[Path]) -> None:
    """Yosys tells of a constant that is not there only where it is used, as of something else."""
    declared = set(re.findall(r"\b(\w+)\s*[=;]", (root / package).read_text()))
    for user in users:
        for name in re.findall(r"\bphotonloom_pkg::(\w+)", re.sub(r"//.*", "", (root / user).read_text())):
            if name not in declared:
                raise Failure(f"{package}: has no {name}, which {user} reads")


def bug_file(root: Path, proved: Property) -> Path:
    for folder in BUGS:
        if (root / folder / f"{proved.bug}.patch").is_file():
            return folder / f"{proved.bug}.patch"
    raise Failure(f"property {proved.name}: bug: there is no {proved.bug}.patch in {' or '.join(map(str, BUGS))}")


def plant(root: Path, proved: Property, sources: list[Path], folder: Path) -> None:
    """Copies the sources into folder and plants the property's bug in the copies."""
    patch = bug_file(root, proved)
    shutil.rmtree(folder, ignore_errors=True)
    for source in sources:
        (folder / source).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(root / source, folder / source)
    done = subprocess.run(["patch", "-s", "-p1", "--no-backup-if-mismatch", "-d", str(folder), "-i", str((root / patch).resolve())],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, text=True)
    if done.returncode != 0:
        raise Failure(f"{patch}: does not apply to the sources of {proved.harness}: {done.stdout.strip()}")
