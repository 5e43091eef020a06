"""The simulation without threads: one world, one renderer, its agents, and their frames.

`SceneSpec` in, `Frame` and `SceneInfo` out. Operations work on it; one thread alone uses it.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.render.contract import RenderBackend
from sailenv_ros.simulation.agent_record import AgentRecord
from sailenv_ros.simulation.agent_table import AgentTable
from sailenv_ros.simulation.clock import Clock
from sailenv_ros.simulation.editing.editor import SceneEditor
from sailenv_ros.simulation.editing.scene_writer import SceneWriter
from sailenv_ros.simulation.frame_maker import FrameMaker
from sailenv_ros.simulation.frame_stream import FrameStream
from sailenv_ros.simulation.live_info import scene_info_of
from sailenv_ros.simulation.live_scene import LiveScene, SceneAnnouncer
from sailenv_ros.simulation.present_scene import PresentScene
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.simulation.script.orchestrator import Orchestrator
from sailenv_ros.simulation.script.randomiser import RandomisationRequest, Randomiser
from sailenv_ros.simulation.script.scenario import NOTHING_MORE, SceneOverlay, wanted_scenario
from sailenv_ros.simulation.shutter import advance
from sailenv_ros.simulation.space_queries import SpaceQueries
from sailenv_ros.simulation.stream_schedule import StreamSchedule
from sailenv_ros.simulation.view_planes import view_planes
from sailenv_ros.space import FreeSpace
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.scene_info import SceneInfo, TimeMode
from sailenv_ros.types.snapshot import WorldSnapshot
from sailenv_ros.types.views import checked_views
from sailenv_ros.world.world import World

__all__ = ["SimulationCore"]

SLICE_STEPS = 24
"""Steps between two looks at whether the simulation shall end (0.1 s of simulated time)."""


class SimulationCore:
    """World, renderer and agents of one simulation.

    Parameters
    ----------
    library : SceneLibrary
        Where scenes and assets come from.
    scene : str or Path
        The first scene.
    renderer : RenderBackend
        Owned from now on; closed with this.
    clock : Clock
    should_end : callable
        Asked during long operations; True breaks them off.

    Attributes
    ----------
    clock : Clock
    scene : LiveScene
        World, agents and library.
    epoch : int
        Grows at each change of scene and each reset.
    additions : SceneOverlay
        What a scenario added to what the scene has by itself.
    orchestrator : Orchestrator
        Lets objects come and go.
    editor : SceneEditor
    scene_writer : SceneWriter
    space : SpaceQueries
    on_free_space : callable
        Told each `FreeSpace` that somebody asked for.
    on_info, on_step : callable
        Told each new `SceneInfo`, and the simulated time [ns] after physics advanced.
    frames : FrameMaker
    streams : StreamSchedule
    """

    def __init__(
        self,
        library: SceneLibrary,
        scene: str | Path,
        renderer: RenderBackend,
        *,
        mode: TimeMode,
        real_time_factor: float,
        seed: int,
        paused: bool,
        should_end: Callable[[], bool] = lambda: False,
    ) -> None:
        self.clock = Clock(mode, real_time_factor, paused=paused)
        self.epoch = 1
        self.additions = NOTHING_MORE
        self.on_free_space: Callable[[FreeSpace], None] = lambda space: None
        self.on_info: Callable[[SceneInfo], None] = lambda info: None
        self.on_step: Callable[[int], None] = lambda sim_time_ns: None
        self._should_end = should_end
        self._revision = 0
        self._announced: SceneInfo | None = None
        self.scene = LiveScene(
            library=library,
            agents=AgentTable(),
            announce=SceneAnnouncer(self._announce),
            world=library.build(scene, seed, self.epoch, self._next_revision),
            seed=seed,
        )
        self.world.frustum_planes = self._frustum_planes
        self.frames = FrameMaker(self.scene, renderer, lockstep=mode == "lockstep")
        self.streams = StreamSchedule(self.scene, self.render_all)
        self.space = SpaceQueries(lambda: self.world)
        self.editor = SceneEditor(self.scene)
        self.scene_writer = SceneWriter(self.scene)
        self.randomiser = Randomiser(self.scene, self.editor, self.view_scene)
        self.orchestrator = Orchestrator(self.scene, self.clock, self.randomiser.apply_drawn)
        for spec in library.agents_of(self.world.scene):
            self.agents.add(spec, self.world)
        self.randomiser.begin(RandomisationRequest())
        self.orchestrator.begin()
        self.randomiser.place_cameras()

    # -- the scene -------------------------------------------------------------------------

    @property
    def library(self) -> SceneLibrary:
        """Where scenes and assets come from."""
        return self.scene.library

    @property
    def agents(self) -> AgentTable:
        """The agents of all scenes."""
        return self.scene.agents

    @property
    def world(self) -> World:
        """The present world."""
        return self.scene.world

    @property
    def seed(self) -> int:
        """Seed of the present world's random numbers."""
        return self.scene.seed

    @property
    def info(self) -> SceneInfo:
        """The scene as clients see it; a new object with the present revision."""
        return scene_info_of(
            self.scene,
            self.clock,
            epoch=self.epoch,
            revision=self._revision,
            renderer=self.frames.description,
        )

    def announce(self) -> None:
        """Announce the scene as it is now, under a new revision."""
        self.scene.announce()

    def randomise_now(
        self, seed: int | None, index: int | None, things: object, record: object
    ) -> dict[str, Any]:
        """Begin the scene again with drawn values; see the operation `randomise`."""
        chance = self.randomiser.next_chance(index, things, record, seeded=seed is not None)
        chosen = self.seed if seed is None else seed
        if chance.record is not None:
            chosen = int(chance.record["seed"])
        self.begin(self.world.scene, chosen, as_registered=True, more=self.additions, chance=chance)
        self.randomiser.before_frame()
        return dict(self.randomiser.record or {})

    def begin_scenario(self, scenario: str | Mapping[str, Any]) -> tuple[int, ...]:
        """Begin a scene with more objects than its own; see the operation `load_scenario`."""
        viewer = next((agent.name for agent in self.agents.specs), "")
        scene, more = wanted_scenario(scenario, present=self.world.scene, viewer=viewer)
        self.begin(scene, self.seed, as_registered=False, more=more)
        ids = sorted((*self.world.bodies_by_id, *self.world.waiting))
        return tuple(ids[len(ids) - len(more.objects) :])

    def begin(
        self,
        scene: str,
        seed: int,
        *,
        as_registered: bool,
        more: SceneOverlay = NOTHING_MORE,
        chance: RandomisationRequest | None = None,
    ) -> None:
        """Leave the present world for a new one at simulated time 0.

        Parameters
        ----------
        scene : str
        seed : int
        as_registered : bool
            True puts the agents back to what they were on registration and keeps them alone;
            False adds those that the scene brings along.
        more : SceneOverlay
            What there is besides what the scene has by itself.
        chance : RandomisationRequest or None
            What decides what is drawn at random; None is the first epoch of what the scene draws.
        """
        world = self.library.build(scene, seed, self.epoch + 1, self._next_revision, more=more)
        brought = () if as_registered else self.library.agents_of(world.scene)
        try:
            self.agents.require_room(brought)
        except BaseException:
            world.close()
            raise
        world.frustum_planes = self._frustum_planes
        before = self.world, self.seed
        self.scene.world, self.scene.seed = world, seed
        self.frames.watch_light()
        try:
            with self.scene.announce.silent():
                self.randomiser.begin(chance or RandomisationRequest())
                self.orchestrator.begin()
        except BaseException:
            world.close()
            self.scene.world, self.scene.seed = before
            raise
        before[0].close()
        self.additions = more
        self.epoch += 1
        self.agents.begin_epoch(world, as_registered=as_registered)
        self.agents.add_missing(brought, world)
        with self.scene.announce.once():
            self.randomiser.place_cameras()
        self.frames.prepare(before[0].scene)
        self.streams.discard()
        self.announce()
        self.on_step(world.sim_time_ns)

    def refresh(self) -> None:
        """Take up furniture and light that were built meanwhile, in the present world too."""
        self.library.refresh()
        self.library.load_light(self.world)
        self.frames.watch_light()
        self.announce()

    # -- time ------------------------------------------------------------------------------

    def advance_to(self, step: int, *, every_frame: bool) -> None:
        """Run physics up to a step and render what falls due on the way.

        Parameters
        ----------
        every_frame : bool
            False renders, of several frames of one agent that have fallen due, the last alone
            and counts the others as skipped: the wall clock is ahead.
        """
        world = self.world

        due = partial(self.streams.due_steps, step, every_frame=every_frame)
        while world.step_count < step and not self._should_end():
            self.streams.render([name for name, at in due().items() if 0 <= at <= world.step_count])
            ahead = {name: at for name, at in due().items() if at > world.step_count}
            changes = self.orchestrator.next_step
            stops = () if changes is None else (max(changes, world.step_count + 1),)
            goal = min([step, world.step_count + SLICE_STEPS, *ahead.values(), *stops])
            advance(self.agents, world, goal - world.step_count)
            paused = self.clock.paused
            self.orchestrator.act()
            self.on_step(world.sim_time_ns)
            self.streams.render([name for name, at in ahead.items() if at == goal])
            if self.clock.paused != paused:
                break  # lessons have come to their end

    # -- frames ----------------------------------------------------------------------------

    @property
    def supported_views(self) -> tuple[str, ...]:
        """Views that the renderer can make, in the order of `frame.VIEWS`."""
        return self.frames.supported_views

    def render(self, record: AgentRecord, views: Iterable[str]) -> Frame:
        """Render one frame of an agent now.

        Raises
        ------
        UnknownName
            If the renderer cannot make a view, with those that it can.
        """
        return self.render_all([(record, views)])[0]

    def render_all(self, wanted: Sequence[tuple[AgentRecord, Iterable[str]]]) -> list[Frame]:
        """Render one frame of each of some agents now; see `render`."""
        known = self.supported_views
        began_s = time.perf_counter()
        checked = [(record, checked_views(views, supported=known)) for record, views in wanted]
        self.randomiser.before_frame()
        return self.frames.frames(
            checked,
            began_s=began_s,
            info=self._info_of_frames(),
            randomised=self.randomiser.record,
            lesson=self.orchestrator.state,
        )

    def view_scene(self, lens: CameraIntrinsics) -> PresentScene:
        """Return the scene as it stands now, for rules of cameras."""
        return PresentScene(self.world.snapshot(), lens, self.frames, self.space)

    def draw_amodal(self, snapshot: WorldSnapshot, camera: Camera, only: int = 0) -> AmodalMasks:
        """Draw each object of a snapshot alone, or one; see `FrameMaker.draw_amodal`."""
        return self.frames.draw_amodal(snapshot, camera, only)

    def open_stream(
        self, agent: str, views: Sequence[str], on_change: Callable[[FrameStream], None]
    ) -> FrameStream:
        """Begin to deliver an agent's frames at its rate."""
        return self.streams.open(agent, views, on_change, self.supported_views)

    def close(self, why: str = "it was closed") -> None:
        """End all streams; free the engine and the renderer."""
        self.streams.end(f"the simulation has ended: {why}")
        self.world.close()
        self.frames.close()

    def _frustum_planes(self, agent: str, distance_m: float) -> NDArray[np.float64]:
        """Return the planes of an agent's view; none while there is no such agent."""
        for record in self.agents:
            if record.spec.name == agent:
                return view_planes(self.agents.camera(record, self.world), distance_m)
        return np.zeros((0, 4))

    def _info_of_frames(self) -> SceneInfo:
        """Return what was announced last, which is what clients find a frame's ids in."""
        if self._announced is None or self._announced.revision < self.world.contents.revision:
            # At the beginning; later every operation announces what it changed.
            self._announced = self.info
        return self._announced

    def _announce(self) -> None:
        self._next_revision()
        self._announced = self.info
        self.on_info(self._announced)

    def _next_revision(self) -> int:
        self._revision += 1
        return self._revision
