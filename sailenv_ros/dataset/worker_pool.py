"""Pieces of a work in several processes: numbers in, results out, in the order of their ends.

Each worker makes a run of neighbours, and then helps with the longest that is left. A piece whose
worker dies is made by another one, up to `ATTEMPTS` times. Errors of the work itself end it.
"""

from __future__ import annotations

import os
import signal
import threading
from collections import Counter, deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from typing import Any, Generic, TypeVar

from sailenv_ros.dataset.engine import ATTEMPTS, OnFrames, neighbour_runs
from sailenv_ros.errors import RecordingError
from sailenv_ros.system.interrupts import held_interrupts
from sailenv_ros.system.memory import keep_freed_memory
from sailenv_ros.system.parent import end_at_once, end_with_parent
from sailenv_ros.system.threads import THREADS_VARIABLE

__all__ = ["WorkerPool"]

LOOK_INTERVAL_S = 0.2

Made = TypeVar("Made")


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkerPool(Generic[Made]):
    """Processes of this machine, each with its share of the processors.

    Attributes
    ----------
    workers : int
    maker : callable
        ``maker(*arguments, on_frame)`` returns a function from a piece's number to its result. A
        function of a module: each worker calls it once. ``on_frame()`` counts a frame.
    arguments : tuple
        Sent to the workers.
    piece : str
        Word for a piece in errors.
    """

    workers: int
    maker: Callable[..., Callable[[int], Made]]
    arguments: tuple[Any, ...]
    piece: str

    def run(self, numbers: Sequence[int], on_frames: OnFrames) -> Iterator[Made]:
        """Yield the result of each piece; neighbours are made by the same worker where it can be.

        Raises
        ------
        RecordingError
            If the worker of a piece was killed `ATTEMPTS` times.
        """
        context = get_context("spawn")
        frames = context.Value("q", 0)
        threads = max(1, (os.cpu_count() or 1) // self.workers)
        arguments = (self.maker, self.arguments, frames, threads, os.getpid())
        attempts: Counter[int] = Counter()
        runs = [deque(run) for run in neighbour_runs(numbers, self.workers)]
        # Each worker is a pool of one process, so that a piece goes to the one that it is for.
        begin = partial(ProcessPoolExecutor, 1, context, _begin_worker, arguments)
        pools = [begin() for _ in runs]

        def try_again(place: int, number: int) -> None:
            """Give a piece to a worker in the place of one that was killed."""
            runs[place].appendleft(number)
            _end(pools[place])
            pools[place] = begin()

        running: dict[Future[Made], tuple[int, int]] = {}
        with ExitStack() as opened:
            raise_held = opened.enter_context(held_interrupts())
            opened.callback(_end_all, pools)
            while any(runs) or running:
                busy = {place for place, _ in running.values()}
                for place in (one for one in range(len(runs)) if one not in busy and any(runs)):
                    number = _next(runs, place)
                    try:
                        running[pools[place].submit(_make, number)] = place, number
                    except BrokenProcessPool:  # killed while it had nothing to do
                        try_again(place, number)
                done, _ = wait(running, LOOK_INTERVAL_S, FIRST_COMPLETED)
                raise_held()
                on_frames(frames.value)
                for future in sorted(done, key=lambda one: running[one]):
                    place, number = running.pop(future)
                    try:
                        made = future.result()
                    except BrokenProcessPool:
                        attempts[number] += 1
                        if attempts[number] >= ATTEMPTS:
                            raise RecordingError(
                                f"the worker of {self.piece} {number} was killed {ATTEMPTS} times; "
                                "it may need more memory than there is: use fewer workers"
                            ) from None
                        try_again(place, number)
                    else:
                        yield made
            for pool in pools:
                pool.shutdown()
            raise_held()


def _next(runs: Sequence[deque[int]], place: int) -> int:
    """Take the next piece of a worker: of its own run, else the last one of the longest."""
    return runs[place].popleft() if runs[place] else max(runs, key=len).pop()


_made_by: Callable[[int], Any] | None = None


def _begin_worker(
    maker: Callable[..., Callable[[int], Any]],
    arguments: tuple[Any, ...],
    frames: Any,
    threads: int,
    parent: int,
) -> None:
    """Set a worker's process up."""
    global _made_by
    if threading.current_thread() is threading.main_thread():
        end_with_parent(parent)
        # Ctrl-C goes to all of the terminal; the parent ends its workers.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.environ[THREADS_VARIABLE] = str(threads)
    keep_freed_memory()

    def count() -> None:
        with frames.get_lock():
            frames.value += 1

    _made_by = maker(*arguments, count)


def _make(number: int) -> Any:
    assert _made_by is not None
    return _made_by(number)


def _end_all(pools: Sequence[ProcessPoolExecutor]) -> None:
    for pool in pools:
        _end(pool)


def _end(pool: ProcessPoolExecutor) -> None:
    """End workers that still run at once; what they have not finished is not there."""
    end_at_once(list((getattr(pool, "_processes", None) or {}).values()))
    # The pool's own thread takes note of their ends, too: without it they may seem to run yet.
    pool.shutdown(cancel_futures=True)
