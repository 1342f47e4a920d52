# SPDX-License-Identifier: Apache-2.0
"""The digest of what a routed top was made from: RTL and constraints of its package.

RTL is taken as Verilator elaborates it, parameters and generate blocks resolved, so that neither comments, names, the place of a
text in its file nor what this top does not generate change the digest. Attributes, which tell Yosys what a memory is made
of, are not in that and are taken from the text. The plan's hash is left out, which also changes where no net does."""
import hashlib
import re
import tempfile
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator, Sequence, Set
from pathlib import Path
from xml.etree.ElementTree import Element

from flow.boards import Board
from flow.package import generate, tree
from flow.shell import Failure, first_line, run

# A string, in which // is no comment, or a comment.
VERILOG = re.compile(r'("(?:\\.|[^"\\])*")|//[^\n]*|/\*.*?\*/', re.S)
ATTRIBUTE = re.compile(r"\(\*\s*\w[^;]*;", re.S)  # and what it is of
PLAN_HASH = re.compile(r"PlanHash = 64'h[0-9a-f]{16}")
SHORT = 12  # digits of a digest on the page
# What Verilator says of an element beside what it is: where it stands, and names, which are numbers in the digest.
LEFT_OUT = {"loc", "name", "origName", "dtype_id", "sub_dtype_id", "id", "pinIndex", "portIndex", "defName", "topModule", "vartype"}
SCOPES = {"module", "package", "func", "begin"}
NAMED = {"const", "memberdtype", "structsel", "varxref", "basicdtype", "port", "enumitem"}  # whose name says what they are


def without_comments(path: str, text: str) -> str:
    """The text of a file of a package, its comments left out and every blank the same. In constraints and scripts a comment
    is a line of its own."""
    if path.endswith((".sv", ".v")):
        text = VERILOG.sub(lambda found: found.group(1) or " ", text)
    else:
        text = "\n".join(line for line in text.splitlines() if not line.lstrip().startswith("#"))
    return " ".join(text.split())


class Elaboration:
    """The words of a design in Verilator's XML, equal for designs that differ in names only. A module has the number of its
    first instance, a variable that of its first use in its module; one that is assigned another is that other.
    primitives: modules of the part, whose parameters say what they do; those of others are resolved."""

    def __init__(self, netlist: Element, primitives: Set[str]) -> None:
        self.modules = {module.get("name", ""): module for module in netlist.iter("module")}
        self.packages = list(netlist.iter("package"))
        self.primitives = primitives
        table = netlist.find("typetable")
        self.types = {kind.get("id"): kind for kind in table} if table is not None else {}
        self.type_words: dict[str | None, str] = {}
        self.numbers: dict[str, int] = {}
        self.waiting: list[str] = []

    def words(self, top: str) -> Iterator[str]:
        for package in self.packages:
            yield from ModuleWords(self, package).words()
        self.number(top)
        while self.waiting:
            yield from ModuleWords(self, self.modules[self.waiting.pop(0)]).words()

    def number(self, module: str) -> str:
        """Of a module, which is told of if it has not been."""
        if module not in self.modules:
            raise Failure(f"Verilator's XML has an instance of {module}, expected the module too")
        if module not in self.numbers:
            self.numbers[module] = len(self.numbers)
            self.waiting.append(module)
        return str(self.numbers[module])

    def type_of(self, kind: str | None) -> str:
        if kind not in self.type_words:
            found = self.types.get(kind)
            self.type_words[kind] = "" if found is None else self.type_text(found)
        return self.type_words[kind]

    def type_text(self, kind: Element) -> str:
        of = self.type_of(kind.get("sub_dtype_id")) if "sub_dtype_id" in kind.attrib else ""
        return f"{kind.tag}{said(kind)}{of}{[self.type_text(child) for child in kind]}"


def said(element: Element) -> list[str]:
    """What an element is, beside where it stands and its name, where that is one."""
    return [f"{key}={value}" for key, value in sorted(element.attrib.items())
            if key not in LEFT_OUT or (key == "name" and element.tag in NAMED)]


class ModuleWords:
    """The words of one module. A variable is known by its scope, a module, function or block, and its name."""
    Variable = tuple[int, str]

    def __init__(self, design: Elaboration, module: Element) -> None:
        self.design, self.module = design, module
        self.primitive = module.get("origName") in design.primitives
        self.declared: dict[int, set[str]] = {}
        self.same: dict[ModuleWords.Variable, ModuleWords.Variable] = {}
        self.used: dict[ModuleWords.Variable, int] = {}
        self.find_same(module, [])

    def words(self) -> Iterator[str]:
        yield "module"
        yield from self.inner(self.module, [self.module])

    def variable(self, element: Element, scopes: Sequence[Element]) -> Variable:
        name = element.get("name", "")
        variable = (next((id(scope) for scope in reversed(scopes) if name in self.declared[id(scope)]), 0), name)
        while variable in self.same:
            variable = self.same[variable]
        return variable

    def find_same(self, element: Element, scopes: Sequence[Element]) -> None:
        if element.tag in SCOPES:
            scopes = [*scopes, element]
            self.declared[id(element)] = {v.get("name", "") for v in element if v.tag == "var"}
        if self.is_alias(element):
            source, target = (self.variable(side, scopes) for side in element)
            if source != target:
                self.same[target] = source
        for child in element:
            self.find_same(child, scopes)

    def is_alias(self, element: Element) -> bool:
        sides = list(element)
        return (element.tag == "contassign" and all(side.tag == "varref" for side in sides) and
                len({self.design.type_of(side.get("dtype_id")) for side in sides}) == 1)

    def inner(self, element: Element, scopes: Sequence[Element]) -> Iterator[str]:
        for child in element:
            yield from self.element_words(child, scopes)

    def element_words(self, element: Element, scopes: Sequence[Element]) -> Iterator[str]:
        tag = element.tag
        if tag == "begin":  # also a generate block that was taken
            yield from self.inner(element, [*scopes, element])
            return
        kept = "dir" in element.attrib or (self.primitive and "param" in element.attrib)
        if tag == "typedef" or (tag == "var" and not kept) or self.is_alias(element):
            return  # is known where it is used
        words = [tag, *said(element)]
        if "dtype_id" in element.attrib:
            words.append(self.design.type_of(element.get("dtype_id")))
        if tag == "instance":
            words.append(self.design.number(element.get("defName", "")))
        if tag in ("func", "funcref", "var"):  # a port is called by its name
            words.append(element.get("name", ""))
        if tag in ("var", "varref"):
            variable = self.variable(element, scopes)
            words.append(str(self.used.setdefault(variable, len(self.used))))
        yield " ".join(words)
        yield from self.inner(element, [*scopes, element] if tag in SCOPES else scopes)
        yield "end"


def elaborate(folder: Path, top: str) -> str:
    """The words of a package's design. Its plan's hash is that of no plan."""
    with tempfile.TemporaryDirectory() as work:
        for path, content in sorted(tree(folder).items()):
            if path.endswith((".sv", ".v")):
                copy = Path(work, path)
                copy.parent.mkdir(parents=True, exist_ok=True)
                copy.write_text(PLAN_HASH.sub("PlanHash = 64'h0", content.decode()))
        models = sorted(Path(work, "board", "models").glob("*.sv"))
        files = [f"{work}/{name}" for name in (folder / "files.f").read_text().split()] + [str(path) for path in models]
        run(["verilator", "--xml-only", "-DSYNTHESIS", "-Wno-lint", "-Wno-style", "-Wno-fatal", "--top-module", top, "--Mdir", f"{work}/made",
             *files])
        netlist = ElementTree.parse(Path(work, "made", f"V{top}.xml")).getroot().find("netlist")
    if netlist is None:
        raise Failure(f"{folder}: {first_line(['verilator', '--version'])} wrote no netlist of {top}")
    return "\n".join(Elaboration(netlist, {path.stem for path in models}).words(top))


def netlist_digest(folder: Path) -> str:
    """SHA-256 of a package's design and board."""
    files = {path: content.decode() for path, content in sorted(tree(folder).items()) if path.startswith(("rtl/", "board/"))}
    texts = {path: without_comments(path, text) for path, text in files.items()}
    script = texts["board/synth.ys"]
    top = re.findall(r"-top (\w+)", script)
    if not top:
        raise Failure(f"{folder}/board/synth.ys: names no top, expected -top and a module")
    parts = [elaborate(folder, top[0])]
    for path, text in texts.items():
        if path.startswith("rtl/"):
            parts += [f"{path} {attribute}" for attribute in ATTRIBUTE.findall(text)]
        elif path == "board/synth.ys":
            parts.append(re.sub(r"read_verilog -sv( [\w/.]+\.sv)+", "", text))
        elif not path.startswith("board/models/"):
            parts.append(f"{path} {text}")
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


def digest_now(plan: Path, board: Board, clock_mhz: float | None = None) -> str:
    """The digest of what today's RTL makes of a plan's board."""
    with tempfile.TemporaryDirectory() as folder:
        generate(plan, Path(folder, "board"), board, None, clock_mhz)
        return netlist_digest(Path(folder, "board"))
