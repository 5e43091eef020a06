"""The node that offers the standard interfaces, beside that of the simulator.

A node and a thread of its own: the simulator's frames do not wait for one more service.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from typing import Any

from rclpy.action.server import ActionServer
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile
from simulation_interfaces.action import SimulateSteps
from simulation_interfaces.srv import GetSimulatorFeatures

from sailenv_ros.ros.executor_thread import ExecutorThread
from sailenv_ros.ros.nodes.requests import OperationRunner
from sailenv_ros.ros.nodes.simulation_interfaces.clock import accept_cancel, simulate_steps
from sailenv_ros.ros.nodes.simulation_interfaces.desk import Desk
from sailenv_ros.ros.nodes.simulation_interfaces.results import answered
from sailenv_ros.ros.nodes.simulation_interfaces.table import ROWS, Row, features_of
from sailenv_ros.simulation import Simulation

__all__ = ["NODE_NAME", "SimulationInterfaces", "service_name"]

NODE_NAME = "simulation_interfaces"

QUITS_AFTER_S = 0.5
"""Time from the answer to a request to quit until the end begins [s]."""

FEEDBACK_DEPTH = 240
"""Feedback that is kept for a slow client: of a second of steps."""


def service_name(type_name: str) -> str:
    """Return the name of the service of a type: ``GetEntities`` → ``get_entities``."""
    return re.sub(r"(?<!^)(?=[A-Z])", "_", type_name).lower()


class SimulationInterfaces:
    """Offers all services and the action; see `standard_interfaces` for the parameters."""

    def __init__(
        self, beside: Node, simulation: Simulation, quit_process: Callable[[], None]
    ) -> None:
        self._node = Node(
            NODE_NAME,
            namespace=beside.get_namespace(),
            context=beside.context,
            # Remappings of names are for this node, too, but for that of the simulator's node.
            cli_args=["--ros-args", "-r", f"__node:={NODE_NAME}"],
            enable_rosout=False,
            start_parameter_services=False,
        )
        self._executor = SingleThreadedExecutor(context=beside.context)
        runner = OperationRunner(simulation, self._executor)
        self._desk = Desk(
            simulation,
            runner,
            # Nothing tells when an answer has arrived, and the end of a process takes it along.
            quit_soon=lambda: self._node.create_timer(QUITS_AFTER_S, quit_process),
        )
        group = ReentrantCallbackGroup()
        for row in ROWS:
            self._serve(row.type, row.type_name, self._handler(row), group)
        self._action = ActionServer(
            self._node,
            SimulateSteps,
            service_name(SimulateSteps.__name__),
            execute_callback=partial(simulate_steps, self._desk),
            cancel_callback=accept_cancel,
            feedback_pub_qos_profile=QoSProfile(depth=FEEDBACK_DEPTH),
            callback_group=group,
        )
        features = features_of()

        async def tell(request: Any, response: Any) -> None:
            response.features = features

        self._serve(GetSimulatorFeatures, "GetSimulatorFeatures", tell, group)
        self._spinning = ExecutorThread(self._executor, NODE_NAME)

    def start(self) -> None:
        """Begin to serve."""
        self._executor.add_node(self._node)
        self._spinning.start()

    def close(self) -> None:
        """End."""
        self._spinning.stop(0.5)
        self._action.destroy()
        self._executor.shutdown(0.0)
        self._node.destroy_node()

    def _serve(self, kind: Any, type_name: str, handler: Any, group: Any) -> None:
        name = service_name(type_name)
        self._node.create_service(kind, name, answered(handler), callback_group=group)

    def _handler(self, row: Row) -> Callable[[Any, Any], Any]:
        async def handle(request: Any, response: Any) -> None:
            if row.needs_world:
                self._desk.require_world()
            await row.handler(self._desk, request, response)

        return handle
