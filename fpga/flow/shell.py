# SPDX-License-Identifier: Apache-2.0
"""Programs that are run, files that are read, and what the user is told of both."""
import contextlib
import fcntl
import json
import os
import re
import signal
import subprocess
import sys
import threading
import tomllib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from types import FrameType
from typing import IO, Any, NoReturn

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
    """Runs a command's main; a Failure is told in its sentence and ends it with status 1, a UsageError with 2. A signal that ends it ends
    what it started too, also that nobody reads what it says any more."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) is not signal.SIG_IGN:  # as nohup has it of SIGHUP
            signal.signal(number, end_programs)
    try:
        status = main()
        sys.stdout.flush()
        sys.exit(status)
    except BrokenPipeError:
        end_programs(signal.SIGPIPE)
    except Failure as failure:
        warn(str(failure))
        sys.exit(2 if isinstance(failure, UsageError) else 1)


class Programs:
    """The programs that run, each the leader of a group with all that it starts. ended: none is started any more."""
    running: set["subprocess.Popen[str]"] = set()
    ended = False
    guard = threading.RLock()  # not to be left out where it is started as the signal comes


def end_programs(number: int, _: FrameType | None = None) -> NoReturn:
    """Of a signal, or as of one: ends all that runs, such as hours of routing that nothing would wait for any more, and the command."""
    if number == signal.SIGPIPE:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # for what is not written yet
    with Programs.guard:
        Programs.ended = True
        for running in Programs.running:
            end_group(running)
    sys.exit(128 + number)


def end_group(running: "subprocess.Popen[str]") -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(running.pid, signal.SIGTERM)


@contextlib.contextmanager
def started(command: Sequence[str], output: IO[str] | int, cwd: Path | None = None) -> Iterator["subprocess.Popen[str]"]:
    """A program and what it starts, both outputs in one; ended where what is done with it ends earlier."""
    with Programs.guard:
        if Programs.ended:
            raise Failure(f"{command[0]}: is not started, for a signal ended the command")
        try:
            running = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT, text=True, errors="replace", cwd=cwd,
                                       start_new_session=True)
        except OSError as error:
            raise Failure(f"{command[0]}: cannot be started: {error.strerror}") from error
        Programs.running.add(running)
    try:
        yield running
    finally:
        if running.poll() is None:
            end_group(running)
            running.wait()
        with Programs.guard:
            Programs.running.discard(running)


OWN_LOCKS: dict[str, threading.Lock] = {}


@contextlib.contextmanager
def locked(path: Path) -> Iterator[None]:
    """One at a time, of all commands of this machine."""
    path.parent.mkdir(parents=True, exist_ok=True)
    own = OWN_LOCKS.setdefault(os.path.realpath(path), threading.Lock())  # of this command's threads, which wait unsaid
    with own, open(path, "w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            say(f"waits for another command, which holds {path}")
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def data_lock(data: Path) -> contextlib.AbstractContextManager[None]:
    """Held from the last look at a data file that commands write together until it and its page are written."""
    return locked(ROOT / "build" / f"{data.name}.lock")


# What programs say behind the cause: make of folders, photonloom of its help.
NO_CAUSE = re.compile(r"make(\[\d+\])?: (Leaving|Entering) directory |Run with --help for more information")


def complaint(command: Sequence[str], output: str, log: Path | None) -> Failure:
    """What a command that failed said, in one sentence."""
    words = [line for line in output.splitlines() if line.strip() and not NO_CAUSE.match(line)]
    said = next((line for line in words if "ERROR" in line), words[-1] if words else "it said nothing")
    return Failure(f"{' '.join(command[:2])} failed: {said}" + (f" (all of it: {log})" if log else ""))


def run(command: Sequence[str], log: Path | None = None, cwd: Path | None = None) -> str:
    """Runs a command and gives its output; a Failure names its log, or carries its last words."""
    with started(command, subprocess.PIPE, cwd) as running:
        output, _ = running.communicate()
    if log:
        log.write_text(output)
    if running.returncode != 0:
        raise complaint(command, output, log)
    return output


def said_json(command: Sequence[str]) -> Any:
    """What a command says as one JSON object, among its warnings."""
    text = run(command)
    begin = re.search(r"^\{", text, re.MULTILINE)
    try:
        return json.JSONDecoder().raw_decode(text, begin.start() if begin else 0)[0]
    except ValueError as error:
        raise Failure(f"{' '.join(command[:2])}: says no JSON: {text.strip()[:200]}") from error


def first_line(command: Sequence[str]) -> str | None:
    """The first line of what a command says, whatever its status; None where there is none. A Failure where it does not start."""
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")
    except OSError as error:
        raise Failure(f"{command[0]}: does not start: {error.strerror}") from error
    lines = done.stdout.splitlines()
    unloaded = next((line for line in lines if "error while loading shared libraries" in line), None)
    if unloaded or done.returncode in (126, 127):  # as a shell has it of what cannot be run or found
        raise Failure(f"{command[0]}: does not start: {unloaded or next(iter(lines), f'status {done.returncode}')}")
    return lines[0] if lines else None


def beside(folder: Path, end: str) -> Path:
    """A file beside a folder, named after it."""
    return folder.with_name(folder.name + end)


def read_text(path: Path) -> str:
    try:
        return path.read_text()
    except OSError as error:
        raise Failure(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise Failure(f"{path}: is no text, expected UTF-8") from error


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
