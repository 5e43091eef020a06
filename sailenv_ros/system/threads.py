"""How many threads work at a time. Reads the environment and the processors of this process."""

from __future__ import annotations

import os

from sailenv_ros.errors import InvalidRequest

__all__ = ["THREADS_VARIABLE", "thread_count"]

THREADS_VARIABLE = "SAILENV_THREADS"


def thread_count() -> int:
    """Return how many threads a kernel may use: ``SAILENV_THREADS``, else the processors it has.

    Raises
    ------
    InvalidRequest
        If the environment's ``SAILENV_THREADS`` is no number from 1 to 256.
    """
    asked = os.environ.get(THREADS_VARIABLE, "")
    if not asked:
        return len(os.sched_getaffinity(0))
    if not asked.isdecimal() or not 1 <= int(asked) <= 256:
        raise InvalidRequest(THREADS_VARIABLE, asked, "an integer from 1 to 256")
    return int(asked)
