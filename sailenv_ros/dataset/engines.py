"""Engines of this machine: shards made in this process, or in several, and the choice of one."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from sailenv_ros.dataset.engine import Engine, OnFrames
from sailenv_ros.dataset.job import Job
from sailenv_ros.dataset.manifest import ShardSummary
from sailenv_ros.dataset.remote_storage import open_storage
from sailenv_ros.dataset.shard_maker import ShardMaker
from sailenv_ros.dataset.worker_pool import WorkerPool
from sailenv_ros.system.temporary_folders import temporary_folder

__all__ = ["ProcessEngine", "SerialEngine", "engine_of"]


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
    """Makes shards in so many processes of this machine."""

    workers: int

    def run(
        self, job: Job, where: str, shards: Sequence[int], on_frames: OnFrames
    ) -> Iterator[ShardSummary]:
        """Yield the summary of each shard."""
        # Ours, so that it goes however the workers end.
        with temporary_folder("sailenv-dataset-") as scratch:
            pool = WorkerPool(
                workers=self.workers,
                maker=_maker,
                arguments=(job, where, str(scratch)),
                piece="shard",
            )
            yield from pool.run(shards, on_frames)


def engine_of(workers: int, ray_address: str | None) -> Engine:
    """Return the engine for so many workers here, or for a Ray cluster."""
    if ray_address is not None:
        from sailenv_ros.dataset.ray_engine import RayEngine

        return RayEngine(ray_address)
    return ProcessEngine(workers) if workers > 1 else SerialEngine()


def _maker(
    job: Job, where: str, scratch: str, on_frame: Callable[[], None]
) -> Callable[[int], ShardSummary]:
    return ShardMaker(job, open_storage(where), on_frame, scratch=Path(scratch)).make
