"""The simulation without threads: one world, one renderer, its agents, and every request.

`SceneSpec` in, `Frame` and `SceneInfo` out. Each public method is one request of a client; it
either does all of it or raises and leaves everything as it was. Used by one thread alone.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame import Frame, checked_views
from sailenv_ros.render.backend import RenderBackend
from sailenv_ros.scene_info import MoverInfo, SceneInfo, TimeMode
from sailenv_ros.simulation.agent_requests import AgentRequests
from sailenv_ros.simulation.agent_table import AgentRecord, AgentTable
from sailenv_ros.simulation.motion_requests import MotionRequests
from sailenv_ros.simulation.save_requests import SaveRequests
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.simulation.stream import FrameStream
from sailenv_ros.simulation.world_requests import Entries, WorldRequests
from sailenv_ros.snapshot import Observation
from sailenv_ros.world.world import World

__all__ = ["MAX_STEPS", "SimulationCore"]

MAX_STEPS = 1_000_000
"""Most steps that one request may ask for (over an hour of simulated time)."""

SLICE_STEPS = 24
"""Steps between two looks at whether the simulation shall end (0.1 s of simulated time)."""


def checked_real_time_factor(factor: float) -> float:
    """Give the factor as it was given, or raise `InvalidRequest`."""
    value: object = factor
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if not is_number or not 0.1 <= factor <= 10.0:
        raise InvalidRequest("real_time_factor", factor, "a number from 0.1 to 10")
    return factor


class SimulationCore(AgentRequests, MotionRequests, SaveRequests, WorldRequests):
    """World, renderer and agents of one simulation.

    Parameters
    ----------
    library : SceneLibrary
        Where scenes and assets come from.
    scene : str or Path
        The first scene.
    renderer : RenderBackend
        Owned from now on; closed with this.
    should_end : callable
        Asked during long requests; True breaks them off.
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
        self._library = library
        self._renderer = renderer
        self._mode: TimeMode = mode
        self._real_time_factor = checked_real_time_factor(real_time_factor)
        self._seed = seed
        self._more: Entries = ()
        self._paused = paused
        self._should_end = should_end
        self._agents = AgentTable()
        self._revision = 0
        self._epoch = 1
        self.on_info: Callable[[SceneInfo], None] = lambda info: None
        self.on_step: Callable[[int], None] = lambda sim_time_ns: None
        self.skipped_frames = 0
        self._world = library.build(scene, seed, self._epoch, self._next_revision)
        self._world.confines = self._confines
        for spec in library.agents_of(self._world.scene):
            self._agents.add(spec, self._world)

    # -- state -----------------------------------------------------------------------------

    @property
    def world(self) -> World:
        """The present world."""
        return self._world

    @property
    def library(self) -> SceneLibrary:
        """Where scenes and assets come from."""
        return self._library

    @property
    def runs_by_itself(self) -> bool:
        """True if simulated time follows the wall clock now."""
        return self._mode == "realtime" and not self._paused

    @property
    def real_time_factor(self) -> float:
        """Simulated seconds per wall second that are aimed at."""
        return self._real_time_factor

    @property
    def info(self) -> SceneInfo:
        """The scene as clients see it; a new object with the present revision."""
        contents = self._world.contents
        return SceneInfo(
            scene=self._world.scene,
            scenes=self._library.scene_names,
            epoch=self._epoch,
            revision=self._revision,
            sim_time_ns=self._world.sim_time_ns,
            mode=self._mode,
            paused=self._paused,
            real_time_factor=self._real_time_factor,
            seed=self._seed,
            categories=contents.categories,
            instances=tuple(drawn.instance for drawn in contents.instances),
            moving=self._world.moving_ids,
            spawnables=self._library.spawnables,
            lights=contents.lights,
            environment=contents.environment,
            agents=self._agents.specs,
            movers=tuple(
                MoverInfo(
                    name=mover.name,
                    controller=mover.controller,
                    waypoints=mover.waypoints,
                    total_time_s=mover.total_time_s,
                    loop=mover.loop,
                )
                for mover in self._world.movers.values()
            ),
            renderer=self._renderer.description,
        )

    # -- scene and time --------------------------------------------------------------------

    def change_scene(self, name: str) -> None:
        """Leave the present world for another scene, at simulated time 0."""
        self._begin(name, self._seed, as_registered=False)

    def reset(self, seed: int | None = None) -> int:
        """Begin the present scene anew, as it was at its start; give the new epoch."""
        chosen = self._seed if seed is None else seed
        if isinstance(chosen, bool) or not isinstance(chosen, int) or not 0 <= chosen < 2**63:
            raise InvalidRequest("seed", seed, "an integer from 0 to 2^63 - 1")
        self._begin(self._world.scene, chosen, as_registered=True, more=self._more)
        return self._epoch

    def pause(self) -> None:
        """Hold simulated time; a second call does nothing."""
        self._set_paused(True)

    def resume(self) -> None:
        """Let simulated time run on; a second call does nothing."""
        self._set_paused(False)

    def set_real_time_factor(self, factor: float) -> None:
        """Change how many simulated seconds per wall second are aimed at, 0.1 to 10."""
        self._real_time_factor = checked_real_time_factor(factor)
        self._announce()

    def step(self, count: int = 1) -> int:
        """Advance by physics steps of 1/240 s, with every streamed frame that falls due.

        Returns
        -------
        sim_time_ns : int
            Simulated time afterwards [ns].
        """
        if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MAX_STEPS:
            raise InvalidRequest("steps", count, f"an integer from 1 to {MAX_STEPS}")
        if self.runs_by_itself:
            accepted = "paused (or in lockstep mode) to be stepped; pause it first"
            raise InvalidRequest("simulation", "running", accepted)
        self.advance_to(self._world.step_count + count, every_frame=True)
        return self._world.sim_time_ns

    def advance_to(self, step: int, *, every_frame: bool) -> None:
        """Run physics up to a step and render what falls due on the way.

        Parameters
        ----------
        every_frame : bool
            False renders, of several frames of one agent that have fallen due, the last alone
            and counts the others as skipped: the wall clock is ahead.
        """
        world = self._world

        def due() -> dict[str, int]:
            return {
                record.spec.name: record.due_step() if every_frame else record.last_due_step(step)
                for record in self._streamed()
            }

        while world.step_count < step and not self._should_end():
            self._render_streams(name for name, at in due().items() if 0 <= at <= world.step_count)
            ahead = {name: at for name, at in due().items() if at > world.step_count}
            goal = min([step, world.step_count + SLICE_STEPS, *ahead.values()])
            world.step(goal - world.step_count)
            self.on_step(world.sim_time_ns)
            self._render_streams(name for name, at in ahead.items() if at == goal)

    def render_due(self) -> None:
        """Render each agent's streamed frame if its time has come; once each."""
        now = self._world.step_count
        self._render_streams(r.spec.name for r in self._streamed() if r.due_step() <= now)

    def next_due_step(self) -> int | None:
        """Give the step of the earliest streamed frame to come; None if nobody wants any."""
        return min((record.due_step() for record in self._streamed()), default=None)

    # -- frames ----------------------------------------------------------------------------

    def capture(self, agent: str, views: Iterable[str] | None = None) -> Frame:
        """Render one frame of an agent now."""
        record = self._agents[agent]
        wanted = record.spec.views if views is None else checked_views(views)
        return self._render(record, wanted)

    def open_stream(
        self, agent: str, views: Sequence[str], on_change: Callable[[FrameStream], None]
    ) -> FrameStream:
        """Begin to deliver an agent's frames at its rate."""
        record = self._agents[agent]
        stream = FrameStream(agent, views, on_change)
        record.streams.append(stream)
        if record.spec.rate_hz:
            record.skip_to(self._world.step_count)
        return stream

    def close(self, why: str = "it was closed") -> None:
        """End all streams; free the engine and the renderer."""
        for record in self._agents:
            for stream in record.streams:
                stream.end(f"the simulation has ended: {why}")
        self._world.close()
        self._renderer.close()

    # -- inside ----------------------------------------------------------------------------

    def _render(self, record: AgentRecord, views: Iterable[str]) -> Frame:
        began = time.perf_counter()
        snapshot = self._world.snapshot()
        camera = self._agents.camera(record, self._world)
        past = record.past(snapshot.sim_time_ns)
        rendered = self._renderer.render(snapshot, past, camera, views)
        record.remember(Observation(snapshot=snapshot, camera=camera, depth=rendered.depth))
        record.sequence += 1
        contents = snapshot.contents
        return Frame(
            agent=record.spec.name,
            scene=contents.scene,
            epoch=contents.epoch,
            revision=contents.revision,
            sequence=record.sequence,
            stamp_ns=snapshot.sim_time_ns,
            dt_ns=0 if past is None else snapshot.sim_time_ns - past.snapshot.sim_time_ns,
            camera=camera,
            views=rendered.views,
            timings_s={**rendered.timings_s, "render": time.perf_counter() - began},
        )

    def _streamed(self) -> list[AgentRecord]:
        """Give the agents whose frames somebody wants now; forgets streams that were closed."""
        wanted = []
        for record in self._agents:
            record.streams[:] = [stream for stream in record.streams if not stream.closed]
            if not record.spec.rate_hz:
                continue
            if record.wanted_views:
                wanted.append(record)
            else:
                record.skip_to(self._world.step_count)
        return wanted

    def _render_streams(self, agents: Iterable[str]) -> None:
        """Render a frame of each agent for its streams, and count those it is too late for."""
        now = self._world.step_count
        for name in agents:
            record = self._agents[name]
            # Another frame of this walk may have taken so long that this stream was closed.
            if record.due_step() > now or not record.wanted_views:
                continue
            frame = self._render(record, record.wanted_views)
            # One of those that are passed over is the frame just made.
            self.skipped_frames += max(0, record.skip_to(now + 1) - 1)
            for stream in record.streams:
                if stream.views:
                    stream.put(frame)

    def _begin(self, scene: str, seed: int, *, as_registered: bool, more: Entries = ()) -> None:
        world = self._library.build(scene, seed, self._epoch + 1, self._next_revision, more=more)
        brought = () if as_registered else self._library.agents_of(world.scene)
        try:
            self._agents.require_room(brought)
        except BaseException:
            world.close()
            raise
        self._world.close()
        world.confines = self._confines
        self._world, self._seed, self._more = world, seed, more
        self._epoch += 1
        self._agents.begin_epoch(world, as_registered=as_registered)
        self._agents.add_missing(brought, world)
        self._discard_frames()
        self._announce()
        self.on_step(world.sim_time_ns)

    def _set_paused(self, paused: bool) -> None:
        if self._mode == "lockstep":
            accepted = "realtime to be paused or resumed; a lockstep simulation moves by step alone"
            raise InvalidRequest("mode", self._mode, accepted)
        if paused != self._paused:
            self._paused = paused
            self._announce()

    def _discard_frames(self) -> None:
        """Drop waiting frames whose ids the next scene_info will not know."""
        for record in self._agents:
            for stream in record.streams:
                stream.discard()

    def _next_revision(self) -> int:
        self._revision += 1
        return self._revision

    def _announce(self) -> None:
        self._next_revision()
        self.on_info(self.info)
