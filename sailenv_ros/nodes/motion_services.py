"""Services and the topic about motion: behaviours that come and go, movers that are driven."""

from __future__ import annotations

import time
from concurrent.futures import Future

from geometry_msgs.msg import Twist
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node

from sailenv_msgs.srv import AddBehaviour, RemoveBehaviours, SetMoverController
from sailenv_msgs_py.objects import behaviour_from_msg
from sailenv_ros.errors import SailenvError, SimulationClosed
from sailenv_ros.nodes.qos import command_qos
from sailenv_ros.nodes.requests import Requests, ServiceTable, offer

__all__ = ["MotionServices"]

WARN_INTERVAL_S = 2.0
"""A command that is refused is told so often: they come many times a second [s]."""


class MotionServices:
    """Serves behaviours and movers, and follows ``mover/cmd_vel``.

    Parameters
    ----------
    node : Node
    requests : Requests
    """

    def __init__(self, node: Node, requests: Requests) -> None:
        self._node = node
        self._ask = requests
        self._warned_s = -WARN_INTERVAL_S
        group = ReentrantCallbackGroup()
        offer(node, self._table(), group=group)
        node.create_subscription(
            Twist, "mover/cmd_vel", self._drive, command_qos(), callback_group=group
        )

    def _table(self) -> ServiceTable:
        return (
            ("add_behaviour", AddBehaviour, self._add_behaviour),
            ("remove_behaviours", RemoveBehaviours, self._remove_behaviours),
            ("set_mover_controller", SetMoverController, self._set_mover_controller),
        )

    async def _add_behaviour(
        self, request: AddBehaviour.Request, response: AddBehaviour.Response
    ) -> None:
        parameters = behaviour_from_msg(request.behaviour)
        type_ = parameters.pop("type")
        await self._ask("attach_behaviour", request.id, type_, parameters)

    async def _remove_behaviours(
        self, request: RemoveBehaviours.Request, response: RemoveBehaviours.Response
    ) -> None:
        await self._ask("detach_behaviours", request.id)

    async def _set_mover_controller(
        self, request: SetMoverController.Request, response: SetMoverController.Response
    ) -> None:
        await self._ask("set_mover_controller", request.mover, request.controller)

    def _drive(self, command: Twist) -> None:
        linear, angular = command.linear, command.angular
        try:
            driving = self._ask.begin(
                "drive_mover",
                linear_m_s=(linear.x, linear.y, linear.z),
                angular_rad_s=(angular.x, angular.y, angular.z),
            )
        except SimulationClosed:
            return
        driving.add_done_callback(self._tell)

    def _tell(self, driving: Future[None]) -> None:
        """Warn of a refused command; nobody waits for its answer."""
        problem = None if driving.cancelled() else driving.exception()
        now_s = time.monotonic()
        if not isinstance(problem, SailenvError) or now_s - self._warned_s < WARN_INTERVAL_S:
            return
        self._warned_s = now_s
        self._node.get_logger().warning(f"mover/cmd_vel: {problem}")
