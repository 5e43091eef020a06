"""`AgentSpec` to and from `sailenv_msgs/AgentInfo`.

The message has no pose: where an agent starts stands beside it in a request, and where it is
stands on its pose topic. The cameras of a rig have messages of their own.
"""

from __future__ import annotations

from sailenv_msgs.msg import AgentInfo
from sailenv_msgs_py.intrinsics_fields import (
    INTRINSICS_FIELDS,
    intrinsics_fields,
    intrinsics_from_fields,
)
from sailenv_msgs_py.mover_msgs import look_at_from_msg, look_at_to_msg
from sailenv_msgs_py.picture_msgs import picture_from_msg, picture_to_msg
from sailenv_msgs_py.transforms import pose_from_msg, pose_to_msg
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.rigs import body_of
from sailenv_ros.types.views import FIVE_VIEWS

__all__ = ["agent_spec_from_msg", "agent_spec_to_msg"]


def agent_spec_to_msg(spec: AgentSpec) -> AgentInfo:
    """Make the message of an agent, less its start pose."""
    return AgentInfo(
        name=spec.name,
        **intrinsics_fields(spec.intrinsics),
        depth_range_m=float(spec.depth_range_m),
        rate_hz=float(spec.rate_hz),
        views=list(spec.views),
        following=spec.following,
        mover=spec.mover,
        picture=picture_to_msg(spec.picture),
        look_at=look_at_to_msg(spec.look_at),
        carrier=spec.carrier,
        extrinsics=pose_to_msg(_held(spec)),
    )


def _held(spec: AgentSpec) -> Pose:
    """Return where an agent is in the frame of what carries it."""
    return spec.extrinsics or (spec.pose if spec.carrier else None) or Pose()


def agent_spec_from_msg(msg: AgentInfo, *, pose: Pose | None = None) -> AgentSpec:
    """Read an agent; no views at all mean the five.

    Raises
    ------
    InvalidRequest
        If a name, size, angle, distance, rate, view or setting is out of its range.
    """
    return AgentSpec(
        name=msg.name,
        intrinsics=intrinsics_from_fields({name: getattr(msg, name) for name in INTRINSICS_FIELDS}),
        depth_range_m=msg.depth_range_m,
        rate_hz=msg.rate_hz,
        views=tuple(msg.views) or FIVE_VIEWS,
        following=bool(msg.following),
        mover=msg.mover,
        picture=picture_from_msg(msg.picture),
        pose=pose_from_msg(msg.extrinsics) if msg.carrier else pose,
        carrier=msg.carrier,
        look_at=look_at_from_msg(msg.look_at),
        extrinsics=pose_from_msg(msg.extrinsics) if body_of(msg.name) else None,
    )
