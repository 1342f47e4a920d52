# SPDX-License-Identifier: Apache-2.0
"""Programs that are run, files that are read, and what the user is told of both."""
import json
import os
import subprocess
import sys
import tomllib
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NoReturn

ROOT = Path(__file__).resolve().parents[2]


class Failure(Exception):
    """Something the user is told in one sentence."""


class UsageError(Failure):
    """What a command was asked for does not exist or cannot be."""


def program_name() -> str:
    return os.path.basename(sys.argv[0])


def say(text: str) -> None:
    """A line of progress, under the name of the command."""
    print(f"{program_name()}: {text}", flush=True)


def warn(text: str) -> None:
    print(f"{program_name()}: {text}", file=sys.stderr)


def exit_with(main: Callable[[], int]) -> NoReturn:
    """Runs a command's main; a Failure is told in its sentence and ends it with status 1, a UsageError with 2."""
    try:
        sys.exit(main())
    except Failure as failure:
        warn(str(failure))
        sys.exit(2 if isinstance(failure, UsageError) else 1)


def complaint(command: Sequence[str], output: str, log: Path | None) -> Failure:
    """What a command that failed said, in one sentence."""
    words = [line for line in output.splitlines() if line.strip()]
    said = next((line for line in words if "ERROR" in line), words[-1] if words else "it said nothing")
    return Failure(f"{' '.join(command[:2])} failed: {said}" + (f" (all of it: {log})" if log else ""))


def run(command: Sequence[str], log: Path | None = None, cwd: Path | None = None) -> str:
    """Runs a command and gives its output; a Failure names its log, or carries its last words."""
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=cwd)
    except OSError as error:
        raise Failure(f"{command[0]}: cannot be started: {error.strerror}") from error
    if log:
        log.write_text(done.stdout)
    if done.returncode != 0:
        raise complaint(command, done.stdout, log)
    return done.stdout


def first_line(command: Sequence[str]) -> str | None:
    """The first line of what a command says, whatever its status; None where there is none."""
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    except OSError:
        return None
    return done.stdout.splitlines()[0] if done.stdout else None


def beside(folder: Path, end: str) -> Path:
    """A file beside a folder, named after it."""
    return folder.with_name(folder.name + end)


def read_text(path: Path) -> str:
    try:
        return path.read_text()
    except OSError as error:
        raise Failure(f"{path}: cannot be read: {error.strerror}") from error


def read_json(path: Path) -> Any:
    try:
        return json.loads(read_text(path))
    except ValueError as error:
        raise Failure(f"{path}: is not JSON: {error}") from error


def write_json(path: Path, value: Any, indent: int | None = 1) -> None:
    path.write_text(json.dumps(value, indent=indent) + "\n")


def read_toml(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(read_text(path))
    except tomllib.TOMLDecodeError as error:
        raise Failure(f"{path}: is not TOML: {error}") from error


def field(table: dict[str, Any], path: Path, name: str, kind: type | tuple[type, ...], expected: str) -> Any:
    """The value of a dotted name in what was read of a TOML file."""
    value: Any = table
    for part in name.split("."):
        value = value.get(part) if isinstance(value, dict) else None
    if not isinstance(value, kind) or isinstance(value, bool):
        raise Failure(f"{path}: {name} is {'missing' if value is None else repr(value)}, expected {expected}")
    return value
