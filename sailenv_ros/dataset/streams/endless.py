"""A part of an endless stream → a bag, file by file, so that one that was interrupted continues.

The frames are those of `sailenv_ros.streams`, which can begin anywhere. What each drift does to a
frame stands in its `frame_info`, under ``randomised``.
"""

from __future__ import annotations

import hashlib
import itertools
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import sailenv_ros.streams as streams
from sailenv_ros.dataset.streams.making import PART_FRAMES, part_count, record_parts
from sailenv_ros.dataset.streams.parts import StreamFolder
from sailenv_ros.dataset.worker_pool import WorkerPool
from sailenv_ros.recording.lockstep import FrameRecorder
from sailenv_ros.simulation.generated_scenes import generation_state
from sailenv_ros.streams import Course
from sailenv_ros.streams.course import MOST_FRAMES
from sailenv_ros.system.memory import keep_freed_memory
from sailenv_ros.types.validation import checked_integer
from sailenv_ros.types.views import checked_views

__all__ = ["EndlessJob", "make_endless"]

MOST_WORKERS = 256


@dataclass(frozen=True, slots=True, kw_only=True)
class EndlessJob:
    """Frames of an endless stream to be written.

    Attributes
    ----------
    course : Course
    frames : int
        How many, 1 to 10,000,000.
    begin : int
        Number of the first.
    seed : int
        Of the stream.
    views : tuple of str
        Of every frame; none means those of `streams.VIEWS`.
    part_frames : int
        Of each file but the last.
    """

    course: Course
    frames: int
    begin: int = 0
    seed: int = 0
    views: tuple[str, ...] = field(default=streams.VIEWS)
    part_frames: int = PART_FRAMES

    def __post_init__(self) -> None:
        """Check all.

        Raises
        ------
        InvalidRequest, UnknownName
            If a number or a view cannot be accepted.
        """
        checked_integer("begin", self.begin, 0, MOST_FRAMES - 1)
        checked_integer("frames", self.frames, 1, MOST_FRAMES - self.begin)
        checked_integer("part_frames", self.part_frames, 1, MOST_FRAMES)
        checked_views(self.views)

    @property
    def identity(self) -> dict[str, Any]:
        """Identity that an interrupted stream must have to be resumed."""
        course = self.course.model_dump_json().encode()
        return {
            "stream": self.course.name,
            "course_sha256": hashlib.sha256(course).hexdigest(),
            "rate_hz": self.course.rate,
            "rooms": generation_state(),
            "seed": self.seed,
            "begin": self.begin,
            "frames": self.frames,
            "views": list(self.views),
            "part_frames": self.part_frames,
        }


def make_endless(
    job: EndlessJob,
    output: str | Path,
    *,
    workers: int = 1,
    on_frame: Callable[[int], None] = lambda done: None,
) -> Path:
    """Write a bag, or continue one of the same job that was interrupted.

    Parameters
    ----------
    job : EndlessJob
    output : str or Path
        The bag's folder. It is there when all is written, and not before.
    workers : int
        Processes that write files of it at once, 1 to 256. The bytes do not depend on it.
    on_frame : callable
        Called now and then with the number of frames that are done.

    Raises
    ------
    InvalidRequest
        If there cannot be so many workers.
    RecordingError
        If `output` or the unfinished folder beside it is another's, or cannot be written.
    """
    workers = checked_integer("workers", workers, 1, MOST_WORKERS)
    folder = StreamFolder(Path(output), job.identity)

    def make(missing: list[int]) -> None:
        due = sum(len(_frames_of(job, number)) for number in missing)
        whole = job.frames - due
        if not missing:
            on_frame(job.frames)
        elif workers == 1:
            counted = itertools.count(whole + 1)
            with _PartMaker(job, folder, lambda: on_frame(next(counted))) as maker:
                for number in missing:
                    maker.make(number)
        else:
            pool = WorkerPool(
                workers=workers, maker=_maker, arguments=(job, str(output)), piece="part"
            )
            for _ in pool.run(missing, lambda made: on_frame(whole + min(made, due))):
                pass
            on_frame(job.frames)

    return folder.filled(part_count(job.frames, job.part_frames), make)


class _PartMaker:
    """Makes parts of a bag by their numbers; a context manager."""

    def __init__(self, job: EndlessJob, folder: StreamFolder, on_frame: Callable[[], None]) -> None:
        self._job, self._folder, self._on_frame = job, folder, on_frame
        self._stream = streams.open(job.course, seed=job.seed, views=job.views)

    def __enter__(self) -> _PartMaker:
        return self

    def __exit__(self, *exc: object) -> None:
        self._stream.close()

    def make(self, number: int) -> int:
        """Write a part; return its number."""
        job = self._job

        def record(recorder: FrameRecorder, number: int, begins: bool) -> None:
            recorder.write_told(self._stream[job.begin + number].frame)

        frames = _frames_of(job, number)
        record_parts(self._folder, frames, job.part_frames, record, lambda _: self._on_frame())
        return number


def _maker(job: EndlessJob, output: str, on_frame: Callable[[], None]) -> Callable[[int], int]:
    """Return what makes parts in a worker, whose end frees all."""
    keep_freed_memory(many_scenes=True)
    return _PartMaker(job, StreamFolder(Path(output), job.identity), on_frame).make


def _frames_of(job: EndlessJob, number: int) -> range:
    """Return the frames of a part, counted from the bag's first."""
    first = number * job.part_frames
    return range(first, min(first + job.part_frames, job.frames))
