"""A client's line to a simulator: operations as calls of its services, within deadlines.

Finds a running simulator or starts one, and lets go of it on `close`.
"""

from __future__ import annotations

import inspect
import os
import time
from collections.abc import Mapping
from functools import partial

from sailenv_msgs_py.services import Service
from sailenv_ros.ros.client.connection import Connection
from sailenv_ros.ros.client.shared import acquire, release
from sailenv_ros.system.presence import checked_domain, checked_namespace
from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["RemoteSimulator"]


class RemoteSimulator:
    """One user of a simulator; several in one process share a connection.

    Parameters
    ----------
    namespace : str
        The simulator's ROS namespace.
    domain_id : int or None
        ROS domain; None means that of the environment.
    simulator : mapping or None
        Parameters of the simulator node if one has to be started.
    start_timeout_s : float
        Deadline of the simulator's start [s].

    Attributes
    ----------
    revision : int
        Of the scene, as the last operation left it.
    """

    def __init__(
        self,
        *,
        namespace: str,
        domain_id: int | None,
        simulator: Mapping[str, object] | None,
        start_timeout_s: float,
    ) -> None:
        name = checked_namespace(namespace)
        self._acquire = partial(
            acquire, _domain(domain_id), name, dict(simulator or {}), start_timeout_s
        )
        self._link = self._acquire()
        self.revision = 0

    @property
    def connection(self) -> Connection:
        """The connection that is used now."""
        return self._link.connection

    @property
    def process_id(self) -> int | None:
        """Process id of the simulator if it was started here, else None."""
        return None if self._link.process is None else self._link.process.pid

    @property
    def info(self) -> SceneInfo:
        """The scene as it was announced last."""
        return self.connection.info

    def call(self, service: Service, arguments: inspect.BoundArguments, timeout_s: float) -> object:
        """Carry an operation out and return its result.

        What it changed in the scene is announced, so in `info`, when this returns.

        Raises
        ------
        SailenvError
            Of the type and with the sentence that the operation raised in the simulator.
        SimulatorLost, DeadlineExceeded
            If the simulator has ended, or there was no answer in time.
        """
        deadline = time.monotonic() + timeout_s
        agent = arguments.arguments.get("agent")
        name = f"{agent}/{service.name}" if service.of_agent else service.name
        request = service.request(arguments, self.info)
        response = self.connection.call(service.type, name, request, timeout_s)
        result = service.result(response)
        self.revision = response.revision
        self.connection.await_revision(response.revision, max(0.0, deadline - time.monotonic()))
        return result

    def reconnect(self) -> None:
        """Connect again, to a simulator that runs again or is started now."""
        old, self._link = self._link, self._acquire()
        release(old)

    def close(self) -> None:
        """Let go of the connection; the last user of a simulator started here ends it."""
        release(self._link)


def _domain(domain_id: int | None) -> int:
    """Return the ROS domain: the one asked for, else the environment's."""
    asked = os.environ.get("ROS_DOMAIN_ID", "") or "0" if domain_id is None else domain_id
    return checked_domain(asked)
