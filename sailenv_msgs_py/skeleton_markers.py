"""A frame's people and animals as `visualization_msgs` markers: bones, and keypoints of people."""

from __future__ import annotations

import numpy as np
from geometry_msgs.msg import Pose, Quaternion
from numpy.typing import NDArray
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker, MarkerArray

from sailenv_msgs_py.frame_info import WORLD_FRAME_ID
from sailenv_msgs_py.space_msgs import points_to_msg
from sailenv_msgs_py.transforms import vector_to_msg
from sailenv_ros.frame.frame import Frame
from sailenv_ros.types.skeleton import Skeleton

__all__ = ["skeleton_markers_to_msg"]

Doubles = NDArray[np.float64]

BONE_M, KEYPOINT_M = 0.015, 0.04
"""Width of lines and spheres [m]."""

BONE = (0.2, 0.6, 1.0)
SEEN, HIDDEN = (0.1, 0.9, 0.2), (0.9, 0.2, 0.1)
"""Colours: of bones, of keypoints that the camera sees, and of others."""


def skeleton_markers_to_msg(frame: Frame, header: Header) -> MarkerArray:
    """Make a `MarkerArray` in the world frame; each replaces those before.

    Lines of the namespace ``bones`` join each joint with its parent; spheres of the namespace
    ``keypoints`` are green where the camera sees them, red where they are hidden or out of view.
    Ids are those of the instances. The views depth and instance must be there.
    """
    world = Header(stamp=header.stamp, frame_id=WORLD_FRAME_ID)
    markers = [Marker(header=world, action=Marker.DELETEALL)]
    skeletons = {} if frame.states is None else frame.states.skeletons
    for id_, skeleton in skeletons.items():
        bones = _marker(world, "bones", id_, Marker.LINE_LIST, BONE_M, _bones(skeleton))
        bones.color = _colour(BONE)
        markers.append(bones)
        if not skeleton.point_names:
            continue
        found = frame.keypoints(id_)
        points = _marker(world, "keypoints", id_, Marker.SPHERE_LIST, KEYPOINT_M, found.world)
        points.colors = [_colour(SEEN if seen else HIDDEN) for seen in found.visible.tolist()]
        markers.append(points)
    return MarkerArray(markers=markers)


def _bones(skeleton: Skeleton) -> Doubles:
    """Return (2 K, 3): begin and end of each bone."""
    child = np.flatnonzero(skeleton.parents >= 0)
    ends = np.stack([skeleton.joints[skeleton.parents[child]], skeleton.joints[child]], axis=1)
    return ends.reshape(-1, 3)


def _marker(
    header: Header, namespace: str, id_: int, kind: int, size_m: float, points: Doubles
) -> Marker:
    return Marker(
        header=header,
        ns=namespace,
        id=int(id_),
        type=kind,
        action=Marker.ADD,
        pose=Pose(orientation=Quaternion(w=1.0)),
        scale=vector_to_msg((size_m, size_m, size_m)),
        points=points_to_msg(points),
    )


def _colour(rgb: tuple[float, float, float]) -> ColorRGBA:
    r, g, b = rgb
    return ColorRGBA(r=r, g=g, b=b, a=1.0)
