# SPDX-License-Identifier: Apache-2.0
"""Which modules of the RTL words go through, and by which property each is proved: a module that none names, and that does not
stand in tests/formal/unproved.toml with a reason, is a failure."""
import re
import tomllib
from collections.abc import Iterable
from pathlib import Path

from flow.shell import Failure

from .properties import Property

LIST = Path("tests/formal/unproved.toml")

_MODULE = re.compile(r"^module\s+(\w+)(.*?\);)(.*?)^endmodule", re.MULTILINE | re.DOTALL)
_COMMENT = re.compile(r"//[^\n]*")
_PORT = re.compile(r"\b(?:input|output)\b[^,;\n]*?\b\w*(?:valid|ready)")
_INSIDE = {
    "FIFO": re.compile(r"^\s*(?:fifo|ram_fifo|async_fifo)\b", re.MULTILINE),
    "skid buffer": re.compile(r"^\s*skid_buffer\b", re.MULTILINE),
    "arbiter": re.compile(r"^\s*arbiter\b", re.MULTILINE),
    "credits": re.compile(r"\b(credit|room|places)_q\s*<=\s*\1_q\s*[-+]"),
}


def elastic(root: Path) -> dict[str, list[str]]:
    """Modules below root/rtl by name, each with what makes it one: ports of a stream, and what it holds."""
    found: dict[str, list[str]] = {}
    for file in sorted((root / "rtl").rglob("*.sv")):
        for name, head, body in _MODULE.findall(_COMMENT.sub("", file.read_text())):
            kinds = ["ports"] if _PORT.search(head) else []
            kinds += [kind for kind, pattern in _INSIDE.items() if pattern.search(body)]
            if kinds:
                found[name] = kinds
    return found


def unproved(root: Path) -> dict[str, str]:
    """The modules that no property names, each with the reason."""
    try:
        with (root / LIST).open("rb") as stream:
            reasons = tomllib.load(stream).get("module", {})
    except (OSError, tomllib.TOMLDecodeError) as error:
        raise Failure(f"{LIST}: {error}") from error
    for name, reason in reasons.items():
        if not isinstance(reason, str) or not reason:
            raise Failure(f"{LIST}: {name}: expected a reason, found {reason!r}")
    return dict(reasons)


def rows(found: dict[str, list[str]], reasons: dict[str, str], table: Iterable[Property]) -> list[str]:
    """A row of the page for each module; a Failure where one has neither property nor reason, or both, or is gone."""
    by_module: dict[str, list[str]] = {}
    for proved in table:
        by_module.setdefault(proved.module, []).append(proved.name)
    missing = sorted(set(found) - set(by_module) - set(reasons))
    if missing:
        raise Failure(f"{missing[0]}: words go through it, but no property names it, nor does {LIST} say why")
    both = sorted(set(by_module) & set(reasons))
    if both:
        raise Failure(f"{LIST}: {both[0]}: a property names it ({by_module[both[0]][0]})")
    gone = sorted(set(reasons) - set(found))
    if gone:
        raise Failure(f"{LIST}: {gone[0]}: no such module that words go through")
    lines = ["| module | of a stream | properties, or why there is none |", "|---|---|---|"]
    for name, kinds in sorted(found.items()):
        by = ", ".join(f"`{proved}`" for proved in by_module.get(name, [])) or f"none: {reasons[name]}"
        lines.append(f"| `{name}` | {', '.join(kinds)} | {by} |")
    return lines
