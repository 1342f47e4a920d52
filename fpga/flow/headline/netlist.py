# SPDX-License-Identifier: Apache-2.0
"""The digest of what a routed top was made from: RTL and constraints of its package.

RTL is taken as Verilator elaborates it, parameters and generate blocks resolved, so that neither comments, the order of a text, another
name for the same wire nor what this top does not generate change the digest, nor a wire that nothing reads with what drives it,
unless that is a process, nor a port of a module within that nothing needs. Attributes, which tell Yosys what a memory is made
of, are not in that and are taken from the text. The plan's hash is left out, which also changes where no net does. Another version of
Verilator may elaborate otherwise: digests are those of Debian 12's, which the set-up installs."""
import hashlib
import re
import tempfile
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator, Sequence, Set
from pathlib import Path
from xml.etree.ElementTree import Element

from flow.boards import Board
from flow.headline.plans import HeadlinePlan
from flow.package import generate, tree
from flow.shell import Failure, first_line, run

# A string, in which // is no comment, or a comment.
VERILOG = re.compile(r'("(?:\\.|[^"\\])*")|//[^\n]*|/\*.*?\*/', re.S)
ATTRIBUTE = re.compile(r"\(\*\s*\w[^;]*?\*\)[^;(]*", re.S)  # and what it is of, of an instance without its pins
PLAN_HASH = re.compile(r"PlanHash = 64'h[0-9a-f]{16}")
UNNAMED = re.compile(r"^unnamedblk\d+$")  # a block with variables of its own, which Verilator counts through a module
SHORT = 12  # digits of a digest on the page
# What Verilator says of an element beside what it is: where it stands, and names and numbers of its own.
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
    """A design in Verilator's XML. primitives: modules of the part, whose parameters say what they do; those of others are
    resolved."""

    def __init__(self, netlist: Element, primitives: Set[str]) -> None:
        self.modules = {module.get("name", ""): module for module in netlist.iter("module")}
        self.packages = list(netlist.iter("package"))
        self.primitives = primitives
        self.read_from_outside = {found.get("name", "") for found in netlist.iter("varxref")}  # by a path through a block's or a module's name
        table = netlist.find("typetable")
        self.types = {kind.get("id"): kind for kind in table} if table is not None else {}
        self.type_texts: dict[str | None, str] = {}
        self.texts: dict[tuple[str, frozenset[str]], ModuleText] = {}

    def text(self, top: str) -> str:
        return "\n".join([*(ModuleText(self, package).text() for package in self.packages), self.instance_of(top).digest()])

    def instance_of(self, module: str, open_outputs: frozenset[str] = frozenset()) -> "ModuleText":
        """A module where these of its outputs go nowhere, and all within it."""
        if module not in self.modules:
            raise Failure(f"Verilator's XML has an instance of {module}, expected the module too")
        key = (module, open_outputs)
        if key not in self.texts:
            self.texts[key] = ModuleText(self, self.modules[module], open_outputs)
        return self.texts[key]

    def type_of(self, kind: str | None) -> str:
        if kind not in self.type_texts:
            found = self.types.get(kind)
            self.type_texts[kind] = "" if found is None else self.type_text(found)
        return self.type_texts[kind]

    def type_text(self, kind: Element) -> str:
        of = self.type_of(kind.get("sub_dtype_id")) if "sub_dtype_id" in kind.attrib else ""
        return f"{kind.tag}{said(kind)}{of}{[self.type_text(child) for child in kind]}"


def said(element: Element) -> list[str]:
    """What an element is, beside where it stands and its name, where that is one."""
    return [f"{key}={value}" for key, value in sorted(element.attrib.items())
            if key not in LEFT_OUT or (key == "name" and element.tag in NAMED)]


class ModuleText:
    """The text of one module, of whose outputs some go nowhere. A variable is known by its scope, a module, function or block, and
    its name; one that is assigned another is that other."""
    Variable = tuple[int, str]

    def __init__(self, design: Elaboration, module: Element, open_outputs: frozenset[str] = frozenset()) -> None:
        self.design, self.module, self.open_outputs = design, module, open_outputs
        self.primitive = module.get("origName") in design.primitives
        self.declared: dict[int, set[str]] = {}
        self.order: dict[ModuleText.Variable, tuple[bool, int, int]] = {}  # no port, how many scopes deep, which of all
        self.paths: dict[int, str] = {}
        self.same: dict[ModuleText.Variable, ModuleText.Variable] = {}
        self.find_same(module, [])
        self.unread: set[ModuleText.Variable] = set()
        self.idle: set[str] = set()
        self.find_unread()
        self.kept_digest: str | None = None

    def digest(self) -> str:
        if self.kept_digest is None:
            self.kept_digest = hashlib.sha256(self.text().encode()).hexdigest()
        return self.kept_digest

    def find_unread(self) -> None:
        """unread: wires that nothing reads, and outputs that go nowhere, unless a process drives them; idle: ports that the module could
        do without. What drives such a wire reads nothing either, so they are looked for until no more are found."""
        if self.primitive:
            return
        elements = list(self.elements(self.module, [self.module]))
        ports = [(port.get("dir"), port.get("name", "")) for port in self.module if port.tag == "var" and "dir" in port.attrib]
        outside = {self.variable_of(name, [self.module]) for way, name in ports if way != "input" and name not in self.open_outputs}
        outside |= {self.representative((scope, name)) for scope, names in self.declared.items() for name in names & self.design.read_from_outside}
        before, read = None, outside
        while before != self.unread:
            before = self.unread
            parts = [(part, scopes) for element, scopes in elements for part in self.parts(element, scopes)]
            read = outside.union(*(self.read(part, scopes) for part, scopes in parts))
            self.unread = {wire for part, scopes in parts if (wire := self.driven(part, scopes))} - read
        for way, name in ports:
            variable, own = self.variable_of(name, [self.module]), (id(self.module), name)
            if name in self.open_outputs and (variable in self.unread or variable != own):
                self.idle.add(name)
            elif way == "input" and variable == own and variable not in read:
                self.idle.add(name)

    def elements(self, element: Element, scopes: Sequence[Element]) -> Iterator[tuple[Element, Sequence[Element]]]:
        """All that works at a time, and where."""
        for child in element:
            if child.tag == "begin":  # a generate block that was taken
                yield from self.elements(child, [*scopes, child])
            elif child.tag not in ("var", "typedef") and not self.is_alias(child):
                yield child, scopes

    def parts(self, element: Element, scopes: Sequence[Element]) -> list[Element]:
        """An assignment, a process, the pins of an instance that its module does not do without."""
        if element.tag != "instance":
            return [element]
        idle = self.instance_of(element, scopes).idle
        return [pin for pin in element if pin.get("name") not in idle or pin.get("direction") == "out"]

    def driven(self, part: Element, scopes: Sequence[Element]) -> "ModuleText.Variable | None":
        """The wire that an assignment or a pin drives, and nothing else does with it: the last of its children, or a part of that. What
        is constant is driven once at the beginning."""
        if part.tag == "initial" and len(part) == 1 and part[0].tag == "assign":
            part = part[0]
        elif part.tag != "contassign" and not (part.tag == "port" and part.get("direction") == "out" and len(part) == 1):
            return None
        wire = part[-1]
        while wire.tag in ("sel", "arraysel", "structsel"):
            wire = wire[0]
        return self.variable(wire, scopes) if wire.tag == "varref" else None

    def read(self, part: Element, scopes: Sequence[Element]) -> set[Variable]:
        wire = self.driven(part, scopes)
        return set() if wire in self.unread else {self.variable(found, scopes) for found in part.iter("varref")} - {wire}

    def instance_of(self, element: Element, scopes: Sequence[Element]) -> "ModuleText":
        """The module of an instance. An output goes nowhere where it is not connected, or to a wire that nothing reads."""
        nowhere = {pin.get("name", "") for pin in element if pin.get("direction") == "out" and
                   (len(pin) == 0 or self.driven(pin, scopes) in self.unread)}
        return self.design.instance_of(element.get("defName", ""), frozenset(nowhere))

    def text(self) -> str:
        """Of all that works at a time, in an order of its own."""
        return "\n".join(sorted(filter(None, self.concurrent(self.module, [self.module]))))

    def concurrent(self, element: Element, scopes: Sequence[Element]) -> Iterator[str]:
        for child in element:
            if child.tag == "begin":  # a generate block that was taken
                yield from self.concurrent(child, [*scopes, child])
            else:
                yield self.element_text(child, scopes)

    def variable(self, element: Element, scopes: Sequence[Element]) -> Variable:
        return self.variable_of(element.get("name", ""), scopes)

    def variable_of(self, name: str, scopes: Sequence[Element]) -> Variable:
        return self.representative((next((id(scope) for scope in reversed(scopes) if name in self.declared[id(scope)]), 0), name))

    def representative(self, variable: Variable) -> Variable:
        while variable in self.same:
            variable = self.same[variable]
        return variable

    def find_same(self, element: Element, scopes: Sequence[Element]) -> None:
        if element.tag in SCOPES:
            scopes = [*scopes, element]
            variables = [child for child in element if child.tag == "var"]
            self.declared[id(element)] = {v.get("name", "") for v in variables}
            self.paths[id(element)] = ".".join(UNNAMED.sub("", scope.get("name", "")) for scope in scopes[1:])
            for v in variables:
                self.order[id(element), v.get("name", "")] = ("dir" not in v.attrib, len(scopes), len(self.order))
        if self.is_alias(element):
            first, second = sorted((self.variable(side, scopes) for side in element), key=self.order.__getitem__)
            if first != second:
                self.same[second] = first
        for child in element:
            self.find_same(child, scopes)

    def is_alias(self, element: Element) -> bool:
        sides = list(element)
        return (element.tag == "contassign" and all(side.tag == "varref" for side in sides) and
                len({self.design.type_of(side.get("dtype_id")) for side in sides}) == 1)

    def element_text(self, element: Element, scopes: Sequence[Element]) -> str:
        tag = element.tag
        kept = ("dir" in element.attrib and element.get("name") not in self.idle) or (self.primitive and "param" in element.attrib)
        if tag == "typedef" or (tag == "var" and not kept) or self.is_alias(element):
            return ""  # is known where it is used
        if element.tag in ("contassign", "initial") and self.driven(element, scopes) in self.unread:
            return ""
        words = [tag, *said(element)]
        children = list(element)
        if "dtype_id" in element.attrib:
            words.append(self.design.type_of(element.get("dtype_id")))
        if tag == "instance":
            instance = self.instance_of(element, scopes)
            words.append(instance.digest())
            children = [pin for pin in element if pin.get("name") not in instance.idle]
        if tag in ("func", "funcref", "var"):  # a port is called by its name
            words.append(element.get("name", ""))
        if tag in ("var", "varref"):
            scope, name = self.variable(element, scopes)
            words.append(f"{self.paths.get(scope, '')}.{name}")
        within = [*scopes, element] if tag in SCOPES else scopes
        return f"({' '.join(words)}{''.join(self.element_text(child, within) for child in children)})"


def elaborate(folder: Path, top: str) -> str:
    """The text of a package's design. Its plan's hash is that of no plan."""
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
    return Elaboration(netlist, {path.stem for path in models}).text(top)


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


def digest_now(plan: Path, board: Board, clock_mhz: float | None = None, unit: str | None = None) -> str:
    """The digest of what today's RTL makes of a plan's board, or of a unit of it alone."""
    with tempfile.TemporaryDirectory() as folder:
        generate(plan, Path(folder, "package"), board, unit, clock_mhz)
        return netlist_digest(Path(folder, "package"))


def plan_digest(plan: HeadlinePlan, board: Board) -> str:
    """The digest of a headline plan's board today, at the clock that its core is asked for."""
    return digest_now(plan.path, board, plan.clock)
