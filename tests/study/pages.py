#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures a few rows of docs/studies.md again: each row that a reduced study writes must stand in the page to the letter.

pages.py NAME PHOTONLOOM SOURCE DIR, where NAME is a study. It fails where golden, the memory model or the RTL have changed since the
page was written; `scripts/studies NAME` writes it anew."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

# Of each study: the scene, what is replaced in its file so that few points are left, and which rows do not depend on that.
REDUCED: dict[str, tuple[str, tuple[str, str] | None, str]] = {
    "reordering": ("cornell_balls", (r"(gatherer\.cache_bytes = )\[[^]]*\]", r"\1[131072]"), r"\d×"),
    "layouts": ("cornell_balls", None, r"\d\.\d"),
    "caching": ("cornell", None, r"\d\.\d"),
    "system": ("cornell_balls", (r"(gather\.k = )\[[^]]*\]", r"\1[8]"), r"\d\.\d"),
}


def section(page: str, study: str, scene: str) -> str:
    """The tables of one scene."""
    tables = page.split(f"<!-- {study} -->", 1)[-1].split(f"<!-- end of {study} -->", 1)[0]
    parts = re.split(r"^### .*\b(\w+)$", tables, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2]))[scene]


def rows(tables: str) -> list[str]:
    return [line for line in tables.splitlines() if line.startswith("|") and not set(line) <= set("|- ")]


def main() -> None:
    name, photonloom, source, folder = sys.argv[1], *map(Path, sys.argv[2:])
    scene, change, figures = REDUCED[name]
    text = (source / "studies" / f"{name}.toml").read_text().replace('"../scenes/', f'"{source}/scenes/')
    if change:
        text, count = re.subn(*change, text)
        if not count:
            sys.exit(f"studies/{name}.toml: nothing is like {change[0]}")
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    reduced = folder / f"{name}.toml"
    reduced.write_text(text)
    subprocess.run([photonloom, "study", name, scene, "--study", reduced, "-o", folder / "results"], check=True)
    page = rows(section((source / "docs" / "studies.md").read_text(), name, scene))
    again = [row for row in rows(section((folder / "results" / f"{name}.md").read_text(), name, scene)) if re.search(figures, row)]
    if len(again) < 2:
        sys.exit(f"{name}: the reduced study has {len(again)} rows with figures, expected several")
    lost = [row for row in again if row not in page]
    for row in lost:
        print(f"docs/studies.md, {name} on {scene}: has no row\n  {row}\nthat is measured now; scripts/studies {name} writes the page")
    if lost:
        sys.exit(1)
    print(f"{name}: {len(again)} rows of docs/studies.md on {scene} measured again, the same to the letter")


main()
