"""Converts a frame, apart from its images, to `sailenv_msgs/FrameInfo`, and makes its headers."""

from __future__ import annotations

import json
import math
from array import array
from collections.abc import Iterable
from typing import Any

import numpy as np
from std_msgs.msg import Header

from sailenv_msgs.msg import FrameInfo
from sailenv_msgs.msg import RowPoses as RowPosesMsg
from sailenv_msgs_py.skeleton_msgs import skeletons_from_msgs, skeletons_to_msgs
from sailenv_msgs_py.stamps import stamp_from_ns
from sailenv_msgs_py.transforms import optical_pose_to_msg, pose_from_msg
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import QUAT_BODY_FROM_OPTICAL
from sailenv_ros.types.instance_states import InstanceStates
from sailenv_ros.types.lessons import LessonState
from sailenv_ros.types.row_poses import RowPoses

__all__ = [
    "WORLD_FRAME_ID",
    "camera_of_frame_info",
    "frame_info_to_msg",
    "header_of_frame",
    "lesson_of_frame_info",
    "optical_frame_id",
    "randomised_of_frame_info",
    "row_poses_of_frame_info",
    "states_of_frame_info",
]

_NUMBERS = 16
"""Number of values of each instance in `FrameInfo.instance_states`."""

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
        has_states=frame.states is not None,
        randomised="" if frame.randomised is None else json.dumps(frame.randomised),
        exposure=float(frame.exposure),
        lesson="" if frame.lesson is None else frame.lesson.to_json(),
        **_states_fields(frame.states),
        row_poses=[] if frame.row_poses is None else [_row_poses_to_msg(frame.row_poses)],
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
    return Camera(intrinsics=intrinsics, pose=pose, name=msg.agent)


def randomised_of_frame_info(msg: FrameInfo) -> dict[str, Any] | None:
    """Read the record of what was drawn at random; None if nothing was.

    Raises
    ------
    InvalidRequest
        If it is no JSON object.
    """
    if not msg.randomised:
        return None
    try:
        record = json.loads(msg.randomised)
    except (ValueError, RecursionError):
        record = None
    if not isinstance(record, dict):
        raise InvalidRequest("randomised", msg.randomised[:100], "a JSON object")
    return record


def lesson_of_frame_info(msg: FrameInfo) -> LessonState | None:
    """Read which lesson a frame is of; None if there were no lessons.

    Raises
    ------
    InvalidRequest
        If it is no such text.
    """
    return LessonState.from_json(msg.lesson) if msg.lesson else None


def states_of_frame_info(msg: FrameInfo) -> InstanceStates | None:
    """Read where the instances were and how they moved; None if the message does not tell.

    Raises
    ------
    InvalidRequest
        If the arrays do not fit each other or hold what no state can be.
    """
    if not msg.has_states:
        return None
    flat = np.asarray(msg.instance_states, np.float64)
    if flat.size % _NUMBERS:
        accepted = f"{_NUMBERS} an instance"
        raise InvalidRequest("instance_states", f"{flat.size} numbers", accepted)
    rows = flat.reshape(-1, _NUMBERS)
    return InstanceStates(
        ids=np.asarray(msg.instance_ids, np.uint16),
        positions=rows[:, :3],
        orientations=rows[:, 3:7],
        linear_velocities=rows[:, 7:10],
        angular_velocities=rows[:, 10:13],
        scales=rows[:, 13:],
        histories=np.asarray(msg.instance_histories, np.int64),
        skeletons=skeletons_from_msgs(msg.skeletons),
    )


def row_poses_of_frame_info(msg: FrameInfo) -> RowPoses | None:
    """Read the poses by rows of a rolling shutter; None if all rows saw one instant.

    Raises
    ------
    InvalidRequest
        If the arrays do not fit each other or hold what no pose can be.
    """
    if not msg.row_poses:
        return None
    told = msg.row_poses[0]
    times_ns = np.array(told.times_ns, np.int64)
    ids = np.array(told.instance_ids, np.uint16)
    numbers = np.asarray(told.poses, np.float64)
    shape = (len(times_ns), 1 + len(ids), 3, 4)
    if not len(times_ns) or numbers.size != math.prod(shape):
        accepted = f"12 for each of {shape[1]} poses of each of {shape[0]} rows"
        raise InvalidRequest("row_poses", f"{numbers.size} numbers", accepted)
    if not np.isfinite(numbers).all():
        raise InvalidRequest("row_poses", "a number that is not finite", "finite numbers")
    matrices = np.zeros((*shape[:2], 4, 4))
    matrices[:, :, :3] = numbers.reshape(shape)
    matrices[:, :, 3, 3] = 1.0
    return RowPoses(
        times_ns=times_ns,
        world_from_camera=matrices[:, 0].copy(),
        ids=ids,
        world_from_instance=matrices[:, 1:].copy(),
    )


def _row_poses_to_msg(rows: RowPoses) -> RowPosesMsg:
    """Make the message; arrays of Python are taken without a look at each number."""
    poses = np.concatenate([rows.world_from_camera[:, None], rows.world_from_instance], axis=1)
    return RowPosesMsg(
        times_ns=array("q", rows.times_ns.tobytes()),
        poses=array("d", np.ascontiguousarray(poses[:, :, :3]).tobytes()),
        instance_ids=array("H", rows.ids.tobytes()),
    )


def _states_fields(states: InstanceStates | None) -> dict[str, Any]:
    """Return the fields of the message; arrays of Python are taken without a look at each."""
    if states is None:
        return {}
    columns = (
        *(states.positions, states.orientations),
        *(states.linear_velocities, states.angular_velocities, states.scales),
    )
    return {
        "instance_ids": array("H", states.ids.tobytes()),
        "instance_histories": array("I", states.histories.astype(np.uint32).tobytes()),
        "instance_states": array("d", np.concatenate(columns, axis=1).tobytes()),
        "skeletons": skeletons_to_msgs(states.skeletons),
    }
