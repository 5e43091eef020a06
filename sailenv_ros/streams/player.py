"""Plays a stream: the number of a frame in, the frame out.

A simulation in the caller's thread. It goes ahead from the last frame where that is possible, and
begins the episode again where it is not; what comes out is the same.
"""

from __future__ import annotations

import gc
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from sailenv_ros.errors import InvalidState
from sailenv_ros.frame.frame import Frame
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.simulation.finished_light import bake_missing
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.simulation.script.randomiser import RandomisationRequest
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.streams.course import Course
from sailenv_ros.streams.plan import Place, StreamPlan
from sailenv_ros.streams.staging import Stage
from sailenv_ros.streams.state import DriftRecord
from sailenv_ros.system.memory import forget_scenes, give_back_freed_memory
from sailenv_ros.types.agents import AgentSpec, due_steps
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.rigid_body import STEPS_PER_SECOND
from sailenv_ros.types.scene_info import SceneInfo
from sailenv_ros.types.views import VIEWS

__all__ = ["EYE", "Player"]

EYE = "stream_eye"
"""Name of the stream's agent."""

RENDERER = "native renderer on the CPU"
"""Told of every frame: neither instruction set nor threads, which differ from worker to worker."""

TICK = 50
"""Frames from one change of light and picture to the next."""

_LIGHT = ("lighting", "measurement")
"""Sources of views on which those of the next frame do not depend."""

SWAY_M, SWAY_DEG, SWAY_HZ = 0.02, 1.5, 1.8
"""How who is carried sways: up and down, about the axis of view, steps per second."""


class Player:
    """Makes frames of one stream; used by one thread.

    Parameters
    ----------
    course : Course
    plan : StreamPlan
    seed : int
        Of the stream.
    views : sequence of str
        Of every frame.
    drift_at : int or None
        The frame whose state of the world all have; None is each frame's own.
    """

    def __init__(
        self,
        course: Course,
        plan: StreamPlan,
        seed: int,
        views: Sequence[str],
        drift_at: int | None = None,
    ) -> None:
        self._course, self._plan, self._seed = course, plan, seed
        self._views, self._drift_at = tuple(views), drift_at
        truth = tuple(view for view in self._views if VIEWS[view].source not in _LIGHT)
        self._earlier = truth or ("instance",)
        self._due = due_steps(course.rate, course.episode)
        self._library: SceneLibrary | None = None
        self._renderer: NativeRenderer | None = None
        self._core: SynchronousSimulation | None = None
        self._stage: Stage | None = None
        self._at: Place | None = None
        self._drawn: tuple[Frame, Mapping[str, DriftRecord]] | None = None
        self._info: tuple[SceneInfo, SceneInfo] | None = None

    def frame(self, place: Place) -> tuple[Frame, Mapping[str, DriftRecord]]:
        """Return the frame at a place, and what each drift did to it.

        Raises
        ------
        SailenvError
            If its room cannot be made or built.
        """
        at = self._at
        if at is not None and at.frame == place.frame and self._drawn is not None:
            return self._drawn
        if at is None or at.episode != place.episode or at.offset >= place.offset:
            self._begin(self._plan.place(place.first))
        # Flow of a frame is that since the one before, which has to have been drawn.
        before = place.offset - 1
        assert self._at is not None
        if before >= 0 and not (self._at.offset == before and self._drawn is not None):
            self._go(before)
            self._stand_for_capture()
            self._world.capture(self._earlier, agent=EYE)
        self._go(place.offset)
        return self._draw()

    def close(self) -> None:
        """Free the simulation."""
        self._free()

    # -- inside ----------------------------------------------------------------------------

    @property
    def _world(self) -> SynchronousSimulation:
        if self._core is None:
            raise InvalidState("the stream is closed")
        return self._core

    def _begin(self, place: Place) -> None:
        """Begin an episode; nothing of the one before is left while its world is built."""
        if self._at is None or self._at.room != place.room:
            self._leave_room()
        self._at = self._drawn = None
        if self._library is None:
            self._library = SceneLibrary(baked_light=self._course.baked, drafts=False)
        path = self._library.path(place.room)
        seed = self._plan.dice(place.episode, "simulation").whole((0, 2**31 - 1))
        things = self._course.randomise or None
        fresh = self._core is None
        if self._core is None:
            self._renderer = NativeRenderer()
            self._core = SynchronousSimulation(self._library, path, self._renderer, seed=seed)
        if not fresh or things is not None:
            for spec in self._core.info.agents:
                self._core.delete_agent(spec.name)
            self._core.world.close()  # beside the next one it would take the most memory of all
            chance = RandomisationRequest(things=things)
            self._core.begin(str(path), seed, as_registered=False, chance=chance)
        if self._course.baked:
            bake_missing(self._core.world)
        eye = self._course.eye
        self._core.register_agent(
            AgentSpec(
                name=EYE,
                intrinsics=eye.lens(),
                rate_hz=0.0,
                views=self._views,
                following=False,
                picture=eye.picture.to_settings(),
            )
        )
        dice = self._plan.dice(place.episode, "stage")
        self._stage = Stage(self._core, dice, self._course, place, self._seed)
        state, _ = self._course.state(self._shown(place.frame), self._seed)
        self._stage.furnish(state)
        self._at = place
        self._show(place)

    def _leave_room(self) -> None:
        """Free the simulation and all that it was made of: the next room begins as the first."""
        if self._core is not None:
            self._free()
            self._library = None
            forget_scenes()
            gc.collect()  # a world refers to itself
            give_back_freed_memory()

    def _free(self) -> None:
        core, renderer = self._core, self._renderer
        self._core = self._renderer = self._stage = self._at = self._drawn = None
        if renderer is not None:
            renderer.forget()  # frames that somebody keeps know it
        if core is not None:
            core.close()

    def _go(self, offset: int) -> None:
        """Step to a frame of the episode, without drawing."""
        core, at = self._world, self._at
        assert at is not None
        if offset == at.offset:
            return
        core.step(self._due[offset] - self._due[at.offset])
        ticks = (at.frame + offset - at.offset) // TICK - at.frame // TICK
        self._at = replace(at, frame=at.first + offset, offset=offset)
        self._drawn = None
        if ticks:
            self._show(self._at)

    def _show(self, place: Place) -> None:
        """Light the room and set the camera as they are at this tick."""
        assert self._stage is not None
        state, _ = self._course.state(self._shown(_tick(place)), self._seed)
        self._stage.light(state, EYE)

    def _shown(self, frame: int) -> int:
        return frame if self._drift_at is None else self._drift_at

    def _stand_for_capture(self) -> None:
        assert self._at is not None
        assert self._stage is not None
        pose = _swayed(self._stage.eye(), self._at, self._due)
        self._world.set_pose(self._stage.mounted(pose), agent=EYE)

    def _draw(self) -> tuple[Frame, Mapping[str, DriftRecord]]:
        core = self._world
        self._stand_for_capture()
        assert self._at is not None
        _, records = self._course.state(self._shown(self._at.frame), self._seed)
        frame = self._told(core.capture(self._views, agent=EYE), self._at, records)
        self._drawn = frame, records
        return self._drawn

    def _told(self, frame: Frame, place: Place, records: Mapping[str, DriftRecord]) -> Frame:
        """Return a frame with numbers and times of the stream, whatever was played before it."""
        stamp_ns, told_ns = (
            round(frame * 1e9 / self._course.rate) for frame in (place.frame, _tick(place))
        )
        revision = 1 + place.frame // TICK + place.episode
        assert frame.info is not None
        if self._info is None or self._info[0] is not frame.info:
            told = replace(
                frame.info, epoch=1, revision=revision, sim_time_ns=told_ns, mode="lockstep",
                scenes=(frame.info.scene,), seed=self._seed, renderer=RENDERER,
            )  # fmt: skip
            self._info = frame.info, told
        stream = {
            "number": place.frame,
            "room": place.room,
            "episode": place.episode,
            "habit": place.habit,
            "drift": {name: record.to_json() for name, record in records.items()},
        }
        return replace(
            frame, agent="eye", epoch=1, revision=revision, sequence=place.frame,
            stamp_ns=stamp_ns, info=self._info[1], randomised={"stream": stream}, timings_s={},
        )  # fmt: skip


def _tick(place: Place) -> int:
    """Return the frame since which light and picture are as they are at a place."""
    return max(place.first, place.frame // TICK * TICK)


def _swayed(pose: Pose, place: Place, due: Sequence[int]) -> Pose:
    """Return the pose of a camera that is carried by somebody who walks."""
    if place.habit != "carry":
        return pose
    phase = 2.0 * math.pi * SWAY_HZ * due[place.offset] / STEPS_PER_SECOND
    sway = Pose.from_rpy_deg(
        (0.0, 0.0, SWAY_M * math.sin(phase)), (SWAY_DEG * math.sin(phase / 2.0), 0.0, 0.0)
    )
    return pose.carried(sway)
