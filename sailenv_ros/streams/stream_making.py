"""A stream's script → a bag, part by part, so that one that was broken off goes on where it was.

A lockstep simulation, every frame exactly once; the same stream, seed and options give the same
messages, whether or not it was broken off (but for `render_s`). What is not whole lies in a folder
beside, which `stream_parts` keeps.
"""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sailenv_ros.agents import AgentSpec
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame import Frame, checked_views
from sailenv_ros.motion import FORWARD_VIEWS
from sailenv_ros.recording.lockstep import FrameRecorder, due_steps
from sailenv_ros.recording.writer import RecordingWriter
from sailenv_ros.render.backend import BackendName
from sailenv_ros.scene_info import SceneInfo
from sailenv_ros.simulation import Simulation
from sailenv_ros.streams.stream_parts import StreamFolder
from sailenv_ros.streams.stream_table import StreamKind
from sailenv_ros.system.futures import wait_for

__all__ = ["PART_FRAMES", "StreamJob", "make_stream", "stream_pairs"]

PART_FRAMES = 500
"""Frames in each file of the bag: what is lost at most when it is broken off."""

FRAME_TIMEOUT_S = 120.0

MOST_FRAMES = 10_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamJob:
    """What is to be made.

    Attributes
    ----------
    kind : StreamKind
    frames : int
        How many; frame 0 is at time 0.
    seed : int
        Of the simulation, and of what pushes.
    views : tuple of str
        Views of every frame; none means those of the scene's agent.
    backend : str
        Renderer, as of `Simulation`.
    """

    kind: StreamKind
    frames: int
    seed: int = 0
    views: tuple[str, ...] = ()
    backend: BackendName = "auto"

    def __post_init__(self) -> None:
        """Check all.

        Raises
        ------
        InvalidRequest
            If a number or a view cannot be accepted.
        """
        if not 2 <= self.frames <= MOST_FRAMES:
            raise InvalidRequest("frames", self.frames, f"2 to {MOST_FRAMES}")
        if not 0 <= self.seed < 2**63:
            raise InvalidRequest("seed", self.seed, "0 to 2**63 - 1")
        late = [view for view in self.views if view in FORWARD_VIEWS]
        if late:
            raise InvalidRequest(
                "view", late[0], "a view of a frame alone; export makes the others"
            )
        if self.views:
            checked_views(self.views)

    @property
    def identity(self) -> dict[str, Any]:
        """What a stream that was broken off must agree in to be gone on with."""
        scene = self.kind.scene.read_bytes()
        return {
            "stream": self.kind.name,
            "frames": self.frames,
            "rate_hz": self.kind.rate_hz,
            "lap_frames": self.kind.lap_frames if self.kind.laps else None,
            "seed": self.seed,
            "views": list(self.views),
            "part_frames": PART_FRAMES,
            "scene_sha256": hashlib.sha256(scene).hexdigest(),
        }


def make_stream(
    job: StreamJob, output: str | Path, *, on_frame: Callable[[int], None] = lambda done: None
) -> Path:
    """Make a stream's bag, or go on with one of the same job that was broken off.

    Parameters
    ----------
    job : StreamJob
    output : str or Path
        The bag's folder. It is there when all is written, and not before.
    on_frame : callable
        Called with the number of frames that are done, after each.

    Returns
    -------
    output : Path

    Raises
    ------
    RecordingError
        If `output` or the unfinished folder beside it is another's, or cannot be written.
    """
    folder = StreamFolder(Path(output), job.identity)
    with folder.opened():
        if folder.is_whole:
            on_frame(job.frames)
            return folder.path
        begin = folder.parts * PART_FRAMES
        if begin < job.frames:
            _make_parts(job, folder, begin, on_frame)
        return folder.finish()


def stream_pairs(job: StreamJob, pairs: int) -> Iterator[tuple[int, Frame, Frame, SceneInfo]]:
    """Return frames that follow each other, spread evenly over a stream, without the ones between.

    Parameters
    ----------
    job : StreamJob
    pairs : int
        How many; at most half the frames.

    Yields
    ------
    number : int
        Of the later frame.
    before, now : Frame
    info : SceneInfo

    Raises
    ------
    InvalidRequest
        If there are not so many pairs.
    """
    if not 1 <= pairs <= job.frames // 2:
        raise InvalidRequest("pairs", pairs, f"1 to {job.frames // 2}")
    numbers = {1 + place * (job.frames - 1) // pairs for place in range(pairs)}
    views = checked_views(job.views) if job.views else None
    pusher = job.kind.pusher(job.seed) if job.kind.pusher is not None else None
    with Simulation(
        job.kind.scene, mode="lockstep", seed=job.seed, backend=job.backend
    ) as simulation:
        spec, step = simulation.info.agents[0], 0
        before: Frame | None = None
        for number, due in enumerate(due_steps(job.kind.rate_hz, max(numbers) + 1)):
            if pusher is not None and number:
                pusher.push(simulation, number)
            if due > step:
                simulation.step.submit(due - step)
                step = due
            if number not in numbers and number + 1 not in numbers:
                continue
            frame = _await(simulation.capture.submit(views, agent=spec.name))
            if number in numbers and before is not None:
                yield number, before, frame, simulation.info
            before = frame


def _make_parts(
    job: StreamJob, folder: StreamFolder, begin: int, on_frame: Callable[[int], None]
) -> None:
    with Simulation(
        job.kind.scene, mode="lockstep", seed=job.seed, backend=job.backend
    ) as simulation:
        spec = simulation.info.agents[0]
        frames = _frames(job, simulation, spec, begin)
        for first in range(begin, job.frames, PART_FRAMES):
            last = min(first + PART_FRAMES, job.frames)
            with folder.part() as draft, RecordingWriter(draft) as writer:
                recorder = FrameRecorder(writer)
                for number in range(first, last):
                    frame = next(frames)
                    if number == first:
                        # As if it had been announced now: log times never go back.
                        info = dataclasses.replace(simulation.info, sim_time_ns=frame.stamp_ns)
                        recorder.write_info(info)
                    recorder.write_frame(frame, spec.depth_range_m)
                    on_frame(number + 1)


def _frames(job: StreamJob, simulation: Simulation, spec: AgentSpec, begin: int) -> Iterator[Frame]:
    """Return the frames from `begin` on; each is asked for before the one before is used."""
    views = checked_views(job.views) if job.views else None
    pusher = job.kind.pusher(job.seed) if job.kind.pusher is not None else None
    step = 0
    asked: Future[Frame] | None = None
    for number, due in enumerate(due_steps(job.kind.rate_hz, job.frames)):
        if pusher is not None and number:
            pusher.push(simulation, number)
        if due > step:
            simulation.step.submit(due - step)
            step = due
        if number < begin - 1:
            continue
        following = simulation.capture.submit(views, agent=spec.name)
        if asked is not None:
            yield _await(asked)
        if number < begin:
            # Flow of the first frame that is kept is measured from this one on.
            _await(following)
            continue
        asked = following
    if asked is not None:
        yield _await(asked)


def _await(asked: Future[Frame]) -> Frame:
    frame: Frame = wait_for(asked, "a frame to be rendered", FRAME_TIMEOUT_S)
    return frame
