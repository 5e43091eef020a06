"""Shards made by a Ray cluster: each is a task, which Ray tries again where its worker dies."""

from __future__ import annotations

import os
import socket
from collections.abc import Iterator, Sequence
from typing import Any

from sailenv_ros.dataset.engine import ATTEMPTS, OnFrames, interleave_shards
from sailenv_ros.dataset.job import Job
from sailenv_ros.dataset.manifest import ShardSummary
from sailenv_ros.dataset.remote_storage import open_storage
from sailenv_ros.dataset.shard_maker import ShardMaker
from sailenv_ros.errors import RecordingError, SailenvError
from sailenv_ros.extras import need
from sailenv_ros.system.memory import keep_freed_memory
from sailenv_ros.system.threads import THREADS_VARIABLE

__all__ = ["RayEngine"]

LOOK_INTERVAL_S = 1.0
CONNECT_TIMEOUT_S = 5.0


class RayEngine:
    """Makes shards on all machines of a cluster; each processor makes one at a time.

    Parameters
    ----------
    address : str
        Of the cluster, as ``ray.init`` takes it: ``auto`` for the one that this machine belongs to,
        ``ray://host:10001``, ``local`` for one of this process's own.
    """

    def __init__(self, address: str) -> None:
        self._address = address
        self._ray: Any = need("ray", "a data set made by a Ray cluster")

    def run(
        self, job: Job, where: str, shards: Sequence[int], on_frames: OnFrames
    ) -> Iterator[ShardSummary]:
        """Yield the summary of each shard."""
        ray = self._ray
        self._check_reachable()
        try:
            ray.init(address=self._address, log_to_driver=False, logging_level="warning")
        except (ConnectionError, ValueError, RuntimeError) as problem:
            raise RecordingError(
                f"there is no Ray cluster at {self._address!r}: {problem}"
            ) from None
        frames = 0
        try:
            task = ray.remote(num_cpus=1, max_retries=ATTEMPTS)(_make_shard)
            shared = ray.put(job)
            processors = max(1, int(ray.cluster_resources().get("CPU", 1)))
            running = {
                task.remote(shared, where, shard): shard
                for shard in interleave_shards(shards, processors)
            }
            while running:
                done, _ = ray.wait(list(running), num_returns=1, timeout=LOOK_INTERVAL_S)
                for reference in done:
                    shard = running.pop(reference)
                    try:
                        summary: ShardSummary = ray.get(reference)
                    except ray.exceptions.RayTaskError as problem:
                        raise _own_error(problem) from None
                    except ray.exceptions.RayError as problem:
                        raise RecordingError(
                            f"shard {shard} was lost {ATTEMPTS + 1} times: {problem}"
                        ) from None
                    frames += summary.frames
                    on_frames(frames)
                    yield summary
        finally:
            ray.shutdown()

    def _check_reachable(self) -> None:
        """Refuse an address where nobody listens, for which Ray itself would wait minutes."""
        host, colon, port = self._address.removeprefix("ray://").rpartition(":")
        if not (colon and port.isdecimal()):
            return
        try:
            socket.create_connection((host.strip("[]"), int(port)), CONNECT_TIMEOUT_S).close()
        except (OSError, OverflowError) as problem:
            raise RecordingError(
                f"there is no Ray cluster at {self._address!r}: {problem}"
            ) from None


_makers: dict[tuple[str, str], Any] = {}
"""The maker of this worker's process, by job and place: it keeps what it has loaded."""


def _make_shard(job: Job, where: str, number: int) -> ShardSummary:
    """Make one shard in a worker of the cluster."""
    key = job.fingerprint, where
    if key not in _makers:
        for other in list(_makers):
            _makers.pop(other).close()
        job.check_machine()
        # Each processor has a task of its own.
        os.environ.setdefault(THREADS_VARIABLE, "1")
        keep_freed_memory()
        _makers[key] = ShardMaker(job, open_storage(where))
    made: ShardSummary = _makers[key].make(number)
    return made


def _own_error(problem: Any) -> Exception:
    """Return the error of ours that a task raised, else one that names it."""
    cause = getattr(problem, "cause", None)
    if isinstance(cause, SailenvError):
        return cause
    return RecordingError(f"a task of the Ray cluster failed: {problem}")
