"""Publishes the contacts between objects on the topic `contacts`, while it has subscribers."""

from __future__ import annotations

from rclpy.node import Node

from sailenv_msgs.msg import Contacts
from sailenv_msgs_py.contact_msgs import contacts_to_msg
from sailenv_ros.ros.nodes.qos import frame_qos
from sailenv_ros.ros.nodes.simulation_topic import SimulationTopic
from sailenv_ros.simulation import Simulation

__all__ = ["ContactTopic"]

MOST_S = 1.0
"""Longest time that one message tells of; an advance is a tenth of it [s]."""


class ContactTopic(SimulationTopic):
    """Publishes contacts.

    Parameters
    ----------
    node : Node
    """

    def __init__(self, node: Node) -> None:
        super().__init__()
        self._topic = node.create_publisher(Contacts, "contacts", frame_qos())
        self._told_ns = 0

    def _publish(self, simulation: Simulation, now_ns: int) -> None:
        since_ns, self._told_ns = self._told_ns, now_ns
        if not self._topic.get_subscription_count():
            return
        # At a reset time begins at 0 again.
        seconds = min(MOST_S, max(0.0, (now_ns - since_ns) * 1e-9))
        touching = simulation.contacts_of_steps(seconds)
        if touching:
            self._topic.publish(
                contacts_to_msg(touching, sim_time_ns=now_ns, revision=simulation.info.revision)
            )
