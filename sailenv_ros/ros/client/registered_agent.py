"""An agent in a simulator that runs as a node: registered, asked for operations, removed.

Raises typed errors and never prints; every wait has a deadline.
"""

from __future__ import annotations

import atexit
import inspect
import threading
from collections.abc import Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace
from typing import Any, TypeVar
from weakref import WeakSet

from sailenv_msgs_py.services import SERVICES
from sailenv_ros.errors import InvalidRequest, NameTaken, SailenvError, SimulationClosed
from sailenv_ros.frame.html import scene_html
from sailenv_ros.ros.client.frame_client import FrameClient
from sailenv_ros.ros.client.remote import RemoteSimulator
from sailenv_ros.ros.client.rig_client import RigClient
from sailenv_ros.simulation.operations import Operation, Operations
from sailenv_ros.system.client_locks import AgentName, unique_agent_name
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["RegisteredAgent"]

ORDINARY_S = 30.0
"""An operation whose own deadline is longer takes long by nature [s]."""

END_S = 2.0
"""Time that the simulator may take to notice the end of an Agent [s]."""

A = TypeVar("A", bound="RegisteredAgent")

_open: WeakSet[RegisteredAgent] = WeakSet()


@atexit.register
def _close_all() -> None:
    for agent in tuple(_open):
        agent.close()


class RegisteredAgent(Operations):
    """An agent that exists in the simulator as long as this does; a context manager.

    One that nobody refers to any more, as that of a notebook's cell that ran again, is closed.

    Parameters
    ----------
    spec : AgentSpec
    any_name : bool
        True gives it a name that comes again, as nobody asked for one.
    timeout_s, namespace, domain_id, simulator, start_timeout_s
        As of `Agent`.
    """

    def __init__(
        self,
        spec: AgentSpec,
        *,
        any_name: bool,
        timeout_s: float,
        namespace: str,
        domain_id: int | None,
        simulator: Mapping[str, object] | None,
        start_timeout_s: float,
    ) -> None:
        self._spec = spec
        self._lent: AgentName | None = None
        self._timeout_s = timeout_s
        self._lock = threading.RLock()
        self._frames: FrameClient | None = None
        self._rig: RigClient | None = None
        self._worker: ThreadPoolExecutor | None = None
        self._recaptured = 0
        self._remote = RemoteSimulator(
            namespace=namespace,
            domain_id=domain_id,
            simulator=simulator,
            start_timeout_s=start_timeout_s,
        )
        self._closed = False
        _open.add(self)
        try:
            if any_name:
                self._lent = AgentName()
                self._spec = replace(spec, name=self._lent.text)
            self.register()
        except BaseException:
            self.close()
            raise

    # -- life ------------------------------------------------------------------------------

    @property
    def id(self) -> str:
        """Name of this agent in the simulator, and of its topics."""
        return self._spec.name

    @property
    def own_agent(self) -> str:
        """Name of this agent: the one that operations mean if none is named."""
        return self._spec.name

    @property
    def simulator_pid(self) -> int | None:
        """Process id of the simulator if it was started here, else None."""
        return self._remote.process_id

    def register(self) -> None:
        """Make the agent known to the simulator; done on construction, needed after `delete`."""
        with self._lock:
            if self._frames is not None:
                return
            try:
                self._frames, self._rig = self._registered()
            except NameTaken:
                if self._lent is None:
                    raise
                # Of an Agent that could not remove it, or of a host that is not told apart.
                self._spec = replace(self._spec, name=unique_agent_name())
                self._frames, self._rig = self._registered()

    def delete(self) -> None:
        """Remove the agent from the simulator; a second call does nothing."""
        with self._lock:
            if self._frames is None:
                return
            frames, rig, self._recaptured = self._frames, self._rig, self.recaptured
            self._frames = self._rig = None
            try:
                # Before its subscriptions: an agent whose client is gone is removed as it is.
                self.delete_agent(self.id)
            finally:
                frames.close()
                if rig is not None:
                    rig.close()
                for name in (self.id, *(() if rig is None else rig.cameras)):
                    self._remote.connection.forget_services(name)

    def rejoin(self) -> None:
        """Connect again after `SimulatorLost`, to a simulator that runs again or is started now.

        The agent is registered as it was at first, so its pose and its frames' numbers begin again.
        """
        self._remote.connection.process.require()
        with self._lock:
            if self._closed:
                raise SimulationClosed("the Agent was closed")
            # Where the old simulator lives after all, it shall not keep the name.
            with suppress(SailenvError):
                self.delete()
            self._remote.reconnect()
            self.register()

    def close(self) -> None:
        """Remove the agent and disconnect; a second call does nothing.

        A simulator that was started for this agent ends with the last one that uses it.
        """
        if self._remote.connection.process.is_inherited:
            return  # it is the parent's, who goes on with it
        with self._lock:
            if self._closed:
                return
            self._closed = True
            _open.discard(self)
            self._timeout_s = min(self._timeout_s, END_S)
            if self._worker is not None:
                self._worker.shutdown(wait=False, cancel_futures=True)
            try:
                self.delete()
            except SailenvError:
                pass  # the simulator is gone, and with it the agent
            finally:
                self._remote.close()
                if self._lent is not None:
                    self._lent.release()

    def __del__(self) -> None:
        """Give the place in the simulator back where nobody can use it any more."""
        if not getattr(self, "_closed", True):
            # Not here: this may run in any thread, also in the one that receives the answers.
            with suppress(RuntimeError):  # the interpreter ends, and has closed it
                threading.Thread(target=self.close, name=f"{self.id}-end", daemon=True).start()

    def _repr_html_(self) -> str:
        """Return a table of what is simulated, for notebooks."""
        return scene_html(f"Agent {self.id}", self.info)

    def __enter__(self: A) -> A:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    # -- operations ------------------------------------------------------------------------

    @property
    def info(self) -> SceneInfo:
        """The scene as the simulator announced it last; never blocks."""
        return self._remote.info

    def submit_operation(
        self, operation: Operation[..., Any], arguments: inspect.BoundArguments
    ) -> Future[Any]:
        """Begin an operation in a thread of its own; one is done after the other."""
        self._remote.connection.process.require()
        with self._lock:
            if self._closed:
                raise SimulationClosed("the Agent was closed")
            if self._worker is None:
                self._worker = ThreadPoolExecutor(1, thread_name_prefix=f"{self.id}-operations")
            return self._worker.submit(self.call_operation, operation, arguments, None)

    def call_operation(
        self,
        operation: Operation[..., Any],
        arguments: inspect.BoundArguments,
        timeout_s: float | None,
    ) -> Any:
        """Carry an operation out in the simulator and return its result."""
        self._remote.connection.process.require()
        limit_s = self._deadline_s(operation) if timeout_s is None else timeout_s
        service = SERVICES[operation.name]
        agent, views = (arguments.arguments.get(name) for name in ("agent", "views"))
        if service.of_agent and agent == self.id:
            _ = self._own_frames  # which must be there
        if operation is Operations.capture:
            frames = self._frames_of(agent)
            with self._lock:
                return frames.capture(views, limit_s)
        if operation is Operations.capture_rig and agent == self.id and self._rig is not None:
            with self._lock:
                return self._rig.capture(views, limit_s)
        if operation is Operations.capture_rig:
            accepted = f"{self.id!r}, made with cameras: an Agent receives its own frames alone"
            raise InvalidRequest("agent", agent, accepted)
        return self._remote.call(service, arguments, limit_s)

    @property
    def picture(self) -> PictureSettings:
        """The present picture settings, asked from the simulator."""
        return self.get_picture()

    @property
    def recaptured(self) -> int:
        """Number of frames requested again because images did not arrive."""
        own = 0 if self._frames is None else self._frames.recaptured
        return self._recaptured + own + (0 if self._rig is None else self._rig.recaptured)

    # -- inside ----------------------------------------------------------------------------

    def _registered(self) -> tuple[FrameClient, RigClient | None]:
        """Register it; return what receives its frames."""
        cameras = self._spec.cameras
        frames = FrameClient(self._remote, self._spec)
        rig = None if cameras is None else RigClient(self._remote, self._spec)
        try:
            self._spec = replace(self.register_agent(self._spec), cameras=cameras)
            frames.begin(self._spec, self._timeout_s)
            if rig is not None:
                rig.begin(self._timeout_s)
        except BaseException:
            frames.close()
            if rig is not None:
                rig.close()
            raise
        return frames, rig

    @property
    def _own_frames(self) -> FrameClient:
        if self._frames is None:
            raise SimulationClosed(f"agent {self.id!r} was deleted; register it first")
        return self._frames

    def _frames_of(self, agent: object) -> FrameClient:
        """Return the frames of this agent or of a camera of its rig.

        Raises
        ------
        InvalidRequest
            If it is another's.
        """
        cameras = {} if self._rig is None else self._rig.cameras
        if agent == self.id:
            return self._own_frames
        if isinstance(agent, str) and agent in cameras:
            return cameras[agent]
        accepted = f"{self.id!r}: an Agent receives its own frames alone"
        raise InvalidRequest("agent", agent, accepted)

    def _deadline_s(self, operation: Operation[..., Any]) -> float:
        takes_long = operation.deadline_s > ORDINARY_S
        return max(self._timeout_s, operation.deadline_s) if takes_long else self._timeout_s
