"""The services of the simulator itself, and the topic by which its mover is driven."""

from __future__ import annotations

import time
from collections.abc import Awaitable, Callable
from concurrent.futures import Future

from geometry_msgs.msg import Twist
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node

from sailenv_msgs_py.services import SERVICES, SIMULATOR_SERVICES
from sailenv_msgs_py.transforms import twist_from_msg
from sailenv_ros.errors import SailenvError, SimulationClosed
from sailenv_ros.ros.nodes.qos import command_qos
from sailenv_ros.ros.nodes.requests import OperationRunner, offer_services
from sailenv_ros.simulation.operations import Operations

__all__ = ["SimulatorServices"]

WARN_INTERVAL_S = 2.0
"""A command that is refused is logged so often: they come many times a second [s]."""


class SimulatorServices:
    """Serves the simulator, and follows ``mover/cmd_vel``.

    Parameters
    ----------
    node : Node
    runner : OperationRunner
    agents_changed : callable
        Called in the executor's thread when an operation was done, before the response: an agent's
        topics and services are there when its registration is answered.
    before_registration : callable
        Awaited before an agent is registered.
    """

    def __init__(
        self,
        node: Node,
        runner: OperationRunner,
        agents_changed: Callable[[], None],
        *,
        before_registration: Callable[[], Awaitable[None]],
    ) -> None:
        self._node = node
        self._runner = runner
        self._warned_s = -WARN_INTERVAL_S
        group = ReentrantCallbackGroup()
        registration = SERVICES[Operations.register_agent.name]
        others = [service for service in SIMULATOR_SERVICES if service is not registration]
        offer_services(node, runner, others, group=group, before_response=agents_changed)
        offer_services(
            node,
            runner,
            [registration],
            group=group,
            before_request=before_registration,
            before_response=agents_changed,
        )
        node.create_subscription(
            Twist, "mover/cmd_vel", self._drive, command_qos(), callback_group=group
        )

    def _drive(self, command: Twist) -> None:
        linear_m_s, angular_rad_s = twist_from_msg(command)
        try:
            driving = self._runner.submit(Operations.drive_mover, linear_m_s, angular_rad_s)
        except SimulationClosed:
            return
        except SailenvError as problem:
            self._warn(problem)
            return
        driving.add_done_callback(self._report)

    def _report(self, driving: Future[None]) -> None:
        """Warn of a refused command; nobody waits for its answer."""
        problem = None if driving.cancelled() else driving.exception()
        if isinstance(problem, SailenvError):
            self._warn(problem)

    def _warn(self, problem: SailenvError) -> None:
        now_s = time.monotonic()
        if now_s - self._warned_s >= WARN_INTERVAL_S:
            self._warned_s = now_s
            self._node.get_logger().warning(f"mover/cmd_vel: {problem}")
