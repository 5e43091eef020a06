"""Joints → the topic `joint_states`, as sensor_msgs/JointState, while somebody subscribes to it."""

from __future__ import annotations

from rclpy.node import Node
from sensor_msgs.msg import JointState

from sailenv_msgs_py.joint_msgs import joints_to_msg
from sailenv_ros.ros.nodes.qos import frame_qos
from sailenv_ros.ros.nodes.simulation_topic import SimulationTopic
from sailenv_ros.simulation import Simulation

__all__ = ["JointTopic"]


class JointTopic(SimulationTopic):
    """Publishes the positions of joints.

    Parameters
    ----------
    node : Node
    """

    def __init__(self, node: Node) -> None:
        super().__init__()
        self._topic = node.create_publisher(JointState, "joint_states", frame_qos())

    def _publish(self, simulation: Simulation, now_ns: int) -> None:
        if not self._topic.get_subscription_count():
            return
        joints = simulation.joints_now()
        if joints:
            self._topic.publish(joints_to_msg(joints, sim_time_ns=now_ns))
