"""Where the lessons are → the topic `lesson`, at every change; latched.

Called from the simulation's loop thread, as `announcements` is.
"""

from __future__ import annotations

import threading
from collections.abc import Callable

from rclpy.node import Node
from std_msgs.msg import String

from sailenv_ros.lessons import LessonState
from sailenv_ros.nodes.qos import latched_qos
from sailenv_ros.simulation import Simulation

__all__ = ["LessonTopic"]


class LessonTopic:
    """Publishes which lesson of which lap it is, as JSON; an empty text where there are none.

    Parameters
    ----------
    node : Node
    """

    def __init__(self, node: Node) -> None:
        self._topic = node.create_publisher(String, "lesson", latched_qos())
        self._publishing = threading.Lock()
        self._ended = False
        self._told: LessonState | None = None
        self._stops: list[Callable[[], None]] = []

    def begin(self, simulation: Simulation) -> None:
        """Follow a simulation from now on."""
        self._topic.publish(String())
        self._stops = [
            simulation.on_info(lambda info: self._look(simulation)),
            simulation.on_step(lambda now_ns: self._look(simulation)),
        ]

    def end(self) -> None:
        """Stop following; nothing is published after this returns."""
        with self._publishing:
            self._ended = True
        for stop in self._stops:
            stop()

    def _look(self, simulation: Simulation) -> None:
        with self._publishing:
            state = simulation.lesson
            if state != self._told and not self._ended:
                self._told = state
                self._topic.publish(String(data="" if state is None else state.to_json()))
