"""The topic `free_space`: each map that somebody asked for, as nav_msgs/OccupancyGrid.

Maps in, messages out, where nav_msgs is installed. package.xml declares it, so a ROS 2
installation has it; the ROS 2 packages on PyPI lack it, and there the service `get_free_space`
alone has the map.
"""

from __future__ import annotations

import importlib
import importlib.util
from typing import Any

from rclpy.node import Node

from sailenv_msgs_py.space_msgs import occupancy_grid_to_msg
from sailenv_ros.ros.nodes.qos import latched_qos
from sailenv_ros.space import FreeSpace

__all__ = ["FreeSpaceTopic"]


class FreeSpaceTopic:
    """Publishes maps, latched as map servers do; does nothing without nav_msgs."""

    def __init__(self, node: Node) -> None:
        self._type: Any = None
        if importlib.util.find_spec("nav_msgs") is None:
            return
        self._type = importlib.import_module("nav_msgs.msg").OccupancyGrid
        self._topic = node.create_publisher(self._type, "free_space", latched_qos())

    def publish(self, space: FreeSpace) -> None:
        """Publish a map; called from the simulation's thread."""
        if self._type is not None:
            self._topic.publish(occupancy_grid_to_msg(space, self._type))
