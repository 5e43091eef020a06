"""Kinematics of joints: pose and velocity of an object on a joint; arithmetic alone, no engine.

A point x of an object whose joint is at q is at ``parent · rest · motion(q) · x``, where motion
turns about the axis through the joint's origin (hinge) or shifts along it (slide).
"""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.postures.limbs import cross
from sailenv_ros.types.geometry import POSITION_LIMIT_M, Pose
from sailenv_ros.world.placement import JointPlacement

__all__ = ["composed", "link_pose", "link_velocity"]

Doubles: TypeAlias = NDArray[np.float64]
Twist: TypeAlias = tuple[Doubles, Doubles]
"""Velocity of a frame's origin [m/s] and angular velocity [rad/s], world axes."""


def composed(a_from_b: Pose, b_from_c: Pose) -> Pose:
    """Return a_from_c; what would be farther away than positions go is at the edge."""
    turn = a_from_b.matrix()[:3, :3]
    place = turn @ np.asarray(b_from_c.position_m) + np.asarray(a_from_b.position_m)
    x, y, z = np.clip(place, -POSITION_LIMIT_M, POSITION_LIMIT_M).tolist()
    return Pose((x, y, z), a_from_b.turned(b_from_c.orientation_xyzw).orientation_xyzw)


def link_pose(world_from_rest: Pose, joint: JointPlacement, position: float) -> Pose:
    """Return the pose of what moves on a joint.

    Parameters
    ----------
    world_from_rest : Pose
        Where it is while the joint's position is 0.
    joint : JointPlacement
    position : float
        [rad] or [m].
    """
    spec = joint.spec
    if not position or not spec.moves:
        return world_from_rest
    axis = np.asarray(spec.unit_axis)
    if spec.type == "slide":
        x, y, z = np.clip(axis * position, -POSITION_LIMIT_M, POSITION_LIMIT_M).tolist()
        return composed(world_from_rest, Pose((x, y, z)))
    half = position / 2.0
    qx, qy, qz = (axis * math.sin(half)).tolist()
    turn = Pose((0.0, 0.0, 0.0), (qx, qy, qz, math.cos(half)))
    origin = np.asarray(spec.origin)
    ox, oy, oz = (origin - turn.matrix()[:3, :3] @ origin).tolist()
    return composed(world_from_rest, Pose((ox, oy, oz), turn.orientation_xyzw))


def link_velocity(
    parent: Doubles,
    of_parent: Twist,
    rest: Doubles,
    now: Doubles,
    joint: JointPlacement,
    rate: float,
) -> Twist:
    """Return how the frame of what moves on a joint moves.

    Parameters
    ----------
    parent, rest, now : (4, 4) float64
        Poses in the world of what carries it, of its own at the joint's position 0, and of its
        own now.
    of_parent : Twist
    joint : JointPlacement
    rate : float
        Of the joint's position [rad/s] or [m/s].
    """
    linear, angular = of_parent
    linear = linear + cross(angular, now[:3, 3] - parent[:3, 3])
    spec = joint.spec
    if not rate or not spec.moves:
        return linear, angular
    axis = rest[:3, :3] @ np.asarray(spec.unit_axis)
    if spec.type == "slide":
        return linear + axis * rate, angular
    pivot = rest[:3, :3] @ np.asarray(spec.origin) + rest[:3, 3]
    return linear + cross(axis * rate, now[:3, 3] - pivot), angular + axis * rate
