"""Frames of reference that requests name: the world, or an entity."""

from __future__ import annotations

from typing import Any

import numpy as np
from simulation_interfaces.msg import EntityState

from sailenv_msgs_py.frame_info import WORLD_FRAME_ID
from sailenv_msgs_py.stamps import stamp_from_ns
from sailenv_msgs_py.transforms import (
    pose_from_msg,
    pose_to_msg,
    twist_from_msg,
    twist_to_msg,
    vector_to_msg,
)
from sailenv_ros.errors import SailenvError
from sailenv_ros.ros.nodes.simulation_interfaces.desk import Desk
from sailenv_ros.ros.nodes.simulation_interfaces.results import Refusal
from sailenv_ros.ros.nodes.tf_tree import object_frame_id
from sailenv_ros.simulation.operations import Operations
from sailenv_ros.types.entities import Entity
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.validation import vector

__all__ = ["pose_in_world", "state_to_msg", "velocities_in_world"]

Vector3 = tuple[float, float, float]


async def pose_in_world(desk: Desk, frame_id: str, pose: Any, invalid: int) -> Pose:
    """Return a message's pose in the world.

    Parameters
    ----------
    desk : Desk
    frame_id : str
        Empty or ``world``, the name of an entity, or of its frame on /tf.
    pose : geometry_msgs/Pose
    invalid : int
        Code of a pose that cannot be.

    Raises
    ------
    Refusal
    """
    frame = await _frame(desk, frame_id, invalid)
    try:
        return frame.carried(pose_from_msg(pose))
    except SailenvError as problem:
        raise Refusal(invalid, str(problem)) from None


async def velocities_in_world(
    desk: Desk, frame_id: str, twist: Any, invalid: int
) -> tuple[Vector3, Vector3]:
    """Return a twist's velocities [m/s] and [rad/s] in the world's axes; see `pose_in_world`."""
    turn = (await _frame(desk, frame_id, invalid)).matrix()[:3, :3]
    linear, angular = (turn @ np.asarray(part) for part in twist_from_msg(twist))
    try:
        return vector("linear velocity", linear), vector("angular velocity", angular)
    except SailenvError as problem:
        raise Refusal(invalid, str(problem)) from None


def state_to_msg(entity: Entity) -> Any:
    """Make the state of an entity in the world."""
    state = EntityState(pose=pose_to_msg(entity.pose))
    state.header.frame_id = WORLD_FRAME_ID
    state.header.stamp = stamp_from_ns(entity.sim_time_ns)
    state.twist = twist_to_msg((entity.linear_velocity, entity.angular_velocity))
    linear, angular = entity.linear_acceleration, entity.angular_acceleration
    state.acceleration.linear = vector_to_msg(linear)
    state.acceleration.angular = vector_to_msg(angular)
    return state


async def _frame(desk: Desk, frame_id: str, invalid: int) -> Pose:
    if frame_id in ("", WORLD_FRAME_ID):
        return Pose()
    known = desk.ids
    number = known.get(frame_id)
    if number is None:
        frames = {object_frame_id(name): number for name, number in known.items()}
        number = frames.get(frame_id)
    if number is None:
        sentence = f"frame_id must be empty, {WORLD_FRAME_ID} or an entity, got {frame_id!r}"
        raise Refusal(invalid, sentence)
    state = await desk.do(Operations.get_object, abs(number))
    return state.pose
