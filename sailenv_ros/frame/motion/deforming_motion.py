"""How the points of surfaces that deform have moved besides the motion of their instances.

A pixel's point lies on a triangle, at weights of its corners. At another instant it is at the same
weights of the corners then, and its own coordinates are those weights of the corners at rest. What
is left is the motion of the instance's frame, as that of rigid bodies. Where corners have not
moved, offsets are exactly 0.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.motion.rigid_motion import MotionTable, ObservedPoses, rigid_points
from sailenv_ros.native.motion_kernels import SurfaceMotions
from sailenv_ros.native.surface_kernels import surface_points
from sailenv_ros.rays.opaque_models import surface_between

__all__ = ["object_points", "surface_motions"]


def surface_motions(
    reach: NDArray[np.float32],
    instance: NDArray[np.uint16],
    begin: ObservedPoses,
    end: ObservedPoses,
    table: MotionTable,
    *,
    threads: int,
    places: NDArray[np.void] | None = None,
) -> SurfaceMotions | None:
    """Return the offsets that a kernel of motion adds; None where nothing deforms.

    Parameters
    ----------
    reach, instance : (H, W) float32, uint16
        The first camera's views, as `object_points` takes them.
    begin, end : ObservedPoses
    table : MotionTable
        Of these two.
    threads : int
    places : (H, W) TRIANGLE_PLACE or None
        Where on its triangle each point of what deforms is; None looks for it.
    """
    deforming = table.deforming_ids
    if not deforming:
        return None
    surfaces = [
        surface_between(
            *(key, seen.scale, seen.shape, end.surfaces[key].shape), with_tree=places is None
        )
        for key in deforming
        for seen in (begin.surfaces[key],)
    ]
    offsets = np.empty((*instance.shape, 3), np.float32)
    points = None
    if places is None:
        points = rigid_points(reach, instance, _only(begin, deforming), threads=threads)
    surface_points(
        *(points, instance, surfaces, offsets), relative=True, threads=threads, places=places
    )
    rows = table.row_of_instance[list(deforming)]
    flags = np.zeros(len(table.motions), np.bool_)
    flags[rows] = True
    own = end.world_from_instance[[int(np.flatnonzero(end.ids == key)[0]) for key in deforming]]
    turns, displacement_turns = np.zeros((2, len(flags), 3, 3))
    turns[rows] = end.camera.camera_from_world[:3, :3] @ own[:, :3, :3]
    displacement_turns[rows] = begin.camera.camera_from_world[:3, :3] @ own[:, :3, :3]
    return SurfaceMotions(offsets, flags, turns, displacement_turns)


def object_points(
    reach: NDArray[np.float32],
    instance: NDArray[np.uint16],
    poses: ObservedPoses,
    *,
    threads: int,
    places: NDArray[np.void] | None = None,
) -> NDArray[np.float32]:
    """Return each pixel's surface point in its instance's own frame, of what deforms at rest.

    Parameters
    ----------
    reach, instance : (H, W) float32, uint16
        The camera's views; of the two that tell it the one that `reach_view` names.
    poses : ObservedPoses
    threads : int
    places : (H, W) TRIANGLE_PLACE or None
        As `surface_motions` takes them.

    Returns
    -------
    points : (H, W, 3) float32
        [m]; nan where nothing was hit, or its depth is not known.
    """
    points = rigid_points(reach, instance, poses, threads=threads)
    surfaces = [
        surface_between(*(key, seen.scale, seen.shape, seen.shape.model), with_tree=places is None)
        for key, seen in poses.surfaces.items()
    ]
    if surfaces:
        surface_points(
            *(points, instance, surfaces, points), relative=False, threads=threads, places=places
        )
    return points


def _only(poses: ObservedPoses, ids: Collection[int]) -> ObservedPoses:
    kept = np.isin(poses.ids, list(ids))
    return replace(
        poses,
        ids=poses.ids[kept],
        world_from_instance=poses.world_from_instance[kept],
        histories=poses.histories[kept],
    )
