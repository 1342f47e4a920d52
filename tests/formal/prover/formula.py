# SPDX-License-Identifier: Apache-2.0
"""Exact arithmetic of the bounds: the formulas of tests/extremes/suite/steps.bounds, and numbers as Gappa writes them."""
import ast
from dataclasses import dataclass
from fractions import Fraction

from flow.shell import Failure


@dataclass(frozen=True)
class Surd:
    """rational * sqrt(root), as far as bounds need it: products, and sums where one root is on both sides."""
    rational: Fraction
    root: int = 1

    def times(self, other: "Surd") -> "Surd":
        if self.root == other.root:
            return Surd(self.rational * other.rational * self.root)
        if 1 not in (self.root, other.root):
            raise Failure(f"sqrt({self.root}) * sqrt({other.root}): not exact here")
        return Surd(self.rational * other.rational, self.root * other.root)

    def plus(self, other: "Surd") -> "Surd":
        if self.root != other.root:
            raise Failure(f"sqrt({self.root}) + sqrt({other.root}): not exact here")
        return Surd(self.rational + other.rational, self.root)


def parse(text: str) -> ast.expr:
    """A formula: + - * / ^ parentheses, sqrt of a whole number, words."""
    try:
        return ast.parse(" ".join(text.replace("^", "**").split()), mode="eval").body
    except SyntaxError as error:
        raise Failure(f"'{text}': no formula") from error


def words(formula: ast.expr) -> set[str]:
    called = {id(node.func) for node in ast.walk(formula) if isinstance(node, ast.Call)}
    return {node.id for node in ast.walk(formula) if isinstance(node, ast.Name) and id(node) not in called}


def value(formula: ast.expr, known: dict[str, int]) -> Surd:
    match formula:
        case ast.Constant(value=bool() | str() | bytes() | None):
            pass
        case ast.Constant(value=int() | float() as number):
            return Surd(Fraction(str(number)))
        case ast.Name(id=word) if word in known:
            return Surd(Fraction(known[word]))
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return value(operand, known).times(Surd(Fraction(-1)))
        case ast.Call(func=ast.Name(id="sqrt"), args=[ast.Constant(value=int() as root)]):
            return Surd(Fraction(1), root)
        case ast.BinOp(left=left, op=ast.Pow(), right=right):
            base, power = value(left, known), rational(value(right, known))
            if power.denominator != 1 or (base.root != 1 and power < 0):
                raise Failure(f"{ast.unparse(formula)}: not exact here")
            if base.root == 1:
                return Surd(base.rational ** int(power))
            result = Surd(Fraction(1))
            for _ in range(int(power)):
                result = result.times(base)
            return result
        case ast.BinOp(left=left, op=operation, right=right):
            a, b = value(left, known), value(right, known)
            match operation:
                case ast.Add():
                    return a.plus(b)
                case ast.Sub():
                    return a.plus(b.times(Surd(Fraction(-1))))
                case ast.Mult():
                    return a.times(b)
                case ast.Div():
                    # 1 / (r sqrt n) = sqrt n / (r n)
                    return a.times(Surd(1 / (b.rational * b.root), b.root))
    raise Failure(f"{ast.unparse(formula)}: cannot be evaluated")


def rational(number: Surd) -> Fraction:
    if number.root != 1:
        raise Failure(f"{number.rational} * sqrt({number.root}): not rational")
    return number.rational


def _dyadic(number: Fraction) -> str:
    return f"{number.numerator}b{1 - number.denominator.bit_length()}"


def literal(number: Fraction) -> str:
    """An exact expression of Gappa; inside an interval it takes a sum of powers of two alone."""
    power_of_two = number.denominator & (number.denominator - 1) == 0
    return _dyadic(number) if power_of_two else f"({number.numerator} / {number.denominator})"


def toward_zero(number: Fraction) -> str:
    """At most 64 bits of a number: a bound that is no larger."""
    shift = 64 - (abs(number.numerator).bit_length() - number.denominator.bit_length())
    scaled = abs(number) * Fraction(2) ** shift
    cut = Fraction(scaled.numerator // scaled.denominator) / Fraction(2) ** shift
    return _dyadic(cut if number > 0 else -cut)


def gappa(formula: ast.expr, known: dict[str, int]) -> str:
    """A formula as an expression of Gappa: what is known becomes numbers, other words stay."""
    if words(formula) <= set(known):
        return literal(rational(value(formula, known)))
    match formula:
        case ast.Name(id=word):
            return word
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return f"(-{gappa(operand, known)})"
        case ast.BinOp(left=left, op=ast.Add() | ast.Sub() | ast.Mult() | ast.Div() as operation, right=right):
            sign = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/"}[type(operation)]
            return f"({gappa(left, known)} {sign} {gappa(right, known)})"
    raise Failure(f"{ast.unparse(formula)}: cannot be written for Gappa")
