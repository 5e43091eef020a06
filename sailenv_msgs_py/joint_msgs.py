"""Joints to and from messages."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, cast

from sensor_msgs.msg import JointState as JointStateMsg
from std_msgs.msg import Header

from sailenv_msgs_py.frame_info import WORLD_FRAME_ID
from sailenv_msgs_py.stamps import stamp_from_ns
from sailenv_ros.types.joints import JointKind, JointState

__all__ = ["joints_from_response", "joints_to_msg", "joints_to_response"]


def joints_to_msg(joints: Sequence[JointState], *, sim_time_ns: int) -> JointStateMsg:
    """Make the message of all joints at an instant [ns]; efforts are not measured."""
    return JointStateMsg(
        header=Header(stamp=stamp_from_ns(sim_time_ns), frame_id=WORLD_FRAME_ID),
        name=[joint.name for joint in joints],
        position=[joint.position for joint in joints],
        velocity=[joint.velocity for joint in joints],
    )


def joints_to_response(response: Any, joints: Sequence[JointState]) -> None:
    """Fill the response of GetJoints."""
    response.ids = [joint.id for joint in joints]
    response.names = [joint.name for joint in joints]
    response.types = [joint.type for joint in joints]
    response.parents = [joint.parent for joint in joints]
    response.positions = [joint.position for joint in joints]
    response.velocities = [joint.velocity for joint in joints]
    response.lows = [joint.low for joint in joints]
    response.highs = [joint.high for joint in joints]
    response.efforts = [joint.effort for joint in joints]


def joints_from_response(response: Any) -> tuple[JointState, ...]:
    """Read the response of GetJoints."""
    columns = (
        response.ids,
        response.names,
        response.types,
        response.parents,
        response.positions,
        response.velocities,
        response.lows,
        response.highs,
        response.efforts,
    )
    return tuple(
        JointState(
            id=int(id_),
            name=name,
            type=cast("JointKind", kind),
            parent=parent,
            position=position,
            velocity=velocity,
            low=low,
            high=high,
            effort=effort,
        )
        for id_, name, kind, parent, position, velocity, low, high, effort in zip(
            *columns, strict=True
        )
    )
