"""What belongs to a frame beside its images, to `sailenv_msgs/FrameInfo`; and a frame's headers."""

from __future__ import annotations

from collections.abc import Iterable

from std_msgs.msg import Header

from sailenv_msgs.msg import FrameInfo
from sailenv_msgs_py.stamps import stamp_from_ns
from sailenv_msgs_py.transforms import optical_pose_to_msg, pose_from_msg
from sailenv_ros.camera import Camera, CameraIntrinsics
from sailenv_ros.frame import Frame
from sailenv_ros.geometry import QUAT_BODY_FROM_OPTICAL

__all__ = [
    "WORLD_FRAME_ID",
    "camera_of_frame_info",
    "frame_info_to_msg",
    "header_of_frame",
    "optical_frame_id",
]

WORLD_FRAME_ID = "world"
"""Name of the coordinate frame that everything is placed in."""


def optical_frame_id(agent: str) -> str:
    """Name the optical frame (x right, y down, z forward) of an agent's camera."""
    return f"{agent}/camera_optical_frame"


def header_of_frame(frame: Frame) -> Header:
    """Make the header that everything of one frame shares."""
    return Header(stamp=stamp_from_ns(frame.stamp_ns), frame_id=optical_frame_id(frame.agent))


def frame_info_to_msg(
    frame: Frame, header: Header, *, views: Iterable[str], depth_range_m: float
) -> FrameInfo:
    """Make the message of a frame of which these views are published."""
    intrinsics = frame.camera.intrinsics
    return FrameInfo(
        header=header,
        agent=frame.agent,
        scene=frame.scene,
        epoch=frame.epoch,
        revision=frame.revision,
        sequence=frame.sequence,
        dt_ns=frame.dt_ns,
        camera_pose=optical_pose_to_msg(frame.camera),
        views=list(views),
        near_m=float(intrinsics.near_m),
        far_m=float(intrinsics.far_m),
        depth_range_m=float(depth_range_m),
        render_s=float(frame.timings_s.get("render", 0.0)),
    )


def camera_of_frame_info(msg: FrameInfo, intrinsics: CameraIntrinsics) -> Camera:
    """Read where the camera of those intrinsics stood.

    Raises
    ------
    InvalidRequest
        If a number of the pose is not finite or its quaternion not of unit length.
    """
    x, y, z, w = QUAT_BODY_FROM_OPTICAL
    pose = pose_from_msg(msg.camera_pose).turned((-x, -y, -z, w))
    return Camera(intrinsics=intrinsics, pose=pose)
