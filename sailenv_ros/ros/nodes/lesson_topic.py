"""Publishes the current lesson on the latched topic `lesson`, at each change."""

from __future__ import annotations

from rclpy.node import Node
from std_msgs.msg import String

from sailenv_ros.ros.nodes.qos import latched_qos
from sailenv_ros.ros.nodes.simulation_topic import SimulationTopic
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.lessons import LessonState

__all__ = ["LessonTopic"]


class LessonTopic(SimulationTopic):
    """Publishes which lesson of which lap it is, as JSON; an empty text where there are none.

    Parameters
    ----------
    node : Node
    """

    def __init__(self, node: Node) -> None:
        super().__init__()
        self._topic = node.create_publisher(String, "lesson", latched_qos())
        self._told: LessonState | None = None

    def begin(self, simulation: Simulation) -> None:
        """Follow a simulation from now on; changes of the scene count as well as its steps."""
        self._topic.publish(String())
        self._stops.append(
            simulation.on_info(lambda info: self._follow(simulation, info.sim_time_ns))
        )
        super().begin(simulation)

    def _publish(self, simulation: Simulation, now_ns: int) -> None:
        state = simulation.lesson
        if state != self._told:
            self._told = state
            self._topic.publish(String(data="" if state is None else state.to_json()))
