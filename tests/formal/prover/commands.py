# SPDX-License-Identifier: Apache-2.0
"""Programs run to their end or to a limit, with the processor time they took."""
import os
import resource
import signal
import subprocess
import threading
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Finished:
    status: int
    text: str  # both outputs
    seconds: float  # of the processor, the program's own and its children's
    ended: bool  # by itself, not at the limit


def run(command: list[str], log: Path, limit: float) -> Finished:
    """Runs a command for at most limit seconds of the clock; its output is added to log."""
    with log.open("a+") as stream:
        stream.write(f"$ {' '.join(command)}\n")
        stream.flush()
        start = stream.tell()
        process = subprocess.Popen(command, stdout=stream, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
                                   start_new_session=True)
        timer = _Deadline(process.pid, limit)
        _, status, usage = os.wait4(process.pid, 0)
        timer.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
        stream.seek(start)
        text = stream.read()
    return Finished(process.returncode, text, _seconds(usage), not timer.fired)


def _seconds(usage: resource.struct_rusage) -> float:
    return usage.ru_utime + usage.ru_stime


class _Deadline:
    """Ends a process and those that it started when its time is over."""

    def __init__(self, pid: int, limit: float) -> None:
        self.fired = False
        self._pid = pid
        self._timer = threading.Timer(limit, self._fire)
        self._timer.daemon = True
        self._timer.start()

    def _fire(self) -> None:
        self.fired = True
        try:
            os.killpg(self._pid, signal.SIGKILL)
        except ProcessLookupError:
            pass

    def cancel(self) -> None:
        self._timer.cancel()
