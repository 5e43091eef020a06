"""A stream's script → a bag, part by part, so that one that was interrupted continues where it was.

A lockstep simulation, every frame exactly once; the same stream, seed and options give the same
messages, whether or not it was interrupted (but for `render_s`), and whatever light lies in the
cache. What is not whole lies in a folder beside, which `parts` keeps.
"""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sailenv_ros.dataset.streams.content import scene_content
from sailenv_ros.dataset.streams.parts import StreamFolder
from sailenv_ros.dataset.streams.table import StreamKind
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.motion import FORWARD_VIEWS
from sailenv_ros.recording.lockstep import (
    FRAME_TIMEOUT_S,
    FrameRecorder,
    rendered,
    rendered_ahead,
)
from sailenv_ros.recording.writer import RecordingWriter
from sailenv_ros.render.contract import BackendName
from sailenv_ros.simulation import Simulation
from sailenv_ros.system.futures import wait_for
from sailenv_ros.types.agents import due_steps
from sailenv_ros.types.light_choice import STEADY_LIGHTS, SteadyLight, checked_light
from sailenv_ros.types.scene_info import SceneInfo
from sailenv_ros.types.views import checked_views

__all__ = [
    "PART_FRAMES",
    "StreamJob",
    "make_stream",
    "part_count",
    "record_parts",
    "stream_pairs",
]

PART_FRAMES = 500
"""Frames in each file of the bag: what is lost at most when it is interrupted."""

MOST_FRAMES = 10_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamJob:
    """Settings of a stream to be made.

    Attributes
    ----------
    kind : StreamKind
    frames : int
        How many; frame 0 is at time 0.
    seed : int
        Of the simulation, and of what pushes.
    views : tuple of str
        Views of every frame; none means those of the scene's agent.
    light : {'plain', 'baked'}
        Of a stream with a room: without bounced light, or with, baked first where it is not yet.
    backend : str
        Renderer, as of `Simulation`.
    """

    kind: StreamKind
    frames: int
    seed: int = 0
    views: tuple[str, ...] = ()
    light: SteadyLight = "plain"
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
        checked_light(self.light, STEADY_LIGHTS)
        if self.views:
            checked_views(self.views)

    @property
    def wanted_views(self) -> tuple[str, ...] | None:
        """Views to ask for; None asks for those of the scene's agent."""
        return checked_views(self.views) if self.views else None

    @property
    def identity(self) -> dict[str, Any]:
        """Identity that an interrupted stream must have to be resumed.

        Besides light and models, see `scene_content`.
        """
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
    """Make a stream's bag, or continue one of the same job that was interrupted.

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
    # What is another's is refused now, not after light was baked for it.
    StreamFolder(Path(output), job.identity)
    content = scene_content(job.kind.scene, job.seed, job.light)
    folder = StreamFolder(Path(output), {**job.identity, **content})

    def make(missing: list[int]) -> None:
        if missing:  # from there to the end: nobody but `make_endless` leaves a gap
            _make_parts(job, folder, missing[0] * PART_FRAMES, on_frame)
        else:
            on_frame(job.frames)

    return folder.filled(part_count(job.frames, PART_FRAMES), make)


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
    with _opened(job) as simulation:
        before: Frame | None = None
        for number in _walk(job, simulation, max(numbers) + 1):
            if number not in numbers and number + 1 not in numbers:
                continue
            frame = rendered(_asked(job, simulation))
            if number in numbers and before is not None:
                yield number, before, frame, simulation.info
            before = frame


def _make_parts(
    job: StreamJob, folder: StreamFolder, begin: int, on_frame: Callable[[int], None]
) -> None:
    with _opened(job) as simulation:
        depth_range_m = simulation.info.agents[0].depth_range_m
        frames = rendered_ahead(_asked_from(job, simulation, begin))

        def record(recorder: FrameRecorder, number: int, begins: bool) -> None:
            frame = next(frames)
            if begins:
                # As if it had been announced now: log times never go back.
                info = dataclasses.replace(simulation.info, sim_time_ns=frame.stamp_ns)
                recorder.write_info(info)
            recorder.write_frame(frame, depth_range_m)

        record_parts(folder, range(begin, job.frames), PART_FRAMES, record, on_frame)


def part_count(frames: int, part_frames: int) -> int:
    """Return the number of parts of so many frames."""
    return -(-frames // part_frames)


def record_parts(
    folder: StreamFolder,
    frames: range,
    part_frames: int,
    record: Callable[[FrameRecorder, int, bool], None],
    on_frame: Callable[[int], None],
) -> None:
    """Write the parts of a bag.

    Parameters
    ----------
    folder : StreamFolder
    frames : range
        Numbers of frames that are missing; the first begins a part.
    part_frames : int
        Of each part but the last.
    record : callable
        ``record(recorder, number, begins)`` writes a frame; `begins` is true for the first of a
        part, which has to tell of the scene.
    on_frame : callable
        Called with the number of the next frame, after each.
    """
    for first in frames[::part_frames]:
        with folder.part(first // part_frames) as draft, RecordingWriter(draft) as writer:
            recorder = FrameRecorder(writer)
            for number in range(first, min(first + part_frames, frames.stop)):
                record(recorder, number, number == first)
                on_frame(number + 1)


def _opened(job: StreamJob) -> Simulation:
    return Simulation(
        job.kind.scene, mode="lockstep", seed=job.seed, backend=job.backend, light=job.light
    )


def _walk(job: StreamJob, simulation: Simulation, count: int) -> Iterator[int]:
    """Lead the simulation from frame to frame, and yield the number of each when it is due."""
    forces = job.kind.forces(job.seed) if job.kind.forces is not None else None
    step, stepped = 0, None
    for number, due in enumerate(due_steps(job.kind.rate_hz, count)):
        if forces is not None and number:
            forces.apply(simulation, number)
        if due > step:
            if stepped is not None:
                # Where frames are passed over, the deadline is one frame's, not of the whole way.
                wait_for(stepped, "physics to step to a frame", FRAME_TIMEOUT_S)
            stepped = simulation.step.submit(due - step)
            step = due
        yield number


def _asked(job: StreamJob, simulation: Simulation) -> Future[Frame]:
    asked: Future[Frame] = simulation.capture.submit(
        job.wanted_views, agent=simulation.info.agents[0].name
    )
    return asked


def _asked_from(job: StreamJob, simulation: Simulation, begin: int) -> Iterator[Future[Frame]]:
    """Ask for the frames from `begin` on."""
    for number in _walk(job, simulation, job.frames):
        if number == begin - 1:
            # Flow of the first frame that is kept is measured from this one on.
            rendered(_asked(job, simulation))
        elif number >= begin:
            yield _asked(job, simulation)
