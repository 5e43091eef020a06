"""Frames of robots for `/tf` and `/tf_static`, by REP 105.

``world`` → ``map`` → ``<robot>/odom`` → ``<robot>/<first link>`` → its links. The first three
coincide but for the place where a robot began. Robots' states in, transforms out.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from geometry_msgs.msg import TransformStamped
from std_msgs.msg import Header

from sailenv_msgs_py.frame_info import WORLD_FRAME_ID
from sailenv_msgs_py.stamps import stamp_from_ns
from sailenv_ros.ros.nodes.tf_tree import transform_of
from sailenv_ros.types.geometry import Pose, invert
from sailenv_ros.types.robots import RobotModel
from sailenv_ros.world.robot import Robot

__all__ = ["BASE", "MAP", "RobotFrames", "map_transform", "ros_name"]

MAP, ODOM, BASE = "map", "odom", "base_link"


def ros_name(robot: str) -> str:
    """Return the name of a robot as topics and frames have it: letters, digits, underscores.

    What is before a dot is a namespace: ``one.cart`` becomes ``one/cart``.
    """
    return "/".join(_token(part) for part in robot.lower().split("."))


def _token(name: str) -> str:
    plain = "".join(c if c.isascii() and (c.isalnum() or c == "_") else "_" for c in name)
    return plain if plain[:1].isalpha() else f"r{plain}"


def map_transform() -> TransformStamped:
    """Return that the map is the world."""
    return transform_of(Pose(), Header(frame_id=WORLD_FRAME_ID), MAP)


class RobotFrames:
    """The frames of one robot.

    Parameters
    ----------
    robot : Robot
        As it begins; its odometry counts from there.
    """

    def __init__(self, robot: Robot) -> None:
        self._prefix = ros_name(robot.name)
        self._model: RobotModel = robot.model
        self.start = robot.first_pose()
        self.first = self._model.links[0].name
        self._is_fixed = robot.placement.mount == "fixed"

    def named(self, frame: str) -> str:
        """Return the name of a link's frame."""
        return f"{self._prefix}/{frame.replace(' ', '_')}"

    @property
    def odom(self) -> str:
        """Name of the frame in which odometry is told."""
        return self.named(ODOM)

    @property
    def base(self) -> str:
        """Name of the frame of the first link."""
        return self.named(self.first)

    def odom_from_base(self, robot: Robot) -> Pose:
        """Return where the first link is, from where it began."""
        began = invert(self.start.matrix())
        return Pose.from_matrix(began @ robot.first_pose().matrix())

    def fixed(self) -> Iterator[TransformStamped]:
        """Yield what never changes."""
        model = self._model
        place = Header(frame_id=MAP)
        yield transform_of(self.start, place, self.base if self._is_fixed else self.odom)
        for link in model.links:
            if link.parent and link.joint.type == "fixed":
                header = Header(frame_id=self.named(link.parent))
                yield transform_of(link.joint.parent_from_rest, header, self.named(link.name))
        for frame in model.frames:
            header = Header(frame_id=self.named(frame.link))
            yield transform_of(frame.pose, header, self.named(frame.name))
        names = {one.name for one in model.links} | {one.name for one in model.frames}
        if BASE not in names:
            yield transform_of(Pose(), Header(frame_id=self.base), self.named(BASE))

    def sensors(self, robot: Robot) -> Iterator[TransformStamped]:
        """Yield where the sensors are on their links."""
        for name, link, pose in robot.sensors.mounted:
            yield transform_of(pose, Header(frame_id=self.named(link)), self.named(name))

    def moving(self, robot: Robot, sim_time_ns: int) -> Iterator[TransformStamped]:
        """Yield where everything is at an instant."""
        stamp = stamp_from_ns(sim_time_ns)
        if not self._is_fixed:
            header = Header(stamp=stamp, frame_id=self.odom)
            yield transform_of(self.odom_from_base(robot), header, self.base)
        for link in self._model.moving:
            parent = robot.bodies[link.parent].world_from_body()
            own = np.asarray(robot.bodies[link.name].world_from_body())
            header = Header(stamp=stamp, frame_id=self.named(link.parent))
            between = Pose.from_matrix(invert(parent) @ own)
            yield transform_of(between, header, self.named(link.name))
