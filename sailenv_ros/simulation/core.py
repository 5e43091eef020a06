"""The simulation without threads: one world, one renderer, its agents, and their frames.

`SceneSpec` in, `Frame` and `SceneInfo` out. What operations work on: each either does all that it
says or raises and leaves everything as it was. Used by one thread alone.
"""

from __future__ import annotations

import inspect
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.camera import Camera, CameraIntrinsics
from sailenv_ros.cpu_render.amodal_renderer import AmodalRenderer
from sailenv_ros.cpu_render.cpu_renderer import NativeRenderer
from sailenv_ros.frame import Frame, checked_views
from sailenv_ros.object_truth.amodal_masks import AmodalMasks
from sailenv_ros.operations import Operation, WorldOperations
from sailenv_ros.relight.relighter import Relighter
from sailenv_ros.render.backend import RenderBackend
from sailenv_ros.scene_info import MoverInfo, SceneInfo, TimeMode
from sailenv_ros.simulation.agent_table import AgentRecord, AgentTable
from sailenv_ros.simulation.clock import Clock
from sailenv_ros.simulation.editor import SceneEditor
from sailenv_ros.simulation.frame_stream import FrameStream
from sailenv_ros.simulation.orchestrator import Orchestrator
from sailenv_ros.simulation.present_scene import PresentScene
from sailenv_ros.simulation.randomiser import Chance, Randomiser
from sailenv_ros.simulation.scenario import NOTHING_MORE, Additions
from sailenv_ros.simulation.scene_writer import SceneWriter
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.simulation.space_queries import SpaceQueries
from sailenv_ros.simulation.view_planes import view_planes
from sailenv_ros.snapshot import Observation, WorldSnapshot
from sailenv_ros.space import FreeSpace
from sailenv_ros.world.world import World

__all__ = ["SimulationCore"]

SLICE_STEPS = 24
"""Steps between two looks at whether the simulation shall end (0.1 s of simulated time)."""


class SimulationCore(WorldOperations):
    """World, renderer and agents of one simulation; carries operations out at once.

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
    library : SceneLibrary
    clock : Clock
    agents : AgentTable
    world : World
        The present one.
    seed : int
        Of the present world's random numbers.
    epoch : int
        Grows at each change of scene and each reset.
    additions : Additions
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
    run_later : callable
        Runs a function in the thread that this belongs to, and returns its result: for frames
        whose objects are drawn alone when somebody asks for it.
    skipped_frames : int
        Streamed frames that were never rendered because the wall clock was ahead.
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
        self.library = library
        self.clock = Clock(mode, real_time_factor, paused=paused)
        self.agents = AgentTable()
        self.seed = seed
        self.epoch = 1
        self.additions = NOTHING_MORE
        self.orchestrator = Orchestrator(self)
        self.editor = SceneEditor(self)
        self.scene_writer = SceneWriter(self)
        self.randomiser = Randomiser(self)
        self._holds_announcements = False
        self._unannounced = False
        self.space = SpaceQueries(lambda: self.world)
        self.on_free_space: Callable[[FreeSpace], None] = lambda space: None
        self.on_info: Callable[[SceneInfo], None] = lambda info: None
        self.on_step: Callable[[int], None] = lambda sim_time_ns: None
        self.run_later: Callable[[Callable[[], AmodalMasks]], AmodalMasks] = lambda draw: draw()
        self.skipped_frames = 0
        self._renderer = renderer
        self._amodal: AmodalRenderer | None = None
        self._should_end = should_end
        self._revision = 0
        self._announced: SceneInfo | None = None
        self.world: World = library.build(scene, seed, self.epoch, self._next_revision)
        self.world.frustum_planes = self._frustum_planes
        self._relighter = Relighter()
        self._relighter.watch(self.world.snapshot())
        for spec in library.agents_of(self.world.scene):
            self.agents.add(spec, self.world)
        self.randomiser.begin(Chance())
        self.orchestrator.begin()
        self.randomiser.place_cameras()

    # -- operations ------------------------------------------------------------------------

    def submit_operation(
        self, operation: Operation[..., Any], arguments: inspect.BoundArguments
    ) -> Future[Any]:
        """Carry an operation out now."""
        done: Future[Any] = Future()
        done.set_result(operation.run(self, *arguments.args, **arguments.kwargs))
        return done

    @property
    def info(self) -> SceneInfo:
        """The scene as clients see it; a new object with the present revision."""
        contents = self.world.contents
        return SceneInfo(
            scene=self.world.scene,
            scenes=self.library.scene_names,
            epoch=self.epoch,
            revision=self._revision,
            sim_time_ns=self.world.sim_time_ns,
            mode=self.clock.mode,
            paused=self.clock.paused,
            real_time_factor=self.clock.real_time_factor,
            seed=self.seed,
            categories=contents.categories,
            instances=tuple(drawn.instance for drawn in contents.instances),
            moving=self.world.moving_ids,
            spawnables=self.library.spawnables,
            lights=contents.lights,
            environment=contents.environment,
            agents=self.agents.specs,
            movers=tuple(
                MoverInfo(
                    name=mover.name,
                    controller=mover.controller,
                    waypoints=mover.waypoints,
                    total_time_s=mover.total_time_s,
                    loop=mover.loop,
                    body=None if mover.body is None else mover.body.rigid,
                    look_at=mover.look_at,
                )
                for mover in self.world.movers.values()
            ),
            renderer=self._renderer.description,
        )

    def announce(self) -> None:
        """Announce the scene as it is now, under a new revision."""
        if self._holds_announcements:
            self._unannounced = True
            return
        self._next_revision()
        self._announced = self.info
        self.on_info(self._announced)

    @contextmanager
    def announced_once(self) -> Iterator[None]:
        """Announce the scene once after several changes, if there were any."""
        if self._holds_announcements:
            yield
            return
        self._holds_announcements, self._unannounced = True, False
        try:
            yield
        finally:
            self._holds_announcements = False
            if self._unannounced:
                self.announce()

    def randomise_now(
        self, seed: int | None, index: int | None, things: object, record: object
    ) -> dict[str, Any]:
        """Begin the scene anew with drawn values; see the operation `randomise`."""
        chance = self.randomiser.next_chance(index, things, record, seeded=seed is not None)
        chosen = self.seed if seed is None else seed
        if chance.record is not None:
            chosen = int(chance.record["seed"])
        self.begin(self.world.scene, chosen, as_registered=True, more=self.additions, chance=chance)
        self.randomiser.before_frame()
        return dict(self.randomiser.record or {})

    def begin(
        self,
        scene: str,
        seed: int,
        *,
        as_registered: bool,
        more: Additions = NOTHING_MORE,
        chance: Chance | None = None,
    ) -> None:
        """Leave the present world for a new one at simulated time 0.

        Parameters
        ----------
        scene : str
        seed : int
        as_registered : bool
            True puts the agents back to what they were on registration and keeps them alone;
            False adds those that the scene brings along.
        more : Additions
            What there is besides what the scene has by itself.
        chance : Chance or None
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
        before = self.world, self.seed, self.additions
        self.world, self.seed, self.additions = world, seed, more
        self._relighter.watch(world.snapshot())
        self._holds_announcements = True
        try:
            self.randomiser.begin(chance or Chance())
            self.orchestrator.begin()
        except BaseException:
            world.close()
            self.world, self.seed, self.additions = before
            raise
        finally:
            self._holds_announcements = False
        before[0].close()
        self.epoch += 1
        self.agents.begin_epoch(world, as_registered=as_registered)
        self.agents.add_missing(brought, world)
        with self.announced_once():
            self.randomiser.place_cameras()
        for record in self.agents:
            for stream in record.streams:
                stream.discard()
        self.announce()
        self.on_step(world.sim_time_ns)

    def refresh(self) -> None:
        """Take up furniture and light that were built meanwhile, in the present world too."""
        self.library.refresh()
        self.library.load_light(self.world)
        self._relighter.watch(self.world.snapshot())
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

        def due() -> dict[str, int]:
            return {
                record.spec.name: record.due_step() if every_frame else record.last_due_step(step)
                for record in self._streamed()
            }

        while world.step_count < step and not self._should_end():
            self._render_streams(name for name, at in due().items() if 0 <= at <= world.step_count)
            ahead = {name: at for name, at in due().items() if at > world.step_count}
            changes = self.orchestrator.next_step
            stops = () if changes is None else (max(changes, world.step_count + 1),)
            goal = min([step, world.step_count + SLICE_STEPS, *ahead.values(), *stops])
            world.step(goal - world.step_count)
            paused = self.clock.paused
            self.orchestrator.act()
            self.on_step(world.sim_time_ns)
            self._render_streams(name for name, at in ahead.items() if at == goal)
            if self.clock.paused != paused:
                break  # lessons have come to their end

    def render_due(self) -> None:
        """Render each agent's streamed frame if its time has come; once each."""
        now = self.world.step_count
        self._render_streams(r.spec.name for r in self._streamed() if r.due_step() <= now)

    def next_due_step(self) -> int | None:
        """Return the step of the earliest streamed frame to come; None if nobody wants any."""
        return min((record.due_step() for record in self._streamed()), default=None)

    # -- frames ----------------------------------------------------------------------------

    @property
    def supported_views(self) -> tuple[str, ...]:
        """Views that the renderer can make, in the order of `frame.VIEWS`."""
        return self._renderer.supported_views

    def render(self, record: AgentRecord, views: Iterable[str]) -> Frame:
        """Render one frame of an agent now.

        Raises
        ------
        UnknownName
            If the renderer cannot make a view, with those that it can.
        """
        wanted = checked_views(views, supported=self.supported_views)
        began = time.perf_counter()
        self.randomiser.before_frame()
        snapshot = self._relighter.lit(
            self.world.snapshot(),
            wanted="rgb" in wanted,
            lockstep=self.clock.mode == "lockstep",
            changed_ns=self.world.changed_ns,
        )
        camera = self.agents.camera(record, self.world)
        past = record.past(snapshot.sim_time_ns)
        rendered = self._renderer.render(snapshot, past, camera, wanted)
        record.remember(Observation(snapshot=snapshot, camera=camera, depth=rendered.depth))
        record.sequence += 1
        info = self._info_of_frames()
        return Frame(
            agent=record.spec.name,
            scene=info.scene,
            epoch=info.epoch,
            revision=info.revision,
            sequence=record.sequence,
            stamp_ns=snapshot.sim_time_ns,
            dt_ns=0 if past is None else snapshot.sim_time_ns - past.snapshot.sim_time_ns,
            camera=camera,
            depth_range_m=record.spec.depth_range_m,
            views=rendered.views,
            timings_s={**rendered.timings_s, "render": time.perf_counter() - began},
            info=info,
            states=self.world.states(),
            randomised=self.randomiser.record,
            lesson=self.orchestrator.state,
            draw_amodal=lambda only=0: self.run_later(
                lambda: self.draw_amodal(snapshot, camera, only)
            ),
        )

    def look(self, camera: Camera, *views: str) -> Mapping[str, NDArray[Any]]:
        """Render views of the scene as it stands now, through a camera that is no agent's."""
        return self._renderer.render(self.world.snapshot(), None, camera, views).views

    def view_scene(self, lens: CameraIntrinsics) -> PresentScene:
        """Return the scene as it stands now, for rules of cameras."""
        return PresentScene(self, lens)

    def draw_amodal(self, snapshot: WorldSnapshot, camera: Camera, only: int = 0) -> AmodalMasks:
        """Draw each object of a snapshot alone, whatever is seen of it; or only the one of that id.

        Raises
        ------
        NativeLibraryError
            If there is no native library, which draws them.
        """
        if self._amodal is None:
            renderer = self._renderer
            table = renderer.part_table if isinstance(renderer, NativeRenderer) else None
            self._amodal = AmodalRenderer(table)
        return self._amodal.draw(snapshot, camera, only)

    def open_stream(
        self, agent: str, views: Sequence[str], on_change: Callable[[FrameStream], None]
    ) -> FrameStream:
        """Begin to deliver an agent's frames at its rate."""
        record = self.agents[agent]
        stream = FrameStream(agent, views, on_change, supported=self.supported_views)
        record.streams.append(stream)
        if record.spec.rate_hz:
            record.skip_to(self.world.step_count)
        return stream

    def close(self, why: str = "it was closed") -> None:
        """End all streams; free the engine and the renderer."""
        for record in self.agents:
            for stream in record.streams:
                stream.end(f"the simulation has ended: {why}")
        self.world.close()
        self._relighter.close()
        if self._amodal is not None:
            self._amodal.close()
        self._renderer.close()

    # -- inside ----------------------------------------------------------------------------

    def _streamed(self) -> list[AgentRecord]:
        """Return the agents whose frames somebody wants now; forgets streams that were closed."""
        wanted = []
        for record in self.agents:
            record.streams[:] = [stream for stream in record.streams if not stream.closed]
            if not record.spec.rate_hz:
                continue
            if record.wanted_views:
                wanted.append(record)
            else:
                record.skip_to(self.world.step_count)
        return wanted

    def _render_streams(self, agents: Iterable[str]) -> None:
        """Render a frame of each agent for its streams, and count those it is too late for."""
        now = self.world.step_count
        for name in agents:
            record = self.agents[name]
            # Another frame of this walk may have taken so long that this stream was closed.
            if record.due_step() > now or not record.wanted_views:
                continue
            # Who changes its mind while this is drawn gets it all the same: it is not drawn again.
            waiting = [stream for stream in record.streams if stream.views]
            frame = self.render(record, record.wanted_views)
            # One of those that are passed over is the frame just made.
            self.skipped_frames += max(0, record.skip_to(now + 1) - 1)
            for stream in waiting:
                stream.put(frame)

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

    def _next_revision(self) -> int:
        self._revision += 1
        return self._revision
