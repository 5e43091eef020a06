"""Walks over a picture by two threads at once: the upper rows here, the lower ones beside.

A walk is a compiled function of its first and its last row that leaves Python's lock alone.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor

__all__ = ["Bands", "alone", "beside"]

Bands = Callable[[Callable[[int, int], None], int], None]
"""Runs a walk over so many rows."""


def alone(walk: Callable[[int, int], None], rows: int) -> None:
    """Run a walk in this thread."""
    walk(0, rows)


def beside(executor: Executor) -> Bands:
    """Give a way to run walks with the help of one more thread."""

    def run(walk: Callable[[int, int], None], rows: int) -> None:
        # Blocks of occlusion are four rows high; any place would do.
        middle = rows // 8 * 4
        lower = executor.submit(walk, middle, rows)
        try:
            walk(0, middle)
        finally:
            lower.result()

    return run
