"""A part of an endless stream → a bag, file by file, so that one that was interrupted continues.

The frames are those of `sailenv_ros.streams`, which can begin anywhere. What each drift does to a
frame stands in its `frame_info`, under ``randomised``.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import sailenv_ros.streams as streams
from sailenv_ros.dataset.streams.making import PART_FRAMES, record_parts
from sailenv_ros.dataset.streams.parts import StreamFolder
from sailenv_ros.recording.lockstep import FrameRecorder
from sailenv_ros.simulation.generated_scenes import generation_state
from sailenv_ros.streams import Course
from sailenv_ros.streams.course import MOST_FRAMES
from sailenv_ros.types.validation import checked_integer
from sailenv_ros.types.views import checked_views

__all__ = ["EndlessJob", "make_endless"]


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
    """

    course: Course
    frames: int
    begin: int = 0
    seed: int = 0
    views: tuple[str, ...] = field(default=streams.VIEWS)

    def __post_init__(self) -> None:
        """Check all.

        Raises
        ------
        InvalidRequest, UnknownName
            If a number or a view cannot be accepted.
        """
        checked_integer("begin", self.begin, 0, MOST_FRAMES - 1)
        checked_integer("frames", self.frames, 1, MOST_FRAMES - self.begin)
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
            "part_frames": PART_FRAMES,
        }


def make_endless(
    job: EndlessJob, output: str | Path, *, on_frame: Callable[[int], None] = lambda done: None
) -> Path:
    """Write a bag, or continue one of the same job that was interrupted.

    Parameters
    ----------
    job : EndlessJob
    output : str or Path
        The bag's folder. It is there when all is written, and not before.
    on_frame : callable
        Called with the number of frames that are done, after each.

    Raises
    ------
    RecordingError
        If `output` or the unfinished folder beside it is another's, or cannot be written.
    """
    folder = StreamFolder(Path(output), job.identity)
    return folder.filled(
        job.frames, PART_FRAMES, lambda begin: _make_parts(job, folder, begin, on_frame), on_frame
    )


def _make_parts(
    job: EndlessJob, folder: StreamFolder, begin: int, on_frame: Callable[[int], None]
) -> None:
    with streams.open(job.course, seed=job.seed, views=job.views) as stream:

        def record(recorder: FrameRecorder, number: int, begins: bool) -> None:
            recorder.write_told(stream[job.begin + number].frame)

        record_parts(folder, range(begin, job.frames), PART_FRAMES, record, on_frame)
