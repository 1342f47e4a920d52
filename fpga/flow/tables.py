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


def around(path: Path, mark: str) -> tuple[str, str]:
    """What stands before and after what is between <!-- mark --> and <!-- end of mark --> of a page, the marks among it."""
    page = read_text(path)
    start, end = f"<!-- {mark} -->\n", f"<!-- end of {mark} -->"
    if start not in page or end not in page:
        raise Failure(f"{path}: has no marks '{start.strip()}' and '{end}'")
    head, rest = page.split(start, 1)
    return head + start, end + rest.split(end, 1)[1]


def between(path: Path, mark: str) -> str:
    """What stands between the marks."""
    head, tail = around(path, mark)
    return read_text(path)[len(head):-len(tail)]


def replace_between(path: Path, mark: str, text: str) -> None:
    """Puts text between <!-- mark --> and <!-- end of mark --> of a page."""
    head, tail = around(path, mark)
    path.write_text(head + text + tail)
