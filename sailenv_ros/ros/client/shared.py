"""Connections that the Agents of a process share, and the simulator that they may have started.

`acquire` gives a link to a simulator that answers: it joins a running one or starts one. The
simulator that was started here ends with the last Agent that is linked to it.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Mapping
from dataclasses import dataclass

from sailenv_ros.errors import DeadlineExceeded, SimulatorLost
from sailenv_ros.ros.client.connection import Connection
from sailenv_ros.ros.client.simulator_process import SimulatorProcess

__all__ = ["Link", "acquire", "release"]

DISCOVERY_S = 1.0
"""Time that a simulator on another host may take to be found before one is started here [s]."""


@dataclass(slots=True, eq=False)
class Link:
    """A connection with the number of its users.

    Attributes
    ----------
    connection : Connection
    process : SimulatorProcess or None
        The simulator, if it was started here.
    users : int
    """

    connection: Connection
    process: SimulatorProcess | None = None
    users: int = 0

    def close(self) -> None:
        """End the connection, and the simulator if it was started here."""
        self.connection.close()
        if self.process is not None:
            self.process.close()


_links: dict[tuple[int, str], Link] = {}
_lock = threading.Lock()


def _forget_the_parents() -> None:
    """Begin again in a fork, where the parent's threads do not exist and its lock may be held."""
    global _lock
    _links.clear()
    _lock = threading.Lock()


os.register_at_fork(after_in_child=_forget_the_parents)


def acquire(
    domain_id: int, namespace: str, parameters: Mapping[str, object], timeout_s: float
) -> Link:
    """Connect to the simulator of that name; start it if there is none.

    Parameters
    ----------
    domain_id : int
    namespace : str
        Full namespace, e.g. ``"/sailenv"``.
    parameters : mapping
        Of the node, if it is started.
    timeout_s : float
        Deadline for the simulator to answer [s].

    Raises
    ------
    SimulationClosed
        If a simulator was started and ended at once; with its own last words.
    DeadlineExceeded
        If none answered in time.
    """
    with _lock:
        key = (domain_id, namespace)
        link = _links.get(key)
        if link is None or not link.connection.simulator_lives():
            # Those who still hold the old link close it when they close.
            link = _links[key] = _connect(domain_id, namespace, parameters, timeout_s)
        link.users += 1
        return link


def release(link: Link) -> None:
    """Release a link for one of its users."""
    with _lock:
        link.users -= 1
        if link.users == 0:
            key = (link.connection.domain_id, link.connection.namespace)
            if _links.get(key) is link:
                del _links[key]
            link.close()


def _connect(
    domain_id: int, namespace: str, parameters: Mapping[str, object], timeout_s: float
) -> Link:
    link = Link(Connection(domain_id, namespace))
    connection = link.connection
    try:
        if connection.simulator_here() is None and not _answers_soon(connection):
            link.process = SimulatorProcess(domain_id, namespace, parameters)
            connection.watch(link.process.is_alive)
        try:
            _await_answer(connection, timeout_s)
        except SimulatorLost:
            assert link.process is not None
            if connection.simulator_here() is None:
                raise link.process.failure() from None
        if link.process is not None and connection.simulator_here() != link.process.pid:
            # Another program started one at the same time, and ours gives way to it.
            link.process.close()
            link.process = None
            connection.watch(lambda: True)
            _await_answer(connection, timeout_s)
        pid = connection.simulator_here()
        if link.process is None and pid is not None:
            # A simulator that comes after it under its name is another one: it has no such agents.
            connection.watch(lambda: connection.simulator_here() == pid)
    except BaseException:
        link.close()
        raise
    return link


def _await_answer(connection: Connection, timeout_s: float) -> None:
    what = f"a simulator in {connection.namespace} of ROS domain {connection.domain_id}"
    connection.wait_until(connection.simulator_answers, what, timeout_s)
    connection.await_info(lambda info: True, f"the scene_info of {what}", timeout_s)


def _answers_soon(connection: Connection) -> bool:
    try:
        connection.wait_until(connection.simulator_answers, "a simulator", DISCOVERY_S)
    except DeadlineExceeded:
        return False
    return True
