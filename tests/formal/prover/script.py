# SPDX-License-Identifier: Apache-2.0
"""Gappa's scripts, tests/formal/bounds: filled in for some widths, and run on numbers. What is proved is also executed, so
that it can be held against golden, and so that a bug shows an input that breaks the bound."""
import ast
import itertools
import random
import re
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor

from flow.shell import Failure

from . import formula

Values = dict[str, Fraction]


def fill(template: str, known: dict[str, int], bound: str) -> str:
    """Puts the numbers of some widths in: $(FORMULA) exactly, $down(FORMULA) no larger, with 64 bits. The word bound stands
    for the step's."""
    def put(match: re.Match[str]) -> str:
        made = formula.parse(re.sub(r"\bbound\b", f"({bound})", match[2]))
        if match[1]:
            return formula.toward_zero(formula.rational(formula.value(made, known)))
        return formula.gappa(made, known)

    return re.sub(r"\$(down)?\(((?:[^()]|\((?:[^()]|\([^()]*\))*\))*)\)", put, template)


@dataclass(frozen=True)
class Claim:
    """low <= term <= high; of a hypothesis perhaps a multiple of 2^grid."""
    term: ast.expr
    low: Fraction | None
    high: Fraction | None
    grid: int | None = None

    def holds(self, script: "Script", values: Values) -> bool:
        number = script.evaluate(self.term, values)
        if self.grid is not None:
            return (number / Fraction(2) ** self.grid).denominator == 1
        return (self.low is None or number >= self.low) and (self.high is None or number <= self.high)


@dataclass(frozen=True)
class Script:
    roundings: dict[str, str]  # name -> operator
    definitions: dict[str, ast.expr]
    hypotheses: list[Claim]
    goals: list[Claim]
    hints: list[tuple[ast.expr, ast.expr]]  # equal, where no divisor is 0

    @property
    def inputs(self) -> list[str]:
        used: set[str] = set()
        for term in [*self.definitions.values(), *(claim.term for claim in (*self.hypotheses, *self.goals))]:
            used |= formula.words(term)
        return sorted(used - set(self.definitions))

    def evaluate(self, term: ast.expr, values: Values) -> Fraction:
        """Definitions are added to values as they are met."""
        match term:
            case ast.Constant(value=int() | float() as number):
                return Fraction(str(number))
            case ast.Name(id=name):
                if name not in values:
                    if name not in self.definitions:
                        raise Failure(f"{name}: has no value")
                    values[name] = self.evaluate(self.definitions[name], values)
                return values[name]
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return -self.evaluate(operand, values)
            case ast.BinOp(left=left, op=operation, right=right):
                a, b = self.evaluate(left, values), self.evaluate(right, values)
                match operation:
                    case ast.Add():
                        return a + b
                    case ast.Sub():
                        return a - b
                    case ast.Mult():
                        return a * b
                    case ast.Div():
                        return a / b
                    case ast.MatMult():  # NbE
                        return a * Fraction(2) ** int(b)
            case ast.Call(func=ast.Name(id=name), args=[argument]):
                inner = self.evaluate(argument, values)
                return abs(inner) if name == "_abs" else rounded(self.roundings[name], inner)
        raise Failure(f"{ast.unparse(term)}: is not understood here")


def rounded(operator: str, number: Fraction) -> Fraction:
    if operator == "float<ieee_64,ne>":
        return Fraction(float(number))
    match = re.fullmatch(r"fixed<(-?\d+),(dn|up|na|ne)>", operator)
    if not match:
        raise Failure(f"{operator}: no rounding that is understood here")
    step = Fraction(2) ** int(match[1])
    scaled = number / step
    if match[2] == "na":
        whole = floor(abs(scaled) + Fraction(1, 2)) * (1 if scaled >= 0 else -1)
    else:
        whole = floor(scaled) if match[2] == "dn" else ceil(scaled) if match[2] == "up" else round(scaled)
    return whole * step


def read(text: str) -> Script:
    """The part of Gappa's language that the scripts use: roundings, definitions, one implication, hints."""
    text = re.sub(r"#.*", "", text)
    roundings: dict[str, str] = {}

    def operator(match: re.Match[str]) -> str:
        name = f"_rounding{len(roundings)}"
        roundings[name] = re.sub(r"\s", "", match[0])
        return name

    def term(part: str) -> ast.expr:
        part = re.sub(r"^\s*\|(.*)\|\s*$", r"_abs(\1)", part)
        part = re.sub(r"\b(\d+)b(-?\d+)", r"(\1 @ (\2))", part)
        return formula.parse(part)

    def number(part: str) -> Fraction:
        return Script({}, {}, [], [], []).evaluate(term(part), {})

    def claim(part: str) -> Claim:
        if match := re.fullmatch(r"\s*@FIX\((\w+),(.*)\)\s*", part):
            return Claim(term(match[1]), None, None, int(match[2]))
        if match := re.fullmatch(r"(.*)\bin\s*\[(.*),(.*)\]\s*", part, re.DOTALL):
            return Claim(term(match[1]), number(match[2]), number(match[3]))
        if match := re.fullmatch(r"(.*)(<=|>=)(.*)", part, re.DOTALL):
            bound = number(match[3])
            return Claim(term(match[1]), None if match[2] == "<=" else bound, bound if match[2] == "<=" else None)
        raise Failure(f"'{part.strip()}': expected TERM in [LOW, HIGH], TERM <= NUMBER, TERM >= NUMBER or @FIX(NAME, NUMBER)")

    text = re.sub(r"\b(?:fixed|float)<[^>]*>", operator, text)
    parts = re.fullmatch(r"([^{]*)\{(.*?)\}(.*)", text, re.DOTALL)
    if not parts:
        raise Failure("expected one implication { ... -> ... }")
    definitions: dict[str, ast.expr] = {}
    for statement in parts[1].split(";"):
        name, _, right = statement.partition("=")
        if name.strip().startswith("@"):
            roundings[name.strip()[1:]] = roundings[right.strip()]
        elif name.strip():
            definitions[name.strip()] = term(right)
    left, arrow, right = parts[2].partition("->")
    if not arrow:
        raise Failure("expected one implication { ... -> ... }")
    hints = []
    for statement in parts[3].split(";"):
        if "->" in statement:
            a, b = statement.split("->")
            hints.append((term(a), term(b.split("{")[0])))
    return Script(roundings, definitions, [claim(part) for part in left.split("/\\")],
                  [claim(part) for part in right.split("/\\")], hints)


@dataclass(frozen=True)
class Tried:
    inputs: int  # that satisfy the hypotheses
    breaks: Values | None  # one that breaks a goal


def attempt(script: Script, values: Values) -> bool | None:
    """Whether the goals hold at an input; None where a hypothesis does not. A hint that is no equality is a Failure."""
    try:
        if not all(claim.holds(script, values) for claim in script.hypotheses):
            return None
        held = all([claim.holds(script, values) for claim in script.goals])
    except ZeroDivisionError:
        return None
    for a, b in script.hints:
        try:
            equal = script.evaluate(a, values) == script.evaluate(b, values)
        except ZeroDivisionError:
            continue
        if not equal:
            raise Failure(f"{ast.unparse(a)} -> {ast.unparse(b)}: not equal at {shown(script, values)}")
    return held


def shown(script: Script, values: Values) -> str:
    return ", ".join(f"{name} = {float(values[name]):.6g}" for name in script.inputs)


def _lines(script: Script) -> list[tuple[str, int, int, int]]:
    """Of each input: least and greatest as multiples of 2^grid."""
    lines = []
    for name in script.inputs:
        own = [claim for claim in script.hypotheses if isinstance(claim.term, ast.Name) and claim.term.id == name]
        low = [claim.low for claim in own if claim.low is not None]
        high = [claim.high for claim in own if claim.high is not None]
        if not low or not high:
            raise Failure(f"{name}: expected a hypothesis {name} in [LOW, HIGH]")
        grids = [claim.grid for claim in own if claim.grid is not None]
        # An input of any real value is tried on a grid so fine that it makes no difference.
        grid = grids[0] if grids else -80
        step = Fraction(2) ** grid
        lines.append((name, grid, ceil(max(low) / step), floor(min(high) / step)))
    return lines


_ALL = 1 << 13  # inputs, up to which all are tried


def search(script: Script, tries: int) -> Tried:
    """Runs the script on its inputs: all where they are few, else ends, ties and what is near them, and any."""
    lines = _lines(script)
    count = 1
    for _, _, low, high in lines:
        count *= high - low + 1
    found = 0
    dice = random.Random(1)

    def any_of(grid: int, low: int, high: int) -> int:
        kind = dice.randrange(5)
        if kind == 0:
            near = dice.choice((low, high))
        elif kind == 1 and grid < 0:  # half way between whole numbers
            near = (dice.randint(low, high) >> -grid << -grid) + (1 << (-grid - 1))
        elif kind == 2 and low >= 0:  # of any size
            near = max(low, 1) << dice.randrange(max(1, high.bit_length() - max(low, 1).bit_length() + 1))
        else:
            return dice.randint(low, high)
        return min(max(near + dice.randint(-3, 3), low), high)

    few = count <= _ALL
    points = (itertools.product(*(range(low, high + 1) for _, _, low, high in lines)) if few else
              (tuple(any_of(*line[1:]) for line in lines) for _ in range(tries)))
    for point in points:
        values = {name: at * Fraction(2) ** grid for (name, grid, _, _), at in zip(lines, point)}
        held = attempt(script, values)
        if held is None:
            continue
        found += 1
        if not held:
            return Tried(found, values)
    return Tried(found, None)
