# SPDX-License-Identifier: Apache-2.0
"""Programs run to their end or to a limit of processor time, which does not depend on what else the machine does."""
import os
import resource
import subprocess
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Finished:
    status: int
    text: str  # both outputs
    seconds: float  # of the processor, the program's own and its children's
    ended: bool  # by itself, not at the limit


def run(command: list[str], log: Path, limit: float) -> Finished:
    """Runs a command whose processes each get limit seconds of the processor; its output is added to log."""
    seconds = max(1, round(limit))
    with log.open("a+") as stream:
        stream.write(f"$ {' '.join(command)}\n")
        stream.flush()
        start = stream.tell()
        # The programs print what they have done so far as they go: unbuffered, it is there when they are ended.
        process = subprocess.Popen(["stdbuf", "-oL", *command], stdout=stream, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
                                   preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5)))
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        stream.seek(start)
        text = stream.read()
    return Finished(process.returncode, text, usage.ru_utime + usage.ru_stime, process.returncode >= 0)
