"""The simulation as its clients use it: one loop thread, operations as futures, frame streams.

The composition root without ROS. One thread owns PyBullet and the GL context; every method here
may be called from any thread. Operations are carried out between physics steps, in the order they
came.
"""

from __future__ import annotations

import atexit
import collections
import contextlib
import inspect
import logging
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future
from pathlib import Path
from typing import Any, TypeVar

from sailenv_ros.agents import AgentSpec, check_frame_rate
from sailenv_ros.backends.selection import make_backend
from sailenv_ros.catalogue.thumbnails import Thumbnails
from sailenv_ros.catalogue.upload_queue import UploadQueue
from sailenv_ros.contacts import Contact
from sailenv_ros.errors import DeadlineExceeded, InvalidState, SailenvError, SimulationClosed
from sailenv_ros.joints import JointState
from sailenv_ros.lessons import LessonState
from sailenv_ros.notebook import scene_html
from sailenv_ros.operations import Operation, Operations
from sailenv_ros.render.backend import BackendName
from sailenv_ros.scene_info import SceneInfo, TimeMode
from sailenv_ros.simulation.clock import Clock
from sailenv_ros.simulation.core import SimulationCore
from sailenv_ros.simulation.frame_stream import FrameStream
from sailenv_ros.simulation.light_cache import LightChoice
from sailenv_ros.simulation.model_workers import ModelWorkers
from sailenv_ros.simulation.pacing import Pacer
from sailenv_ros.simulation.scenes import SceneLibrary, default_scene
from sailenv_ros.snapshot import SceneContents
from sailenv_ros.space import FreeSpace
from sailenv_ros.system.futures import wait_for
from sailenv_ros.world.world import World

__all__ = ["Simulation"]

_log = logging.getLogger(__name__)

TICK_STEPS = 2
"""Steps between two looks at the clock while no frame is due (120 per simulated second)."""

_DRAW_TIMEOUT_S = 60.0
_CLOSE_TIMEOUT_S = 10.0
_START_TIMEOUT_S = 120.0

T = TypeVar("T")


class Simulation(Operations):
    """A running simulation; a context manager.

    Parameters
    ----------
    scene : str, Path or None
        Name of a scene, or a scene file; None takes ``room_01``, or ``optical`` where the
        furniture has not been built.
    mode : {'realtime', 'lockstep'}
        ``realtime``: simulated time follows the wall clock times a factor. ``lockstep``: nothing
        moves until `step`; the same seed and calls give the same bytes.
    real_time_factor : float
        Simulated seconds per wall second, 0.1 to 10.
    seed : int
        Of every random number of the scene.
    paused : bool
        Start without moving (realtime mode).
    backend : {'auto', 'native', 'gl'}
        Renderer: OpenGL, the native one, or OpenGL on graphics hardware and else the native one.
    render_device : int or None
        Number of the EGL device; None takes the first that works.
    scene_paths : sequence of Path
        More folders with scenes.
    allow_modules : bool
        True lets scene files have behaviours of Python modules, whose code then runs here.
    light : {'newest', 'baked', 'plain'}
        Of rooms. ``newest``: what is baked by now, if anything is; in realtime mode a draft too,
        while it is being baked. ``baked``: the finished light, or it does not start. ``plain``:
        without bounced light, whatever is baked. With the last two what is seen does not depend
        on what else happened on the machine.
    agent : AgentSpec or None
        An agent to begin with, and the one that operations mean if none is named; None means the
        scene's first.

    Raises
    ------
    SceneError, UnknownName, InvalidRequest, InvalidState, ContextError
        If it cannot start; nothing is left running then.

    Attributes
    ----------
    background_task : str
        What is built beside it now and how far that is, in words; empty for nothing.
    """

    def __init__(
        self,
        scene: str | Path | None = None,
        *,
        mode: TimeMode = "realtime",
        real_time_factor: float = 1.0,
        seed: int = 0,
        paused: bool = False,
        backend: BackendName = "auto",
        render_device: int | None = None,
        scene_paths: Sequence[Path] = (),
        allow_modules: bool = False,
        light: LightChoice = "newest",
        agent: AgentSpec | None = None,
    ) -> None:
        Clock(mode, real_time_factor, paused=paused)  # refuses what a loop cannot begin with
        self._wake = threading.Condition()
        self._queue: collections.deque[tuple[Future[Any], Callable[[SimulationCore], Any]]] = (
            collections.deque()
        )
        self._core: SimulationCore | None = None
        self._closing = False
        self._ended = ""
        self._own_agent = None if agent is None else agent.name
        self._info: SceneInfo | None = None
        self._sim_time_ns = 0
        self._info_listeners: list[Callable[[SceneInfo], None]] = []
        self._step_listeners: list[Callable[[int], None]] = []
        self._map_listeners: list[Callable[[FreeSpace], None]] = []
        self.background_task = ""
        self._pacer = Pacer(real_time_factor)
        self._workers = ModelWorkers(
            uploads=UploadQueue(
                lambda asset, rename: self._submit(
                    lambda core: core.editor.add_model(asset, rename=rename)
                )
            ),
            thumbnails=Thumbnails(self._library, backend, render_device),
        )
        started: Future[None] = Future()

        def make_core() -> SimulationCore:
            renderer = make_backend(backend, render_device)
            try:
                return SimulationCore(
                    SceneLibrary(
                        scene_paths,
                        allow_modules=allow_modules,
                        baked_light=light != "plain",
                        # How far a bake is by now must not show where time is stepped.
                        drafts=light == "newest" and mode == "realtime",
                        require_light=light == "baked",
                    ),
                    default_scene() if scene is None else scene,
                    renderer,
                    mode=mode,
                    real_time_factor=real_time_factor,
                    seed=seed,
                    paused=paused,
                    should_end=lambda: self._closing,
                )
            except BaseException:
                renderer.close()
                raise

        self._thread = threading.Thread(
            target=self._run, args=(make_core, started), name="sailenv-simulation", daemon=True
        )
        self._thread.start()
        wait_for(started, "the simulation to start", _START_TIMEOUT_S)
        # The loop thread is a daemon; GL objects and the engine want an orderly end all the same.
        atexit.register(self.close)
        if agent is not None:
            try:
                self.register_agent(agent)
            except BaseException:
                self.close()
                raise

    # -- reading ---------------------------------------------------------------------------

    @property
    def info(self) -> SceneInfo:
        """The scene as it was announced last; never blocks."""
        assert self._info is not None
        return self._info

    @property
    def own_agent(self) -> str | None:
        """The agent that operations mean if none is named; None is the scene's first."""
        return self._own_agent

    @property
    def sim_time_ns(self) -> int:
        """Simulated time as of the last step [ns]; never blocks."""
        return self._sim_time_ns

    @property
    def supported_views(self) -> tuple[str, ...]:
        """Views that the renderer can make, in the order of `frame.VIEWS`; never blocks."""
        return () if self._core is None else self._core.supported_views

    @property
    def contents(self) -> SceneContents:
        """What the scene holds now apart from poses, the models too; never blocks.

        Raises
        ------
        SimulationClosed
            If the simulation has ended.
        """
        if self._core is None:
            raise SimulationClosed("the simulation has ended")
        return self._core.world.contents

    @property
    def lesson(self) -> LessonState | None:
        """Which lesson of which lap it is now, None if the scene has none; never blocks."""
        return None if self._core is None else self._core.orchestrator.state

    @property
    def skipped_frames(self) -> int:
        """How many frames were never rendered because the wall clock was ahead; never blocks."""
        return 0 if self._core is None else self._core.skipped_frames

    @property
    def closed(self) -> bool:
        """True once the simulation has ended or is ending."""
        return self._closing

    # -- operations ------------------------------------------------------------------------

    def submit_operation(
        self, operation: Operation[..., Any], arguments: inspect.BoundArguments
    ) -> Future[Any]:
        """Queue an operation for the loop; see `Operations` for all of them.

        Raises
        ------
        SimulationClosed
            If the simulation has ended.
        """
        args, kwargs = arguments.args, arguments.kwargs
        if operation.background:
            future: Future[Any] = operation.run(self._workers, *args, **kwargs)
            return future
        return self._submit(lambda core: operation.run(core, *args, **kwargs))

    def frames(
        self, rate_hz: float = 30.0, *, agent: str | None = None, timeout_s: float = 30.0
    ) -> Iterator[dict[str, Any]]:
        """Yield frame after frame at a rate of simulated time, the newest each time.

        Whoever is slower than the rate misses frames, which shows in their `sequence`. The rate
        ends with the iteration.

        Parameters
        ----------
        rate_hz : float
            Frames per simulated second, above 0 and up to 240.
        agent : str or None
            None means the first.
        timeout_s : float
            Deadline of each frame [s].

        Yields
        ------
        frame : dict
            As of `get_frame`.

        Raises
        ------
        SimulationClosed, DeadlineExceeded
            If no frame came in time.
        """
        check_frame_rate(rate_hz)
        name = agent or self.own_agent or next((spec.name for spec in self.info.agents), "")
        with self.stream(name, self._own_views(name)) as stream:
            self.set_rate(rate_hz, agent=name)
            try:
                while True:
                    yield stream.get(timeout_s).to_dict()
            finally:
                with contextlib.suppress(SailenvError):  # it has ended, or the agent is gone
                    self.set_rate(0.0, agent=name)

    # -- streams and listeners -------------------------------------------------------------

    def stream(self, agent: str, views: Iterable[str], *, timeout_s: float = 30.0) -> FrameStream:
        """Open a newest-wins stream of an agent's frames at its rate; close it after use."""
        wanted = tuple(views)

        def changed(_: FrameStream) -> None:
            self._nudge()

        future = self._submit(lambda core: core.open_stream(agent, wanted, changed))
        return wait_for(future, f"a stream of agent {agent!r}", timeout_s)

    def on_info(self, listener: Callable[[SceneInfo], None]) -> Callable[[], None]:
        """Have a quick function called, now and at every change; gives the one that ends it.

        Changes are told from the loop thread, before any frame that depends on them.
        """
        self._info_listeners.append(listener)
        listener(self.info)
        return lambda: _discard(self._info_listeners, listener)

    def on_step(self, listener: Callable[[int], None]) -> Callable[[], None]:
        """Have a quick function called with the simulated time [ns] after physics advanced."""
        self._step_listeners.append(listener)
        return lambda: _discard(self._step_listeners, listener)

    def on_free_space(self, listener: Callable[[FreeSpace], None]) -> Callable[[], None]:
        """Have a quick function called with each map that `free_space` makes."""
        self._map_listeners.append(listener)
        return lambda: _discard(self._map_listeners, listener)

    def contacts_of_steps(self, seconds: float) -> tuple[Contact, ...]:
        """Return what touched what in the last time [s]; for listeners of `on_step` alone.

        Raises
        ------
        InvalidState
            If it is called from another thread than theirs, which has the operation `contacts`.
        """
        if self._core is None or threading.current_thread() is not self._thread:
            raise InvalidState("this is for listeners of on_step; others call contacts(seconds)")
        return self._core.world.contacts(seconds)

    def joints_now(self) -> tuple[JointState, ...]:
        """Return the states of all joints; for listeners of `on_step` alone.

        Raises
        ------
        InvalidState
            If it is called from another thread than theirs, which has the operation `get_joints`.
        """
        if self._core is None or threading.current_thread() is not self._thread:
            raise InvalidState("this is for listeners of on_step; others call get_joints()")
        return self._core.world.joints()

    def refresh(self) -> Future[None]:
        """Begin to take up furniture and baked light that were built since the start."""
        return self._submit(lambda core: core.refresh())

    def close(self) -> None:
        """End the simulation: break off what runs, free everything; a second call does nothing."""
        self._closing = True
        self._workers.close()
        self._nudge()
        atexit.unregister(self.close)
        if threading.current_thread() is not self._thread:
            self._thread.join(_CLOSE_TIMEOUT_S)
            if self._thread.is_alive():
                raise DeadlineExceeded("the simulation's thread to end", _CLOSE_TIMEOUT_S)

    def _repr_html_(self) -> str:
        """Return a table of what is simulated, for notebooks."""
        return scene_html(type(self).__name__, self.info)

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    # -- the loop --------------------------------------------------------------------------

    def _run(self, make_core: Callable[[], SimulationCore], started: Future[None]) -> None:
        try:
            core = make_core()
        except BaseException as error:
            self._closing = True
            self._ended = str(error)
            started.set_exception(error)
            return
        self._core = core
        core.on_info, core.on_step = self._take_info, self._take_step
        core.on_free_space = self._take_map
        core.run_later = self._run_in_loop
        self._take_info(core.info)
        why = "it was closed"
        self._pacer.restart(core.world.step_count)
        started.set_result(None)
        try:
            while not self._closing:
                self._serve(core)
                self._advance(core)
                self._rest(core)
        except Exception as error:
            why = f"{type(error).__name__}: {error}"
            _log.exception("the simulation ends because of an internal error")
        finally:
            self._end(core, why)

    def _serve(self, core: SimulationCore) -> None:
        """Execute the requests that are queued now."""
        while self._queue and not self._closing:
            future, call = self._queue.popleft()
            if not future.set_running_or_notify_cancel():
                continue
            before = _pace(core)
            try:
                result = call(core)
            except Exception as error:
                future.set_exception(error)
            else:
                future.set_result(result)
            if _pace(core) != before:
                self._pacer.restart(core.world.step_count, factor=core.clock.real_time_factor)

    def _advance(self, core: SimulationCore) -> None:
        if core.clock.runs_by_itself:
            target = self._pacer.target(core.world.step_count)
            if target > core.world.step_count:
                core.advance_to(target, every_frame=False)
        else:
            core.render_due()

    def _rest(self, core: SimulationCore) -> None:
        """Wait until there is something to do."""
        with self._wake:
            if self._queue or self._closing:
                return
            if not core.clock.runs_by_itself:
                self._wake.wait()
                return
            due = core.next_due_step()
            goal = core.world.step_count + TICK_STEPS
            self._wake.wait(self._pacer.wait_s(goal if due is None else min(goal, due)))

    def _end(self, core: SimulationCore, why: str) -> None:
        with self._wake:
            self._closing = True
            self._ended = why
            waiting = list(self._queue)
            self._queue.clear()
        for future, _ in waiting:
            if future.set_running_or_notify_cancel():
                future.set_exception(SimulationClosed(why))
        core.close(why)

    def _take_info(self, info: SceneInfo) -> None:
        self._info = info
        for listener in tuple(self._info_listeners):
            listener(info)

    def _take_step(self, sim_time_ns: int) -> None:
        self._sim_time_ns = sim_time_ns
        for listener in tuple(self._step_listeners):
            listener(sim_time_ns)

    def _take_map(self, space: FreeSpace) -> None:
        for listener in tuple(self._map_listeners):
            listener(space)

    def _submit(self, call: Callable[[SimulationCore], T]) -> Future[T]:
        future: Future[T] = Future()
        with self._wake:
            if self._closing:
                raise SimulationClosed(self._ended or "it was closed")
            self._queue.append((future, call))
            self._wake.notify_all()
        return future

    def _run_in_loop(self, call: Callable[[], T]) -> T:
        """Run a function in the loop's thread and return its result."""
        if threading.current_thread() is self._thread:
            return call()
        future = self._submit(lambda core: call())
        return wait_for(future, "objects to be drawn alone", _DRAW_TIMEOUT_S)

    def _library(self) -> SceneLibrary:
        if self._core is None:
            raise SimulationClosed(self._ended or "it has not begun")
        return self._core.library

    def _nudge(self) -> None:
        with self._wake:
            self._wake.notify_all()


def _pace(core: SimulationCore) -> tuple[World, bool, float]:
    """Return what time's pace depends on: when it changes, the clock begins anew."""
    return core.world, core.clock.runs_by_itself, core.clock.real_time_factor


def _discard(listeners: list[Any], listener: Any) -> None:
    if listener in listeners:
        listeners.remove(listener)
