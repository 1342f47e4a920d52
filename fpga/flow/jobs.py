# SPDX-License-Identifier: Apache-2.0
"""Work on several things at a time."""
import concurrent.futures
import signal
from collections.abc import Callable, Iterable
from typing import TypeVar

from flow.shell import Failure, end_programs, warn

Item = TypeVar("Item")
Made = TypeVar("Made")


def each(jobs: int, one: Callable[[Item], Made], items: Iterable[Item]) -> list[Made]:
    """one(item) of each, `jobs` at a time. One that fails does not end the others, whose results are kept for a later run; when all are
    done each failure is told, the first as this function's own. Where nobody reads what is said any more, all end."""
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        made = [pool.submit(one, item) for item in items]
        for done in concurrent.futures.as_completed(made):
            if isinstance(done.exception(), BrokenPipeError):
                end_programs(signal.SIGPIPE)
    failures = [failure for done in made if (failure := done.exception())]
    for failure in failures[1:]:
        if not isinstance(failure, Failure):
            raise failure
        warn(str(failure))
    if failures:
        raise failures[0]
    return [done.result() for done in made]
