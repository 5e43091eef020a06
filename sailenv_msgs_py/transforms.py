"""Poses, points and vectors of the world frame to and from `geometry_msgs`.

A `Pose` checks itself, so a message with NaN, an infinite coordinate or a quaternion that is not
of unit length raises `InvalidRequest` on the way in.
"""

from __future__ import annotations

import geometry_msgs.msg as geometry
from builtin_interfaces.msg import Time

from sailenv_ros.types.camera import Camera
from sailenv_ros.types.geometry import QUAT_BODY_FROM_OPTICAL, Pose

__all__ = [
    "optical_pose_to_msg",
    "point_to_msg",
    "pose_from_msg",
    "pose_stamped_to_msg",
    "pose_to_msg",
    "twist_from_msg",
    "twist_to_msg",
    "vector_to_msg",
    "xyz_from_msg",
]

Triple = tuple[float, float, float]


def pose_to_msg(pose: Pose) -> geometry.Pose:
    """Make a message of a pose in the world frame."""
    x, y, z, w = pose.orientation_xyzw
    orientation = geometry.Quaternion(x=x, y=y, z=z, w=w)
    return geometry.Pose(position=point_to_msg(pose.position_m), orientation=orientation)


def pose_from_msg(msg: geometry.Pose) -> Pose:
    """Read a pose.

    Raises
    ------
    InvalidRequest
        If a number is not finite or too large, or the quaternion not of unit length.
    """
    q = msg.orientation
    return Pose(xyz_from_msg(msg.position), (q.x, q.y, q.z, q.w))


def pose_stamped_to_msg(pose: Pose, stamp: Time, frame_id: str) -> geometry.PoseStamped:
    """Make a stamped message of a pose in the frame of that name."""
    msg = geometry.PoseStamped(pose=pose_to_msg(pose))
    msg.header.stamp = stamp
    msg.header.frame_id = frame_id
    return msg


def optical_pose_to_msg(camera: Camera) -> geometry.Pose:
    """Make a message of the camera's optical frame (x right, y down, z forward) in the world."""
    return pose_to_msg(camera.pose.turned(QUAT_BODY_FROM_OPTICAL))


def point_to_msg(xyz: Triple) -> geometry.Point:
    """Make a point [m]."""
    x, y, z = xyz
    return geometry.Point(x=float(x), y=float(y), z=float(z))


def vector_to_msg(xyz: Triple) -> geometry.Vector3:
    """Make a vector."""
    x, y, z = xyz
    return geometry.Vector3(x=float(x), y=float(y), z=float(z))


def twist_to_msg(velocities: tuple[Triple, Triple]) -> geometry.Twist:
    """Make the message of a linear [m/s] and an angular velocity [rad/s]."""
    linear, angular = velocities
    return geometry.Twist(linear=vector_to_msg(linear), angular=vector_to_msg(angular))


def twist_from_msg(msg: geometry.Twist) -> tuple[Triple, Triple]:
    """Read a linear [m/s] and an angular velocity [rad/s]."""
    return xyz_from_msg(msg.linear), xyz_from_msg(msg.angular)


def xyz_from_msg(msg: geometry.Point | geometry.Vector3) -> Triple:
    """Read the three numbers of a point or a vector, whatever they are."""
    return float(msg.x), float(msg.y), float(msg.z)
