"""Engines of this machine: shards made in this process, or in several, and the choice of one."""

from __future__ import annotations

import os
import signal
import threading
from collections import Counter, deque
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from sailenv_ros.dataset.engine import ATTEMPTS, Engine, OnFrames, interleave_shards
from sailenv_ros.dataset.job import Job
from sailenv_ros.dataset.manifest import ShardSummary
from sailenv_ros.dataset.remote_storage import open_storage
from sailenv_ros.dataset.shard_maker import ShardMaker
from sailenv_ros.errors import RecordingError
from sailenv_ros.native.library import THREADS_VARIABLE
from sailenv_ros.system.memory import keep_freed_memory
from sailenv_ros.system.parent import end_at_once, end_with_parent
from sailenv_ros.system.temporary_folders import temporary_folder

__all__ = ["ProcessEngine", "SerialEngine", "engine_of"]

LOOK_INTERVAL_S = 0.2


class SerialEngine:
    """Makes shards in this process, one after another."""

    def run(
        self, job: Job, where: str, shards: Sequence[int], on_frames: OnFrames
    ) -> Iterator[ShardSummary]:
        """Yield the summary of each shard."""
        made = 0

        def count() -> None:
            nonlocal made
            made += 1
            on_frames(made)

        with ShardMaker(job, open_storage(where), count) as maker:
            for shard in shards:
                yield maker.make(shard)


@dataclass(frozen=True, slots=True)
class ProcessEngine:
    """Makes shards in so many processes of this machine, each with its share of the processors."""

    workers: int

    def run(
        self, job: Job, where: str, shards: Sequence[int], on_frames: OnFrames
    ) -> Iterator[ShardSummary]:
        """Yield the summary of each shard."""
        # Ours, so that it goes however the workers end.
        with temporary_folder("sailenv-dataset-") as scratch:
            waiting = deque(interleave_shards(shards, self.workers))
            yield from self._run_pools(job, where, str(scratch), waiting, on_frames)

    def _run_pools(
        self, job: Job, where: str, scratch: str, waiting: deque[int], on_frames: OnFrames
    ) -> Iterator[ShardSummary]:
        """Begin workers, and others when one of them was killed."""
        context = get_context("spawn")
        frames = context.Value("q", 0)
        threads = max(1, (os.cpu_count() or 1) // self.workers)
        arguments = (job, where, scratch, frames, threads, os.getpid())
        attempts: Counter[int] = Counter()
        while waiting:
            pool = ProcessPoolExecutor(
                min(self.workers, len(waiting)), context, _begin_worker, arguments
            )
            running: dict[Future[ShardSummary], int] = {}
            try:
                yield from self._run(pool, waiting, running, frames, on_frames)
                pool.shutdown()
            except BrokenProcessPool:
                # All that were running are tried again, by new workers.
                for shard in sorted(running.values(), reverse=True):
                    attempts[shard] += 1
                    if attempts[shard] >= ATTEMPTS:
                        raise RecordingError(
                            f"the worker of shard {shard} was killed {ATTEMPTS} times; it may "
                            "need more memory than there is: use fewer workers"
                        ) from None
                    waiting.appendleft(shard)
            finally:
                _end(pool)

    def _run(
        self,
        pool: ProcessPoolExecutor,
        waiting: deque[int],
        running: dict[Future[ShardSummary], int],
        frames: Any,
        on_frames: OnFrames,
    ) -> Iterator[ShardSummary]:
        while waiting or running:
            # One more than there are workers, so that none of them waits for us.
            while waiting and len(running) <= self.workers:
                shard = waiting.popleft()
                try:
                    running[pool.submit(_make_shard, shard)] = shard
                except BrokenProcessPool:
                    waiting.appendleft(shard)
                    raise
            done, _ = wait(running, LOOK_INTERVAL_S, FIRST_COMPLETED)
            on_frames(frames.value)
            for future in sorted(done, key=lambda one: running[one]):
                summary = future.result()
                del running[future]
                yield summary


def engine_of(workers: int, ray_address: str | None) -> Engine:
    """Return the engine for so many workers here, or for a Ray cluster."""
    if ray_address is not None:
        from sailenv_ros.dataset.ray_engine import RayEngine

        return RayEngine(ray_address)
    return ProcessEngine(workers) if workers > 1 else SerialEngine()


_maker: ShardMaker | None = None


def _begin_worker(
    job: Job, where: str, scratch: str, frames: Any, threads: int, parent: int
) -> None:
    """Set a worker's process up."""
    global _maker
    if threading.current_thread() is threading.main_thread():
        end_with_parent(parent)
        # Ctrl-C goes to all of the terminal; the parent ends its workers.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.environ[THREADS_VARIABLE] = str(threads)
    keep_freed_memory()

    def count() -> None:
        with frames.get_lock():
            frames.value += 1

    _maker = ShardMaker(job, open_storage(where), count, scratch=Path(scratch))


def _make_shard(number: int) -> ShardSummary:
    assert _maker is not None
    return _maker.make(number)


def _end(pool: ProcessPoolExecutor) -> None:
    """End workers that still run at once; what they have not finished is not there."""
    processes = list((getattr(pool, "_processes", None) or {}).values())
    pool.shutdown(wait=False, cancel_futures=True)
    end_at_once(processes)
