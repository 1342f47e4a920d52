# SPDX-License-Identifier: Apache-2.0
"""The programs a proof is made with: those of build/fpga-tools where they are, else those on PATH."""
import os
import shutil
from dataclasses import dataclass
from pathlib import Path

from flow.shell import Failure


@dataclass(frozen=True)
class Tools:
    yosys: str
    abc: str  # the model checker of the synthesis suite


def find(root: Path) -> Tools:
    own = str(root / "build" / "fpga-tools" / "bin")

    def program(*names: str) -> str:
        for path in (own, os.environ.get("PATH")):
            for name in names:
                found = shutil.which(name, path=path)
                if found:
                    return found
        raise Failure(f"{names[0]}: neither in {own} nor on PATH (make formal installs it)")

    return Tools(program("yosys"), program("yosys-abc", "berkeley-abc"))
