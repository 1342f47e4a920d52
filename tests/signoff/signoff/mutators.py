# SPDX-License-Identifier: Apache-2.0
"""Mutations of SystemVerilog source: another operator, another constant, another condition.

What is mutated is what the hardware computes: right sides of assignments, conditions of if, expressions at the ports of instances.
Parameters, ranges, indices, loops, generate blocks, assertions, what is read from constants alone and what only synthesis reads stay as
they are."""
import re
from dataclasses import dataclass

from flow.shell import Failure

_TOKEN = re.compile(
    r"(?P<space>\s+|//[^\n]*|/\*.*?\*/|\(\*.*?\*\))"
    r"|(?P<text>\"(?:\\.|[^\"\\])*\")"
    r"|(?P<number>\d*'s?[bdhoBDHO][0-9a-fA-FxXzZ_?]+|'[01xzXZ](?![0-9a-zA-Z_({])|\d[\d_]*)"
    r"|(?P<name>[A-Za-z_$`][\w$]*(?:::[A-Za-z_]\w*)*)"
    r"|(?P<mark><<<=|>>>=|<<<|>>>|<<=|>>=|===|!==|==\?|!=\?|<=|>=|==|!=|&&|\|\||<<|>>|\+:|-:|\+\+|--|\+=|-=|\*=|&=|\|=|\^=|\*\*|~&|~\||~\^|->|[-+*/%&|^~!<>=?:;,.(){}\[\]#@'])",
    re.DOTALL)
_OPEN = {"(": ")", "[": "]", "{": "}"}
_TYPES = {"logic", "int", "integer", "bit", "byte", "reg", "wire", "genvar", "typedef", "localparam", "parameter", "import", "unsigned",
          "signed", "var", "longint", "shortint"}
# A binary operator, and what else it might have been.
OTHER = {"+": ("-",), "-": ("+",), "*": ("+",), "<": ("<=", ">="), "<=": ("<", ">"), ">": (">=", "<="), ">=": (">", "<"), "==": ("!=",),
         "!=": ("==",), "&&": ("||",), "||": ("&&",), "&": ("|",), "|": ("&",), "^": ("|",), "<<": (">>",), ">>": ("<<",), ">>>": (">>",)}


@dataclass(frozen=True)
class Token:
    kind: str
    text: str
    start: int
    end: int


@dataclass(frozen=True)
class Region:
    """An expression, as the places of its tokens, and whether it is the condition of an if."""
    first: int
    last: int  # behind it
    condition: bool


@dataclass(frozen=True)
class Mutant:
    file: str  # of rtl
    line: int
    start: int  # of the whole expression in the file
    end: int
    was: str  # the whole expression
    now: str
    what: str  # the change in words


def tokens_of(text: str, file: str) -> list[Token]:
    found = []
    at = 0
    while at < len(text):
        match = _TOKEN.match(text, at)
        if not match:
            raise Failure(f"{file}, line {text.count(chr(10), 0, at) + 1}: expected SystemVerilog, found {text[at:at + 20]!r}")
        # (* opens an attribute; in @(*) it is none.
        if match.lastgroup == "space" and match[0].startswith("(*)"):
            match = re.compile(r"(?P<mark>\()").match(text, at)
            assert match
        if match.lastgroup != "space":
            found.append(Token(str(match.lastgroup), match[0], at, match.end()))
        at = match.end()
    return found


class Reader:
    """Finds the expressions of a module."""

    def __init__(self, text: str, file: str) -> None:
        self.file = file
        self.text = text
        self.tokens = tokens_of(text, file)
        self.regions: list[Region] = []
        self.header = 0  # where the module's header ends in the text
        self.elaborated: set[int] = set()  # lines of such functions
        # Names of functions that parameters are made with, and so may not depend on what is chosen at run time.
        self.constant = {name for line in re.findall(r"(?:localparam|parameter)[^;]*", text) for name in re.findall(r"(\w+)\(", line)}
        self._module()

    def at(self, place: int) -> str:
        return self.tokens[place].text if place < len(self.tokens) else ""

    def fail(self, place: int, expected: str) -> Failure:
        line = self.text.count("\n", 0, self.tokens[min(place, len(self.tokens) - 1)].start) + 1
        return Failure(f"{self.file}, line {line}: expected {expected}, found {self.at(place)!r}")

    def closing(self, place: int) -> int:
        """The place behind the bracket that closes the one here."""
        want = [_OPEN[self.at(place)]]
        while want:
            place += 1
            if place >= len(self.tokens):
                raise self.fail(place, want[-1])
            if self.at(place) in _OPEN:
                want.append(_OPEN[self.at(place)])
            elif self.at(place) == want[-1]:
                want.pop()
        return place + 1

    def until(self, place: int, marks: set[str]) -> int:
        """The place of the first of these marks outside brackets."""
        while self.at(place) not in marks:
            if place >= len(self.tokens):
                raise self.fail(place, " or ".join(sorted(marks)))
            place = self.closing(place) if self.at(place) in _OPEN else place + 1
        return place

    def _module(self) -> None:
        place = 0
        while self.at(place) != "module":
            place += 1
            if place >= len(self.tokens):
                raise self.fail(place, "module")
        place = self.until(place, {";"}) + 1
        self.header = self.tokens[place - 1].end
        while self.at(place) != "endmodule":
            place = self._item(place)

    def _item(self, place: int) -> int:
        word = self.at(place)
        if word == "function":
            begin = place
            name_at = self.until(place, {"(", ";"}) - 1
            constant = self.at(name_at) in self.constant
            place = self.until(place, {";"}) + 1
            kept = len(self.regions)
            while self.at(place) != "endfunction":
                place = self._statement(place)
            if constant:
                del self.regions[kept:]
                first, last = (self.text.count("\n", 0, self.tokens[at].start) + 1 for at in (begin, place))
                self.elaborated.update(range(first, last + 1))
            return place + 1
        if word in ("always_ff", "always_comb", "always_latch", "always"):
            place += 1
            if self.at(place) == "@":
                place = self.closing(place + 1)
            return self._statement(place)
        if word in ("initial", "final"):
            kept = len(self.regions)
            place = self._statement(place + 1)
            del self.regions[kept:]
            return place
        if word == "assign":
            equals = self.until(place, {"="})
            end = self.until(equals + 1, {";"})
            self.regions.append(Region(equals + 1, end, False))
            return end + 1
        if word in ("for", "if", "case") or word in ("unique", "priority"):
            if word in ("unique", "priority"):
                place += 1
            return self.closing(place + 1)
        if word in ("begin", "end"):
            return place + 3 if self.at(place + 1) == ":" else place + 1
        if word in ("else", "generate", "endgenerate", "endcase", "default", ":", ";"):
            return place + 1
        if self.at(place + 1) == ":" and self.tokens[place].kind in ("name", "number"):
            return place + 2
        if word in ("`else", "`endif", "`ifndef"):
            return place + (2 if word == "`ifndef" else 1)
        if word == "`ifdef":
            # What synthesis alone reads is not simulated here; netlists are (docs/netlist.md).
            kept = len(self.regions)
            place += 2
            while self.at(place) not in ("`else", "`endif"):
                place = self._item(place)
            del self.regions[kept:]
            return place
        if word in _TYPES or "::" in word:
            return self.until(place, {";"}) + 1
        if word in ("assert", "assume", "cover"):
            return self.until(place, {";"}) + 1
        if self.tokens[place].kind == "name":
            return self._instance(place)
        raise self.fail(place, "an item of a module")

    def _instance(self, place: int) -> int:
        end = self.until(place, {";"})
        place += 1
        if self.at(place) == "#":
            place = self.closing(place + 1)
        while place < end and self.at(place) != "(":
            place = self.closing(place) if self.at(place) == "[" else place + 1
        if place >= end:  # a declaration by a type's name
            return end + 1
        place += 1
        while place < end:
            if self.at(place) == "." and self.at(place + 2) == "(":
                behind = self.closing(place + 2)
                # An output's expression is a place to write to.
                if not self.at(place + 1).endswith("_o") and self.at(place + 1) not in ("clk_i", "rst_i"):
                    self.regions.append(Region(place + 3, behind - 1, False))
                place = behind
            else:
                place += 1
        return end + 1

    def _statement(self, place: int) -> int:
        word = self.at(place)
        if word == ";":
            return place + 1
        if word == "begin":
            place += 1
            if self.at(place) == ":":
                place += 2
            while self.at(place) != "end":
                place = self._statement(place)
            place += 1
            return place + 2 if self.at(place) == ":" else place
        if word in ("unique", "priority"):
            return self._statement(place + 1)
        if word == "if":
            behind = self.closing(place + 1)
            if (self.at(place + 2), behind) != ("rst_i", place + 4):
                self.regions.append(Region(place + 2, behind - 1, True))
            place = self._statement(behind)
            return self._statement(place + 1) if self.at(place) == "else" else place
        if word in ("case", "casez"):
            place = self.closing(place + 1)
            while self.at(place) != "endcase":
                place = self._statement(self.until(place, {":"}) + 1)
            return place + 1
        if word in ("for", "repeat", "while"):
            return self._statement(self.closing(place + 1))
        end = self.until(place, {";"})
        if word not in ("assert", "assume", "cover") and word not in _TYPES and "::" not in word and not word.startswith("$"):
            equals = self.until(place, {"=", "<=", ";", "++", "+=", "-="})
            if self.at(equals) in ("=", "<="):
                self.regions.append(Region(equals + 1, end, False))
        return end + 1


def _binary(tokens: list[Token], place: int, first: int) -> bool:
    """Whether an operator here has something to its left."""
    if place == first:
        return False
    before = tokens[place - 1]
    return before.kind in ("name", "number") or before.text in (")", "]", "}")


def _constant(text: str) -> str | None:
    """Another constant of the same width."""
    if text in ("'0", "'1"):
        return "'1" if text == "'0" else "'0"
    if re.fullmatch(r"\d[\d_]*", text):
        return "1" if int(text.replace("_", "")) == 0 else str(int(text.replace("_", "")) - 1)
    sized = re.fullmatch(r"(\d*)'([bdh])([0-9a-fA-F_]+)", text)
    if not sized:
        return None
    base = {"b": 2, "d": 10, "h": 16}[sized[2]]
    value = int(sized[3].replace("_", ""), base) ^ 1
    digits = {"b": f"{value:b}", "d": str(value), "h": f"{value:x}"}[sized[2]]
    return f"{sized[1]}'{sized[2]}{digits}"


def _in_brackets(reader: Reader, region: Region) -> set[int]:
    """Places between [ and ], and those of counts and widths: {N{...}}, N'(...)."""
    inside: set[int] = set()
    place = region.first
    while place < region.last:
        text = reader.at(place)
        if text == "[":
            behind = reader.closing(place)
            inside.update(range(place, behind))
            place = behind
            continue
        if text == "{":
            # {N{...}}: what stands between two opening braces is a count.
            end = place + 1
            while end < region.last and reader.at(end) not in ("{", "}", ","):
                end = reader.closing(end) if reader.at(end) in ("(", "[") else end + 1
            if reader.at(end) == "{" and end > place + 1:
                inside.update(range(place + 1, end))
        if text == "'" and reader.at(place - 1) == ")":
            back = place - 1
            depth = 0
            while True:
                depth += {")": 1, "(": -1}.get(reader.at(back), 0)
                inside.add(back)
                if depth == 0:
                    break
                back -= 1
        if text == "'" and reader.tokens[place - 1].kind in ("number", "name"):
            inside.add(place - 1)
        place += 1
    return inside


def _left_of(reader: Reader, region: Region, mark: int) -> int:
    """Where the condition of the ? here begins."""
    place = mark - 1
    depth = 0
    while place >= region.first:
        text = reader.at(place)
        if text in (")", "]", "}"):
            depth += 1
        elif text in ("(", "[", "{"):
            if depth == 0:
                return place + 1
            depth -= 1
        elif depth == 0 and text in (",", "?", ":"):
            return place + 1
        place -= 1
    return region.first


def mutants_of(text: str, file: str) -> list[Mutant]:
    """All mutants of a module, in the order of its source."""
    reader = Reader(text, file)
    found = []
    for region in reader.regions:
        if region.first >= region.last:
            continue
        tokens = reader.tokens
        start, end = tokens[region.first].start, tokens[region.last - 1].end
        fixed = _in_brackets(reader, region)
        changes: list[tuple[int, int, str, str]] = []  # from, to, by what, in words
        if region.condition:
            was = text[start:end]
            changes += [(start, end, f"!({was})", "condition negated"), (start, end, "1'b1", "condition always true"),
                        (start, end, "1'b0", "condition never true")]
        for place in range(region.first, region.last):
            token = tokens[place]
            if place in fixed:
                continue
            if token.kind == "number":
                other = _constant(token.text)
                if other:
                    changes.append((token.start, token.end, other, f"{token.text} becomes {other}"))
            elif token.text in OTHER and _binary(tokens, place, region.first):
                changes += [(token.start, token.end, other, f"{token.text} becomes {other}") for other in OTHER[token.text]]
            elif token.text in ("!", "~") and not _binary(tokens, place, region.first):
                changes.append((token.start, token.end, "", f"{token.text} left out"))
            elif token.text == "?":
                left = tokens[_left_of(reader, region, place)].start
                changes.append((left, token.start, f"!({text[left:token.start].strip()}) ", "choice turned round"))
        line = text.count("\n", 0, start) + 1
        for first, last, by, what in changes:
            at = text.count("\n", 0, first) + 1
            found.append(Mutant(file, at if at > line else line, start, end, text[start:end],
                                text[start:first] + by + text[last:end], what))
    return found


def elaborated(text: str, file: str) -> set[int]:
    """The lines of functions that parameters are made with: none of them is left in the hardware."""
    return Reader(text, file).elaborated


SELECTOR = "chosen_mutant"


def planted(text: str, file: str, numbered: list[tuple[int, Mutant]]) -> str:
    """The source with all these mutants, each behind its number: the plusarg +mutant=N chooses one, 0 none."""
    header = Reader(text, file).header
    by_place: dict[tuple[int, int], list[tuple[int, Mutant]]] = {}
    for number, mutant in numbered:
        by_place.setdefault((mutant.start, mutant.end), []).append((number, mutant))
    for (start, end), here in sorted(by_place.items(), reverse=True):
        chosen = "".join(f"({SELECTOR} == {number}) ? ({mutant.now}) : " for number, mutant in here)
        text = f"{text[:start]}({chosen}({text[start:end]})){text[end:]}"
    declaration = f"""
  int {SELECTOR};
  initial if ($value$plusargs("mutant=%d", {SELECTOR}) == 0) {SELECTOR} = 0;
"""
    return ("/* verilator lint_off WIDTH */ /* verilator lint_off UNSIGNED */ /* verilator lint_off CMPCONST */"
            " /* verilator lint_off UNUSEDSIGNAL */\n" + text[:header] + declaration + text[header:])


def alone(text: str, mutant: Mutant) -> str:
    """The source with this mutant in place of what it was made of."""
    return f"{text[:mutant.start]}({mutant.now}){text[mutant.end:]}"
