"""Leases: an agent that a client holds goes when the client's process has ended.

A client is a node whose name begins with ``client_``, as that of an `Agent` does, and holds the
agent whose `frame_info` it subscribed to before the agent was registered. It has ended when the
kernel has let go of its lock, which is known at once (same host, same user), else when DDS has
not heard of it for the time of its lease (`config/fastdds.xml`). Agents of scenes and of service
calls that no client subscribed for are nobody's, and stay.
"""

from __future__ import annotations

import logging
import re
import time
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass, field

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node

from sailenv_ros.errors import SailenvError
from sailenv_ros.ros.nodes.requests import OperationRunner
from sailenv_ros.simulation.operations import Operations
from sailenv_ros.system.client_locks import client_lives
from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["AgentLeases"]

_log = logging.getLogger(__name__)

LOOK_INTERVAL_S = 0.5
"""Interval at which it is checked whether clients live [s of wall time]."""

FIND_S = 2.0
"""Time that discovery may take to find the owner of a new agent [s of wall time]."""

_CLIENT = re.compile(r"client_\d+_[0-9a-f]{6}")


@dataclass(slots=True)
class _Lease:
    """The clients that hold an agent; none are known yet while ``clients`` is empty."""

    registered_s: float
    clients: set[str] = field(default_factory=set)


class AgentLeases:
    """Removes the agents of clients that have ended; used by the executor's thread alone.

    Parameters
    ----------
    node : Node
    runner : OperationRunner
    """

    def __init__(self, node: Node, runner: OperationRunner) -> None:
        self._node = node
        self._runner = runner
        self._epoch = 0
        self._known: set[str] = set()
        self._leases: dict[str, _Lease] = {}
        self._removals: list[Future[None]] = []
        node.create_timer(
            LOOK_INTERVAL_S, self._look, clock=Clock(clock_type=ClockType.STEADY_TIME)
        )

    def take_note(self, info: SceneInfo) -> None:
        """Learn which agents there are; to be called after each registration, at once."""
        names = {spec.name for spec in info.agents}
        if info.epoch == self._epoch:
            for name in names - self._known:
                self._leases[name] = _Lease(time.monotonic())
        # With an epoch come the agents of its scene, which are nobody's.
        self._epoch, self._known = info.epoch, names
        for name in self._leases.keys() - names:
            del self._leases[name]
        self._find_clients()

    async def settle(self) -> bool:
        """Remove the agents of clients that have ended, and wait for it; say if there were any.

        Before a registration, so that a client that begins again gets its name back at once.
        """
        self._look()
        removals = tuple(self._removals)
        for removal in removals:
            with suppress(SailenvError):  # another was faster
                await self._runner.settled(removal)
        return bool(removals)

    # -- inside ----------------------------------------------------------------------------

    def _look(self) -> None:
        """Begin to remove the agents whose clients have ended."""
        self._removals = [removal for removal in self._removals if not removal.done()]
        self._find_clients()
        ended = [
            (name, lease)
            for name, lease in self._leases.items()
            if lease.clients and not any(self._lives(client, name) for client in lease.clients)
        ]
        for name, lease in ended:
            del self._leases[name]
            with suppress(SailenvError):  # the simulation has ended, and with it all
                self._removals.append(self._runner.submit(Operations.delete_agent, name))
                _log.info(
                    "agent %r is removed: its client %s has ended", name, ", ".join(lease.clients)
                )

    def _find_clients(self) -> None:
        """Look whose the new agents are; the first that is found holds it."""
        now = time.monotonic()
        for name, lease in list(self._leases.items()):
            if not lease.clients:
                lease.clients |= self._subscribers(name)
                if not lease.clients and now - lease.registered_s > FIND_S:
                    del self._leases[name]

    def _lives(self, client: str, agent: str) -> bool:
        lives = client_lives(client)
        return client in self._subscribers(agent) if lives is None else lives

    def _subscribers(self, agent: str) -> set[str]:
        """Return the clients that read an agent's frames, as far as DDS knows."""
        namespace = self._node.get_namespace()
        topic = f"{namespace.rstrip('/')}/{agent}/frame_info"
        return {
            found.node_name
            for found in self._node.get_subscriptions_info_by_topic(topic)
            if found.node_namespace == namespace and _CLIENT.fullmatch(found.node_name)
        }
