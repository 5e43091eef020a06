"""Work in pieces, in several threads."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

__all__ = ["in_chunks"]


def in_chunks(
    work: Callable[[int, int], None],
    count: int,
    size: int,
    workers: int,
    report: Callable[[float], None] = lambda share: None,
) -> None:
    """Do ``work(first, end)`` for all of `count` items in several threads.

    Results do not depend on the number of threads as long as pieces do not share what they write.
    """
    pieces = [(first, min(first + size, count)) for first in range(0, count, size)]
    pool = ThreadPoolExecutor(workers)
    try:
        for done, future in enumerate([pool.submit(work, *piece) for piece in pieces]):
            future.result()
            report((done + 1) / len(pieces))
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
