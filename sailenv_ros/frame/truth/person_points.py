"""Keypoints and joints of who has a skeleton: where they are in a frame, what hides them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.data import FrameData
from sailenv_ros.frame.lens_rays import reach_of, reach_of_points
from sailenv_ros.frame.truth.object_table import Keypoints
from sailenv_ros.types.skeleton import Skeleton

__all__ = ["FLESH_M", "own_ids", "person_points", "skeleton_of"]

FLESH_M = 0.2
"""How far below the skin a joint may lie that counts as seen [m]; what hides it is farther off."""

_FLESH = 0.125
"""That of an animal, over the length of its skeleton."""


def skeleton_of(frame: FrameData, instance_id: int) -> Skeleton:
    """Return the skeleton of an instance.

    Raises
    ------
    InvalidRequest
        If it has none, or the frame's states lack it.
    """
    found = {} if frame.states is None else frame.states.skeletons
    if instance_id not in found:
        accepted = f"that of a person or an animal: {sorted(found)}"
        raise InvalidRequest("instance id", instance_id, accepted)
    return found[instance_id]


def own_ids(frame: FrameData, instance_id: int) -> NDArray[np.uint16]:
    """Return the ids of an instance and of its parts."""
    parts = () if frame.info is None else frame.info.instances
    return np.array(
        [instance_id, *(one.id for one in parts if one.parent == instance_id and one.is_part)],
        np.uint16,
    )


def person_points(
    frame: FrameData,
    instance_id: int,
    names: tuple[str, ...],
    world: NDArray[np.float64],
) -> Keypoints:
    """Return points of a person or an animal, its keypoints or joints, as a frame sees them.

    A point is seen where the picture shows its owner at its pixel, with the point no deeper than
    flesh is, or what lies behind the owner.

    Parameters
    ----------
    names : (K,) tuple of str
    world : (K, 3) float64
        World frame [m].
    """
    flesh_m = _flesh_m(skeleton_of(frame, instance_id))
    lens, camera = frame.camera.intrinsics, frame.camera.camera_from_world
    optical = world @ camera[:3, :3].T + camera[:3, 3]
    pixels = lens.project(optical)
    depths = reach_of_points(optical, lens)
    hidden_by = np.full(len(world), -1, np.int64)
    view = reach_of(frame.views, lens)
    with np.errstate(invalid="ignore"):
        u, v = np.rint(pixels[:, 0]), np.rint(pixels[:, 1])
        inside = (u >= 0) & (u < lens.width) & (v >= 0) & (v < lens.height)
        inside &= (depths >= lens.near_m) & (depths <= lens.far_m)
    visible = np.zeros(len(world), np.bool_)
    if view is not None and "instance" in frame.views:
        columns, rows = u[inside].astype(np.intp), v[inside].astype(np.intp)
        shown = frame["instance"][rows, columns].astype(np.int64)
        before = view[rows, columns].astype(np.float64)
        is_own = np.isin(shown, own_ids(frame, instance_id))
        flesh = np.where(is_own, flesh_m, 0.01 * depths[inside])
        seen = before >= depths[inside] - flesh
        visible[inside] = seen
        hidden_by[inside] = np.where(seen, 0, shown)
    return Keypoints(names=names, world=world, pixels=pixels, visible=visible, hidden_by=hidden_by)


def _flesh_m(skeleton: Skeleton) -> float:
    """Return `FLESH_M`, or less for an animal, which has no keypoints of people [m]."""
    if skeleton.point_names:
        return FLESH_M
    return min(FLESH_M, _FLESH * float(np.ptp(skeleton.joints, axis=0).max()))
