# SPDX-License-Identifier: Apache-2.0
"""Markdown of reports and pages."""
from collections.abc import Iterable, Sequence
from pathlib import Path

from flow.shell import Failure, read_text


def markdown(rows: Iterable[Sequence[object]], header: Sequence[str]) -> str:
    """A Markdown table."""
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    for row in rows:
        lines.append("| " + " | ".join(str(cell) for cell in row) + " |")
    return "\n".join(lines) + "\n"


def replace_between(path: Path, mark: str, text: str) -> None:
    """Puts text between <!-- mark --> and <!-- end of mark --> of a page."""
    page = read_text(path)
    start, end = f"<!-- {mark} -->\n", f"<!-- end of {mark} -->"
    if start not in page or end not in page:
        raise Failure(f"{path}: has no marks '{start.strip()}' and '{end}'")
    head, rest = page.split(start, 1)
    tail = rest.split(end, 1)[1]
    path.write_text(head + start + text + end + tail)
