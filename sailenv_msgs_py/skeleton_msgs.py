"""Converts the skeletons of people to `sailenv_msgs/Skeleton`, and back."""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Mapping

import numpy as np

from sailenv_msgs.msg import Skeleton as SkeletonMsg
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.skeleton import Skeleton

__all__ = ["skeletons_from_msgs", "skeletons_to_msgs"]


def skeletons_to_msgs(skeletons: Mapping[int, Skeleton]) -> list[SkeletonMsg]:
    """Make the messages of skeletons, which are given by the ids of their instances."""
    return [
        SkeletonMsg(
            id=id_,
            joint_names=list(one.joint_names),
            parents=array("i", one.parents.astype(np.int32).tobytes()),
            joint_poses=array("d", one.world_from_joint.tobytes()),
            point_names=list(one.point_names),
            points=array("d", one.points.tobytes()),
        )
        for id_, one in skeletons.items()
    ]


def skeletons_from_msgs(messages: Iterable[SkeletonMsg]) -> dict[int, Skeleton]:
    """Read skeletons, by the ids of their instances.

    Raises
    ------
    InvalidRequest
        If the arrays of one do not fit each other, or hold what no skeleton can have.
    """
    found = {}
    for told in messages:
        poses = np.array(told.joint_poses, np.float64)
        points = np.array(told.points, np.float64)
        if poses.size % 12 or points.size % 3:
            size = f"{poses.size} and {points.size} numbers"
            raise InvalidRequest("skeleton", size, "12 for each joint, 3 for each point")
        found[int(told.id)] = Skeleton(
            joint_names=tuple(told.joint_names),
            parents=np.array(told.parents, np.int64),
            world_from_joint=poses.reshape(-1, 3, 4),
            point_names=tuple(told.point_names),
            points=points.reshape(-1, 3),
        )
    return found
