"""Movers, their bodies and what is faced, to and from their messages."""

from __future__ import annotations

from typing import Literal, cast

import sailenv_msgs.msg as msgs
from sailenv_msgs_py.transforms import point_to_msg, pose_from_msg, pose_to_msg, xyz_from_msg
from sailenv_ros.types.look_at import LookAt
from sailenv_ros.types.rigid_body import RIGID_BODY_LIMITS, RigidBody
from sailenv_ros.types.scene_info import MoverInfo

__all__ = [
    "look_at_from_msg",
    "look_at_to_msg",
    "mover_from_msg",
    "mover_to_msg",
    "rigid_body_from_msg",
    "rigid_body_to_msg",
]


def mover_to_msg(mover: MoverInfo) -> msgs.Mover:
    """Make the message of a mover."""
    return msgs.Mover(
        name=mover.name,
        controller=mover.controller,
        waypoints=[pose_to_msg(pose) for pose in mover.waypoints],
        total_time=float(mover.total_time_s),
        loop=mover.loop,
        is_body=mover.body is not None,
        body=rigid_body_to_msg(mover.body or RigidBody()),
        look_at=look_at_to_msg(mover.look_at),
    )


def mover_from_msg(msg: msgs.Mover) -> MoverInfo:
    """Read the message of a mover."""
    return MoverInfo(
        name=msg.name,
        controller=cast(Literal["waypoint", "rigidbody"], msg.controller),
        waypoints=tuple(pose_from_msg(pose) for pose in msg.waypoints),
        total_time_s=msg.total_time,
        loop=msg.loop,
        body=rigid_body_from_msg(msg.body) if msg.is_body else None,
        look_at=look_at_from_msg(msg.look_at),
    )


def rigid_body_to_msg(body: RigidBody) -> msgs.RigidBody:
    """Make the message of a rigid body."""
    numbers = {name: float(getattr(body, name)) for name in RIGID_BODY_LIMITS}
    return msgs.RigidBody(gravity=body.gravity, **numbers)


def rigid_body_from_msg(msg: msgs.RigidBody) -> RigidBody:
    """Read a rigid body.

    Raises
    ------
    InvalidRequest
        If a number is out of its range.
    """
    numbers = {name: getattr(msg, name) for name in RIGID_BODY_LIMITS}
    return RigidBody(gravity=bool(msg.gravity), **numbers)


def look_at_to_msg(look_at: LookAt | None) -> msgs.LookAt:
    """Make the message of what is faced; of None, one that is not active."""
    if look_at is None:
        return msgs.LookAt()
    return msgs.LookAt(active=True, object=look_at.obj, point=point_to_msg(look_at.point_m))


def look_at_from_msg(msg: msgs.LookAt) -> LookAt | None:
    """Read what is faced; None if nothing is.

    Raises
    ------
    InvalidRequest
        If the point is not finite or beyond 10 km.
    """
    return LookAt(obj=msg.object, point_m=xyz_from_msg(msg.point)) if msg.active else None
