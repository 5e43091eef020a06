"""A recipe's frames without files: `DatasetStream`, in this process or by several others."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
from collections.abc import Generator, Iterator, Sequence
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Any, Literal

from sailenv_ros.dataset.frame_lines import FrameLine
from sailenv_ros.dataset.job import Job
from sailenv_ros.dataset.reader import DatasetFrame
from sailenv_ros.dataset.samples import SampleFormat, check_format, sample_of
from sailenv_ros.dataset.shard_plan import ShardPlan
from sailenv_ros.errors import InvalidRequest, RecordingError, UnknownName
from sailenv_ros.system.memory import keep_freed_memory
from sailenv_ros.system.parent import end_at_once, end_with_parent
from sailenv_ros.system.threads import THREADS_VARIABLE

__all__ = ["DatasetStream"]


class DatasetStream:
    """The frames that a recipe's files would hold, made as they are taken.

    Each iteration begins again, and gives the same frames. By one worker they come in the order of
    the files; by several, one of each in turn, which is the same order each time. In a worker of a
    PyTorch `DataLoader` it gives that worker's part. Can be sent to other processes.

    Parameters
    ----------
    job : Job
    split : str
        Only that one; empty for all.
    format : {'frame', 'numpy', 'torch'}
        What is given: `DatasetFrame`, or samples as of `DatasetSamples`.
    workers : int
        1 works in a thread of this process; more are processes of their own.
    ahead : int
        How many frames each worker makes before they are taken.

    Raises
    ------
    UnknownName
        If the recipe has no such split, or there is no such format.
    InvalidRequest
        If a number is below 1.
    MissingPackage
        If PyTorch is wanted, and not installed.

    Notes
    -----
    Of several cameras, frames of the first come as they are made, and those of the others at the
    end of each clip, as their numbers say; a clip of them must fit into memory. Clips for which a
    camera finds no place are left out, as in files.
    """

    def __init__(
        self,
        job: Job,
        split: str = "",
        *,
        format: Literal["frame"] | SampleFormat = "frame",
        workers: int = 1,
        ahead: int = 8,
    ) -> None:
        if split and split not in job.recipe.clips.by_name:
            raise UnknownName("split", split, job.recipe.clips.by_name)
        if format != "frame":
            check_format(format)
        for name, value in (("workers", workers), ("ahead", ahead)):
            if value < 1:
                raise InvalidRequest(name, value, "1 or more")
        self.job = job
        self.split = split
        self.format = format
        self.workers = workers
        self.ahead = ahead

    def __iter__(self) -> Iterator[Any]:
        shards = self._shards()
        frames = self._alone(shards) if self.workers == 1 else self._by_processes(shards)
        # Closed with this generator: by `close`, an error of the caller's, Ctrl-C or the collector.
        with contextlib.closing(frames):
            for one in frames:
                if self.format == "frame":
                    yield one
                else:
                    yield sample_of(one, self.job.recipe.views, self.format, "the stream")

    def _shards(self) -> list[int]:
        """Return the shards of the split, or those for this worker of a `DataLoader`."""
        plan = ShardPlan(self.job.recipe)
        shards = [
            number for number in range(plan.shards) if self.split in ("", plan.shard(number).split)
        ]
        if "torch.utils.data" in sys.modules:
            worker = sys.modules["torch.utils.data"].get_worker_info()
            if worker is not None:
                return _part(shards, worker.id, worker.num_workers)
        return shards

    def _alone(self, shards: Sequence[int]) -> Generator[DatasetFrame, None, None]:
        line = FrameLine(self.job, shards, self.ahead)
        try:
            yield from line
        finally:
            line.close()

    def _by_processes(self, shards: Sequence[int]) -> Generator[DatasetFrame, None, None]:
        context = get_context("spawn")
        count = max(1, min(self.workers, len(shards)))
        threads = max(1, (os.cpu_count() or 1) // count)
        lines: list[Connection] = []
        processes = []
        try:
            for number in range(count):
                ours, theirs = context.Pipe(duplex=False)
                lines.append(ours)
                part = _part(shards, number, count)
                arguments = (self.job, part, self.ahead, theirs, threads, os.getpid())
                process = context.Process(target=_work, args=arguments, daemon=True)
                process.start()
                processes.append(process)
                theirs.close()
            yield from _in_turn(lines)
        finally:
            for line in lines:
                line.close()
            end_at_once(processes)
            for process in processes:
                process.close()


def _part(shards: Sequence[int], worker: int, workers: int) -> list[int]:
    """Return the shards of one of so many workers: neighbours, which are often of one scene."""
    begin, end = (len(shards) * place // workers for place in (worker, worker + 1))
    return list(shards[begin:end])


def _in_turn(lines: Sequence[Connection]) -> Iterator[DatasetFrame]:
    """Yield what comes from workers, one of each in turn, until all have ended."""
    open_lines = list(lines)
    while open_lines:
        for line in list(open_lines):
            try:
                entry = line.recv()
            except (EOFError, OSError):  # it ended before an entry, or within one
                raise RecordingError(
                    "a worker of the stream was killed; it may need more memory than there is: "
                    "use fewer workers"
                ) from None
            if isinstance(entry, BaseException):
                raise entry
            if entry is None:
                open_lines.remove(line)
            else:
                yield entry


def _work(
    job: Job, shards: Sequence[int], ahead: int, line: Connection, threads: int, parent: int
) -> None:
    """Make frames in a process of its own and send them; sending waits until they are taken."""
    end_with_parent(parent)
    # Ctrl-C goes to all of the terminal; the parent ends its workers.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.environ[THREADS_VARIABLE] = str(threads)
    keep_freed_memory()
    frames = FrameLine(job, shards, ahead)
    try:
        for one in frames:
            line.send(one)
        line.send(None)
    except OSError:  # nobody takes them any more
        pass
    except Exception as problem:
        with contextlib.suppress(OSError):
            line.send(problem)
    finally:
        frames.close()
