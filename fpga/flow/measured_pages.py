# SPDX-License-Identifier: Apache-2.0
"""What pages have of scripts/fpga: tables, of which netlists they are, and whether today's RTL makes these."""
import os
import re
from collections.abc import Mapping
from pathlib import Path

from flow.boards import Board, board_names, read_board
from flow.headline.netlist import SHORT, digest_now
from flow.shell import ROOT, Failure, say
from flow.tables import between, replace_between

README_BOARD = "ulx3s-85f"
README = (ROOT / "README.md", "size and speed")
PAGES = (README, (ROOT / "docs" / "fpga.md", "arty-a7-100t"), (ROOT / "docs" / "fpga.md", "nexys-video"),
         (ROOT / "docs" / "irradiance_cache.md", README_BOARD))
RECORDED = re.compile(r"^Netlists of `([^`]+)`: (.*)\.$", re.MULTILINE)
EARLIER = "Measured with earlier RTL, which may take and reach something else: "
UNRECORDED = "Of which RTL this was measured is not recorded; today's may take and reach something else."


def board_of(mark: str) -> Board:
    return read_board(mark if mark in board_names() else README_BOARD)


def recorded(plan: Path, netlists: Mapping[str, str]) -> str:
    """The line of a plan's netlists; none of a plan that only its user has."""
    if not plan.resolve().is_relative_to(ROOT):
        return ""
    said = ", ".join(f"{name} `{netlist[:SHORT]}`" for name, netlist in netlists.items())
    return f"\nNetlists of `{os.path.relpath(plan.resolve(), ROOT)}`: {said}.\n"


def section(table: str, by: str, plan: Path, netlists: Mapping[str, str]) -> str:
    """What stands between the marks of what was measured just now."""
    return with_age(f"{table}\n{by}.\n{recorded(plan, netlists)}", {name: netlist[:SHORT] for name, netlist in netlists.items()})


def with_age(text: str, today: Mapping[str, str]) -> str:
    """A section that says which of its rows are of earlier RTL. today: part -> the short digest that today's RTL gives."""
    lines = [line for line in text.splitlines() if not line.startswith((EARLIER, UNRECORDED))]
    while lines and not lines[-1]:
        lines.pop()
    if not (found := RECORDED.search(text)):
        return "\n".join([*lines, "", UNRECORDED, ""])
    earlier = [name for name, netlist in netlists_of(found[2]).items() if today.get(name) != netlist]
    return "\n".join([*lines, *(["", EARLIER + ", ".join(f"`{name}`" for name in earlier) + "."] if earlier else []), ""])


def netlists_of(said: str) -> dict[str, str]:
    return dict(re.findall(r"(\w+) `([0-9a-f]+)`", said))


def parts_of(page: Path, mark: str, plan: Path) -> list[str]:
    """The parts that a page's table has of this plan."""
    found = RECORDED.search(between(page, mark))
    return list(netlists_of(found[2])) if found and (ROOT / found[1]).resolve() == plan.resolve() else []


def today_of(text: str, board: Board) -> dict[str, str]:
    """part -> the short digest of its netlist today, of the parts that a section has."""
    if not (found := RECORDED.search(text)):
        return {}
    if not (plan := ROOT / found[1]).is_file():
        raise Failure(f"{found[1]}: there is no such plan, of which a page has the netlists")
    return {name: digest_now(plan, board, unit=None if name == "board" else name)[:SHORT] for name in netlists_of(found[2])}


def render(check: bool) -> None:
    """Has each page say which of its rows are of earlier RTL; check: only tells whether it does."""
    for page, mark in PAGES:
        text = between(page, mark)
        now = with_age(text, today_of(text, board_of(mark)))
        where = f"{os.path.relpath(page, ROOT)}, {mark}"
        if now != text and check:
            raise Failure(f"{where}: does not say which rows are of earlier RTL; scripts/fpga --render writes it")
        if now != text:
            replace_between(page, mark, now)
        of = next((line for line in now.splitlines() if line.startswith((EARLIER, UNRECORDED))), "of today's RTL")
        say(f"{where}: {of}")
