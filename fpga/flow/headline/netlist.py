# SPDX-License-Identifier: Apache-2.0
"""The digest of what a routed top was made from: RTL and constraints of its package without their comments, and so without
the tools. The plan's hash is left out, which also changes where no net does."""
import hashlib
import re
import tempfile
from pathlib import Path

from flow.boards import Board
from flow.package import generate, tree

# A string, in which // is no comment, or a comment.
VERILOG = re.compile(r'("(?:\\.|[^"\\])*")|//[^\n]*|/\*.*?\*/', re.S)
PLAN_HASH = re.compile(r"PlanHash = 64'h[0-9a-f]{16}")
SHORT = 12  # digits of a digest on the page


def without_comments(path: str, text: str) -> str:
    """The text of a file of a package, its comments left out and every blank the same. In constraints and scripts a comment
    is a line of its own."""
    if path.endswith((".sv", ".v")):
        text = PLAN_HASH.sub("", VERILOG.sub(lambda found: found.group(1) or " ", text))
    else:
        text = "\n".join(line for line in text.splitlines() if not line.lstrip().startswith("#"))
    return " ".join(text.split())


def netlist_digest(folder: Path) -> str:
    """SHA-256 of a package's rtl and board."""
    parts = [f"{path}\0{without_comments(path, content.decode())}\0" for path, content in sorted(tree(folder).items())
             if path.startswith(("rtl/", "board/"))]
    return hashlib.sha256("".join(parts).encode()).hexdigest()


def digest_now(plan: Path, board: Board, clock_mhz: float | None = None) -> str:
    """The digest of what today's RTL makes of a plan's board."""
    with tempfile.TemporaryDirectory() as folder:
        generate(plan, Path(folder, "board"), board, None, clock_mhz)
        return netlist_digest(Path(folder, "board"))
