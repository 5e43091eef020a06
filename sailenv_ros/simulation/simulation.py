"""The simulation as its clients use it: one loop thread, operations as futures, frame streams.

The composition root without ROS; every method here may be called from any thread.
"""

from __future__ import annotations

import atexit
import contextlib
import inspect
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future
from pathlib import Path
from typing import Any, TypeVar

from sailenv_ros.errors import InvalidRequest, SailenvError, SimulationClosed
from sailenv_ros.frame.html import scene_html
from sailenv_ros.render.contract import BackendName
from sailenv_ros.render.selection import make_backend
from sailenv_ros.simulation.clock import Clock
from sailenv_ros.simulation.core import SimulationCore
from sailenv_ros.simulation.first_scene import default_scene
from sailenv_ros.simulation.frame_stream import FrameStream
from sailenv_ros.simulation.listened_simulation import ListenedSimulation
from sailenv_ros.simulation.loop import SimulationLoop
from sailenv_ros.simulation.models.model_workers import ModelWorkers
from sailenv_ros.simulation.models.thumbnails import Thumbnails
from sailenv_ros.simulation.models.upload_queue import UploadQueue
from sailenv_ros.simulation.operations import Operation
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.system.futures import wait_for
from sailenv_ros.types.agents import WAITED_RATE, AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.lessons import LessonState
from sailenv_ros.types.light_choice import LightChoice, checked_light
from sailenv_ros.types.listed_views import Views, listed_views
from sailenv_ros.types.rigs import RigCamera
from sailenv_ros.types.scene_info import TimeMode
from sailenv_ros.types.snapshot import SceneContents
from sailenv_ros.types.views import FIVE_VIEWS, checked_views

__all__ = ["Simulation"]

T = TypeVar("T")


class Simulation(ListenedSimulation):
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
    width, height : int or None
        Size of the frames [px] of an agent to begin with, which is called ``own`` and follows the
        scene's mover: the quick way to say `agent`. None means 640 and 480.
    intrinsics : CameraIntrinsics or None
        Size and lens of that agent instead, such as `load_calibration` reads.
    views : str or iterable of str
        More views of that agent than the usual five.
    cameras : mapping of str to RigCamera, or None
        Cameras on that agent's body besides, which `capture_rig` captures.

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
        width: int | None = None,
        height: int | None = None,
        intrinsics: CameraIntrinsics | None = None,
        views: Views = (),
        cameras: Mapping[str, RigCamera] | None = None,
    ) -> None:
        Clock(mode, real_time_factor, paused=paused)  # refuses what a loop cannot begin with
        checked_light(light)
        agent = _own_agent(agent, width, height, intrinsics, listed_views(views), cameras)
        super().__init__(SimulationLoop())
        loop = self._loop
        self._own_agent = None if agent is None else agent.name
        self.background_task = ""
        self._workers = ModelWorkers(
            uploads=UploadQueue(
                lambda asset, rename: loop.submit(
                    lambda core: core.editor.add_model(asset, rename=rename)
                )
            ),
            thumbnails=Thumbnails(lambda: self._core().library, backend, render_device),
        )

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
                    should_end=lambda: loop.closing,
                )
            except BaseException:
                renderer.close()
                raise

        loop.start(make_core, self._listen)
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
    def own_agent(self) -> str | None:
        """The agent that operations mean if none is named; None is the scene's first."""
        return self._own_agent

    @property
    def supported_views(self) -> tuple[str, ...]:
        """Views that the renderer can make, in the order of `frame.VIEWS`; never blocks."""
        return () if self._loop.core is None else self._loop.core.supported_views

    @property
    def contents(self) -> SceneContents:
        """Contents of the scene apart from poses, the models included; never blocks.

        Raises
        ------
        SimulationClosed
            If the simulation has ended.
        """
        return self._core().world.contents

    @property
    def lesson(self) -> LessonState | None:
        """The current lesson and lap, None if the scene has no lessons; never blocks."""
        return None if self._loop.core is None else self._loop.core.orchestrator.state

    @property
    def skipped_frames(self) -> int:
        """Number of frames that were skipped because the wall clock was ahead; never blocks."""
        return 0 if self._loop.core is None else self._loop.core.streams.skipped_frames

    @property
    def closed(self) -> bool:
        """True once the simulation has ended or is ending."""
        return self._loop.closing

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
        self._loop.process.require()
        if operation.background:
            future: Future[Any] = operation.run(self._workers, *arguments.args, **arguments.kwargs)
            return future
        return self._loop.submit(lambda core: operation.carry_out(core, arguments))

    def frames(
        self, rate_hz: float = 30.0, *, agent: str | None = None, timeout_s: float = 30.0
    ) -> Iterator[dict[str, Any]]:
        """Yield frame after frame at a rate of simulated time, the newest each time.

        A loop slower than the rate misses frames, which shows in their `sequence`. The rate
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
        WAITED_RATE.number("rate_hz", rate_hz)
        name = agent or self.own_agent or next((spec.name for spec in self.info.agents), "")
        with self.stream(name, self._own_views(name)) as stream:
            self.set_rate(rate_hz, agent=name)
            try:
                while True:
                    yield stream.get(timeout_s).to_dict()
            finally:
                with contextlib.suppress(SailenvError):  # it has ended, or the agent is gone
                    self.set_rate(0.0, agent=name)

    # -- streams and life ------------------------------------------------------------------

    def stream(self, agent: str, views: Views, *, timeout_s: float = 30.0) -> FrameStream:
        """Open a newest-wins stream of an agent's frames at its rate; close it after use."""
        wanted = listed_views(views)

        future = self._loop.submit(lambda core: core.open_stream(agent, wanted, self._changed))
        return wait_for(future, f"a stream of agent {agent!r}", timeout_s)

    def read(self, call: Callable[[SimulationCore], T], *, timeout_s: float = 60.0) -> T:
        """Call a function with what is simulated, between two steps; it must change nothing.

        Raises
        ------
        SimulationClosed, DeadlineExceeded
            If the simulation has ended, or gave no result in time.
        """
        return wait_for(self._loop.submit(call), "what a function reads", timeout_s)

    def refresh(self) -> Future[None]:
        """Begin to take up furniture and baked light that were built since the start."""
        return self._loop.submit(lambda core: core.refresh())

    def close(self) -> None:
        """End the simulation: interrupt what runs, free everything; a second call does nothing.

        In a fork it does nothing either: it is the parent's.
        """
        if self._loop.process.is_inherited:
            return
        self._loop.closing = True
        self._workers.close()
        atexit.unregister(self.close)
        self._loop.close()

    def _repr_html_(self) -> str:
        """Return a table of what is simulated, for notebooks."""
        return scene_html(type(self).__name__, self.info)

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    def _core(self) -> SimulationCore:
        if self._loop.core is None:
            raise SimulationClosed(self._loop.ended or "it has not begun")
        return self._loop.core

    def _changed(self, stream: FrameStream) -> None:
        self._loop.nudge()


def _own_agent(
    agent: AgentSpec | None,
    width: int | None,
    height: int | None,
    intrinsics: CameraIntrinsics | None,
    views: tuple[str, ...],
    cameras: Mapping[str, RigCamera] | None,
) -> AgentSpec | None:
    """Return the agent to begin with, if there is to be one: as it is given, or by its size."""
    sizes: dict[str, Any] = {
        k: v for k, v in (("width", width), ("height", height)) if v is not None
    }
    if not sizes and intrinsics is None and not views and cameras is None:
        return agent
    if agent is not None:
        accepted = (
            "left out where width, height, intrinsics, views or cameras are given: they describe "
            "an agent"
        )
        raise InvalidRequest("agent", agent.name, accepted)
    if intrinsics is not None and sizes:
        raise InvalidRequest("width and height", sizes, "left out where intrinsics are given")
    return AgentSpec(
        name="own",
        intrinsics=CameraIntrinsics(**sizes) if intrinsics is None else intrinsics,
        rate_hz=0.0,
        views=checked_views((*FIVE_VIEWS, *views)),
        cameras=cameras,
    )
