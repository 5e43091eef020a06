"""One private ROS context and its thread: requests with deadlines, the scene as it is now.

All Agents of a process that talk to one simulator share a connection, so that they share its
memory and its discovery. It lives beside whatever the user does with rclpy.
"""

from __future__ import annotations

import contextlib
import math
import os
import threading
import time
import uuid
from collections.abc import Callable
from typing import Any

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

from sailenv_msgs.msg import SceneInfo as SceneInfoMsg
from sailenv_msgs.srv import RegisterAgent
from sailenv_msgs_py.scene_msgs import scene_info_from_msg
from sailenv_msgs_py.services.message_fields import refuse_nul
from sailenv_ros.errors import (
    DeadlineExceeded,
    InvalidRequest,
    SimulationClosed,
    SimulatorLost,
)
from sailenv_ros.ros.client.scene_history import DEPTH, SceneHistory
from sailenv_ros.ros.executor_thread import ExecutorThread
from sailenv_ros.system.client_locks import ClientLock
from sailenv_ros.system.inherited_dds import renew_inherited_dds
from sailenv_ros.system.own_process import OwnProcess
from sailenv_ros.system.presence import present_simulator
from sailenv_ros.system.transport import use_shared_memory_profile
from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["Connection"]

LOOK_INTERVAL_S = 0.1
"""Interval at which a wait checks whether the simulator still lives [s]."""

STOPPED_S = 1.0
"""A look that takes so much longer than it should tells that this process was stopped [s]."""

POLL_INTERVAL_S = 0.005
"""Interval at which conditions of the ROS graph without a change notice are polled [s]."""

_LATCHED = QoSProfile(depth=DEPTH, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Connection:
    """A client's node in a context of its own.

    Parameters
    ----------
    domain_id : int
    namespace : str
        The simulator's, e.g. ``"/sailenv"``.

    Attributes
    ----------
    process : OwnProcess
        Where its thread is.
    """

    def __init__(self, domain_id: int, namespace: str) -> None:
        self.domain_id = domain_id
        self.namespace = namespace
        self.process = OwnProcess("Agent")
        self._scenes = SceneHistory()
        self._changed = threading.Condition()
        self._closed = False
        self._clients: dict[str, Any] = {}
        self._is_alive: Callable[[], bool] = lambda: True
        use_shared_memory_profile()
        # By these the simulator knows whether we live; see `nodes/agent_leases.py`.
        name = f"client_{os.getpid()}_{uuid.uuid4().hex[:6]}"
        self._lock = ClientLock(name)
        renew_inherited_dds()
        self._context = Context()
        # No arguments: those on this process's command line are not for us.
        rclpy.init(args=[], context=self._context, domain_id=domain_id)
        self.node = Node(
            name,
            context=self._context,
            namespace=namespace,
            use_global_arguments=False,
            enable_rosout=False,
            start_parameter_services=False,
        )
        self.node.create_subscription(SceneInfoMsg, "scene_info", self._take_info, _LATCHED)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._spinning = ExecutorThread(self._executor, "sailenv-client")
        self._spinning.start()

    # -- the simulator ---------------------------------------------------------------------

    def watch(self, is_alive: Callable[[], bool]) -> None:
        """Have every wait fail once the simulator has ended."""
        self._is_alive = is_alive

    def simulator_lives(self) -> bool:
        """Return whether nothing is known of the simulator's end."""
        return self._is_alive()

    def simulator_answers(self) -> bool:
        """Return whether there is a simulator that takes requests now."""
        return bool(self._client(RegisterAgent, "register_agent").service_is_ready())

    def simulator_here(self) -> int | None:
        """Return the process id of the simulator of this name on this host, if there is one."""
        return present_simulator(self.domain_id, self.namespace)

    # -- requests --------------------------------------------------------------------------

    def call(
        self,
        srv_type: Any,
        service: str,
        request: Any,
        timeout_s: float,
        resend_s: float = math.inf,
    ) -> Any:
        """Ask a service of the simulator.

        Discovery can lose a request or its response without a word: the request goes to the
        service's predecessor of the same name, which has just ended, or the server waits in vain
        (100 ms in rmw_fastrtps) for the client's reader to be known.

        Parameters
        ----------
        srv_type : type
        service : str
            Its name within the namespace.
        request : message
        timeout_s : float
            Deadline for everything [s].
        resend_s : float
            Send the request again when there was no answer for so long [s], then for twice as
            long, and so on; for requests that do no harm when they are carried out twice. The
            first answer to any of them is taken.

        Returns
        -------
        response : message
            Be it a success or a refusal.

        Raises
        ------
        InvalidRequest
            If a field of the request cannot be sent at all.
        SimulatorLost
            If the simulator has ended.
        DeadlineExceeded
            If there was no answer in time.
        """
        self.process.require()
        refuse_nul(service, request)
        deadline = time.monotonic() + timeout_s
        client = self._client(srv_type, service)
        what = f"the service {self.namespace}/{service}"
        self.wait_until(client.service_is_ready, what, timeout_s)
        answered = threading.Event()
        futures: list[Any] = []
        due = -math.inf

        def met(interval_s: float) -> bool:
            nonlocal due
            if time.monotonic() >= due:
                due = time.monotonic() + resend_s * 2 ** len(futures)
                futures.append(self._sent(client, service, request))
                futures[-1].add_done_callback(lambda _: answered.set())
            return answered.wait(interval_s)

        try:
            self._wait(met, f"an answer of {what}", deadline, timeout_s)
        finally:
            for future in futures:
                if not future.done():
                    client.remove_pending_request(future)
        return next(future.result() for future in futures if future.done())

    def _sent(self, client: Any, service: str, request: Any) -> Any:
        """Send a request and return the future of its answer."""
        try:
            return client.call_async(request)
        except (SystemError, TypeError, OverflowError, UnicodeError) as error:
            # The messages' C code tells a wrong type or size in these ways.
            accepted = "of numbers and texts that the service's fields can hold"
            raise InvalidRequest(f"request to {service}", request, accepted) from error

    def forget_services(self, prefix: str) -> None:
        """Free the clients of the services below that name."""
        for service in [name for name in self._clients if name.startswith(f"{prefix}/")]:
            self.node.destroy_client(self._clients.pop(service))

    # -- waiting ---------------------------------------------------------------------------

    @property
    def info(self) -> SceneInfo:
        """The scene as it was announced last."""
        if self._scenes.latest is None:
            raise SimulationClosed("no simulator has announced its scene yet")
        return self._scenes.latest

    def await_info(
        self, condition: Callable[[SceneInfo], bool], what: str, timeout_s: float
    ) -> SceneInfo:
        """Wait until the announced scene is as it should be."""
        found: list[SceneInfo] = []

        def met(interval_s: float) -> bool:
            with self._changed:
                info = self._scenes.latest
                if info is None or not condition(info):
                    self._changed.wait(interval_s)
                info = self._scenes.latest
                if info is not None and condition(info):
                    found.append(info)
            return bool(found)

        self._wait(met, what, time.monotonic() + timeout_s, timeout_s)
        return found[0]

    def await_revision(self, revision: int, timeout_s: float) -> SceneInfo | None:
        """Wait until the scene_info of a revision, or a later one, has arrived.

        Returns
        -------
        info : SceneInfo or None
            The one of exactly that revision; None if it was lost, or is too old to be kept.

        Raises
        ------
        SimulatorLost, DeadlineExceeded
            If the simulator ended meanwhile, or it did not come in time.
        """
        what = f"scene_info of revision {revision}"
        self.await_info(lambda info: info.revision >= revision, what, timeout_s)
        with self._changed:
            return self._scenes.of_revision(revision)

    def wait_until(self, condition: Callable[[], bool], what: str, timeout_s: float) -> None:
        """Wait for a condition of the ROS graph.

        Raises
        ------
        SimulatorLost, DeadlineExceeded
            If the simulator ended meanwhile, or the condition was not met in time.
        """
        never = threading.Event()

        def met(interval_s: float) -> bool:
            return condition() or never.wait(min(interval_s, POLL_INTERVAL_S)) or condition()

        self._wait(met, what, time.monotonic() + timeout_s, timeout_s)

    def wait_for(self, met: Callable[[float], bool], what: str, timeout_s: float) -> None:
        """Wait with a function that waits up to so many seconds and says whether it was enough."""
        self._wait(met, what, time.monotonic() + timeout_s, timeout_s)

    def _wait(
        self, met: Callable[[float], bool], what: str, deadline: float, timeout_s: float
    ) -> None:
        began = time.monotonic()
        looked = time.monotonic()
        while not met(max(0.0, min(LOOK_INTERVAL_S, deadline - time.monotonic()))):
            now = time.monotonic()
            if now - looked > LOOK_INTERVAL_S + STOPPED_S:
                # This process stood still (a debugger, Ctrl-Z, sleep): it has not waited so long.
                deadline += now - looked
            looked = now
            if self._closed:
                raise SimulationClosed("the Agent was closed")
            # What came in before the simulator ended is still taken.
            if not self._is_alive() and not met(0.0):
                raise SimulatorLost(what, time.monotonic() - began)
            if time.monotonic() >= deadline:
                raise DeadlineExceeded(what, timeout_s)

    # -- inside ----------------------------------------------------------------------------

    def _client(self, srv_type: Any, service: str) -> Any:
        if self._closed:
            raise SimulationClosed("the Agent was closed")
        if service not in self._clients:
            # rclpy's groups refer to all that they ever had, and the node's own one stays.
            group = MutuallyExclusiveCallbackGroup()
            self._clients[service] = self.node.create_client(
                srv_type, service, callback_group=group
            )
        return self._clients[service]

    def _take_info(self, msg: SceneInfoMsg) -> None:
        info = scene_info_from_msg(msg)
        with self._changed:
            self._scenes.add(info)
            self._changed.notify_all()

    def close(self) -> None:
        """End the thread and free the context; a second call does nothing."""
        if self._closed:
            return
        self._closed = True
        with self._changed:
            self._changed.notify_all()
        self._spinning.stop(5.0)
        self._executor.shutdown(0)
        self.node.destroy_node()
        with contextlib.suppress(RuntimeError):  # the interpreter's end may have come before
            self._context.try_shutdown()
        self._lock.release()
