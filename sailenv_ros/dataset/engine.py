"""The contract of all engines: numbers of shards in, summaries out.

A shard whose worker dies is made by another one, up to `ATTEMPTS` times. Errors of the work itself
(a scene that cannot be built, a full disk) end it: another worker would meet them, too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Protocol

from sailenv_ros.dataset.job import Job
from sailenv_ros.dataset.manifest import ShardSummary

__all__ = ["ATTEMPTS", "Engine", "OnFrames", "interleave_shards", "neighbour_runs"]

ATTEMPTS = 3
"""Number of attempts at a shard whose worker dies."""

OnFrames = Callable[[int], None]
"""Told how many frames have been made since the start."""


class Engine(Protocol):
    """Makes shards."""

    def run(
        self, job: Job, where: str, shards: Sequence[int], on_frames: OnFrames
    ) -> Iterator[ShardSummary]:
        """Yield the summary of each shard as soon as it is in the data set."""


def neighbour_runs(shards: Sequence[int], workers: int) -> list[Sequence[int]]:
    """Return shards in runs of neighbours, one for each of so many workers; none is empty.

    Neighbours are often of the same scene, which a worker has loaded then.
    """
    length = -(-len(shards) // workers)
    return [shards[begin : begin + length] for begin in range(0, len(shards), length or 1)]


def interleave_shards(shards: Sequence[int], workers: int) -> list[int]:
    """Return shards in an order in which each of so many workers, taking turns, gets neighbours.

    Who is quick takes more.
    """
    runs = neighbour_runs(shards, workers)
    length = max(map(len, runs), default=0)
    return [run[place] for place in range(length) for run in runs if place < len(run)]
