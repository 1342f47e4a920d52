# SPDX-License-Identifier: Apache-2.0
"""The programs a proof is made with: those of build/fpga-tools where they are, else those on PATH."""
import os
import shutil
from dataclasses import dataclass
from pathlib import Path

from flow.shell import Failure


@dataclass(frozen=True)
class Tools:
    """Empty where no proof of the run wants it."""
    yosys: str
    abc: str  # the model checker of the synthesis suite
    gappa: str  # bounds of arithmetic


def find(root: Path, methods: set[str]) -> Tools:
    own = str(root / "build" / "fpga-tools" / "bin")

    def program(*names: str) -> str:
        for path in (own, os.environ.get("PATH")):
            for name in names:
                found = shutil.which(name, path=path)
                if found:
                    return found
        raise Failure(f"{names[0]}: neither in {own} nor on PATH (make formal installs it)")

    rtl = bool(methods - {"gappa"})
    return Tools(program("yosys") if rtl else "", program("yosys-abc", "berkeley-abc") if rtl else "",
                 program("gappa") if "gappa" in methods else "")
