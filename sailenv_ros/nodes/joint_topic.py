"""Joints → the topic `joint_states`, as sensor_msgs/JointState, while somebody subscribes to it.

Called from the simulation's loop thread after physics advanced, as `announcements` is.
"""

from __future__ import annotations

import threading
from collections.abc import Callable

from rclpy.node import Node
from sensor_msgs.msg import JointState

from sailenv_msgs_py.joint_msgs import joints_to_msg
from sailenv_ros.nodes.qos import frame_qos
from sailenv_ros.simulation import Simulation

__all__ = ["JointTopic"]


class JointTopic:
    """Publishes the positions of joints.

    Parameters
    ----------
    node : Node
    """

    def __init__(self, node: Node) -> None:
        self._topic = node.create_publisher(JointState, "joint_states", frame_qos())
        self._publishing = threading.Lock()
        self._ended = False
        self._unsubscribe: Callable[[], None] = lambda: None

    def begin(self, simulation: Simulation) -> None:
        """Follow a simulation from now on."""
        self._unsubscribe = simulation.on_step(lambda now_ns: self._publish(simulation, now_ns))

    def end(self) -> None:
        """Stop following; nothing is published after this returns."""
        with self._publishing:
            self._ended = True
        self._unsubscribe()

    def _publish(self, simulation: Simulation, now_ns: int) -> None:
        with self._publishing:
            if self._ended or not self._topic.get_subscription_count():
                return
            joints = simulation.joints_now()
            if joints:
                self._topic.publish(joints_to_msg(joints, sim_time_ns=now_ns))
