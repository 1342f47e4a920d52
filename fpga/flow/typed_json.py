# SPDX-License-Identifier: Apache-2.0
"""JSON files that are what a type says: a TypedDict, or lists, tables and unions of texts, numbers and of these."""
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, TypeVar, Union, get_args, get_origin, get_type_hints, is_typeddict

from flow.shell import Failure, read_json

Kind = TypeVar("Kind")
SIMPLE: dict[Any, str] = {str: "a text", int: "a whole number", float: "a number", bool: "true or false", NoneType: "null"}


def expected(kind: Any) -> str:
    """What a kind is called."""
    if get_origin(kind) in (Union, UnionType):
        return " or ".join(expected(one) for one in get_args(kind))
    return SIMPLE.get(kind) or ("a list" if get_origin(kind) is list else "a table")


def fault(value: Any, kind: Any, where: str) -> str | None:
    """What is wrong with the value at this place, None where it is of the kind."""
    if get_origin(kind) in (Union, UnionType):
        if value is None and NoneType in get_args(kind):
            return None
        faults = [fault(value, one, where) for one in get_args(kind) if one is not NoneType]
        if len(faults) == 1 and isinstance(value, dict):  # the one table that it can be says more
            return faults[0]
        right = None in faults
    elif is_typeddict(kind):
        if isinstance(value, dict):
            dot = f"{where}." if where else ""
            for name, one in get_type_hints(kind).items():
                if name not in value and name in kind.__required_keys__:
                    return f"{dot}{name} is missing, expected {expected(one)}"
                if name in value and (found := fault(value[name], one, dot + name)):
                    return found
        right = isinstance(value, dict)
    elif get_origin(kind) is list:
        if isinstance(value, list):
            return next((found for n, item in enumerate(value) if (found := fault(item, get_args(kind)[0], f"{where}[{n}]"))), None)
        right = False
    elif get_origin(kind) is dict:
        if isinstance(value, dict):
            dot = f"{where}." if where else ""
            return next((found for name, item in value.items() if (found := fault(item, get_args(kind)[1], dot + name))), None)
        right = False
    elif kind is Any:
        right = True
    else:
        right = type(value) in ((int, float) if kind is float else (kind,))  # True is no number
    if right:
        return None
    said = "a list" if isinstance(value, list) else "a table" if isinstance(value, dict) else json.dumps(value, ensure_ascii=False)
    return f"{where} is {said}, expected {expected(kind)}".lstrip()


def typed(value: Any, kind: type[Kind], path: Path, where: str = "") -> Kind:
    """The value, read of a file at this place; a Failure names the field that is missing or of another kind. Fields that a TypedDict
    does not have are left alone."""
    if found := fault(value, kind, where):
        raise Failure(f"{path}: {found}")
    checked: Kind = value
    return checked


def checked_json(path: Path, kind: type[Kind]) -> Kind:
    """What a JSON file holds, of that kind."""
    return typed(read_json(path), kind, path)


def require_fields(table: Mapping[str, object], names: Iterable[str], kind: type, path: Path, where: str) -> None:
    """That a table, which a type does not say more of, has these fields."""
    for name in names:
        if name not in table:
            raise Failure(f"{path}: {where}.{name} is missing, expected {expected(kind)}")


def require_rows(path: Path, names: Iterable[str], expected: Iterable[str], command: str) -> None:
    """That there is a row of each name that is expected; `command`, with the name in the place of {}, makes it."""
    there = set(names)
    for name in expected:
        if name not in there:
            raise Failure(f"{path}: has no row of {name}; {command.format(name)} makes it")
