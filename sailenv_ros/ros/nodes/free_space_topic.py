"""The topic `free_space`: each map that somebody asked for, as nav_msgs/OccupancyGrid."""

from __future__ import annotations

from nav_msgs.msg import OccupancyGrid
from rclpy.node import Node

from sailenv_msgs_py.space_msgs import occupancy_grid_to_msg
from sailenv_ros.ros.nodes.qos import latched_qos
from sailenv_ros.space import FreeSpace

__all__ = ["FreeSpaceTopic"]


class FreeSpaceTopic:
    """Publishes maps, latched as map servers do."""

    def __init__(self, node: Node) -> None:
        self._topic = node.create_publisher(OccupancyGrid, "free_space", latched_qos())

    def publish(self, space: FreeSpace) -> None:
        """Publish a map; called from the simulation's thread."""
        self._topic.publish(occupancy_grid_to_msg(space))
