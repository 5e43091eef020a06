"""How rigid instances move from one instant to another, as a camera sees it: tables for kernels.

A surface point at X in the optical frame of the camera c at one instant belongs to an instance of
pose W (world_from_instance). At another instant, with camera c' and pose W', it is at

    T X,    T = camera'_from_world  W'  W⁻¹  world_from_camera

in that camera's optical frame, and has been displaced in the world by W' W⁻¹ - 1. Tables hold
D = T - 1 and the displacement in the axes of c, so that both are exactly 0 where nothing moves.
Motion between any two frames and the flow of each frame, which is its motion to the one before,
come of these tables and one kernel (`native.motion_kernels.move_points`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.lens_rays import tells_depth, unit_ray_planes, unit_rays
from sailenv_ros.native.motion_kernels import RowMotions, transform_points
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.deformation import Deformation
from sailenv_ros.types.geometry import invert
from sailenv_ros.types.row_poses import RowPoses

__all__ = [
    "OCCLUSION_TOLERANCE",
    "DeformedInstance",
    "MotionTable",
    "ObservedPoses",
    "camera_points",
    "matched",
    "motion_table",
    "rigid_points",
    "rows_moved",
]

OCCLUSION_TOLERANCE = 0.01
"""Share of its depth by which a point must lie behind all four nearest pixels of the other picture
to count as hidden there: a slanted surface differs by less within one pixel up to about 80 degrees
at common fields of view, and thin gaps smaller than this are not distinguished."""

_SKY_ROW = 1
_FIRST_ROW = 2


class DeformedInstance(NamedTuple):
    """Vertices of an instance at an instant, and the scale of its model."""

    shape: Deformation
    scale: tuple[float, float, float]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ObservedPoses:
    """A camera and the poses of all instances at one instant.

    Attributes
    ----------
    camera : Camera
    ids : (N,) uint16
        Instance ids, each once.
    world_from_instance : (N, 4, 4) float64
        Rigid.
    histories : (N,) int64
        Numbers that change when an instance's past is cut off.
    rows : RowPoses or None
        Of a rolling shutter; the rest is of the instant in its middle.
    surfaces : mapping of int to DeformedInstance
        Of the instances that deform, by their ids.
    """

    camera: Camera
    ids: NDArray[np.uint16]
    world_from_instance: NDArray[np.float64]
    histories: NDArray[np.int64]
    rows: RowPoses | None = None
    surfaces: Mapping[int, DeformedInstance] = field(default_factory=dict)


def matched(
    begin: ObservedPoses, end: ObservedPoses
) -> tuple[NDArray[np.intp], NDArray[np.intp], tuple[int, ...]]:
    """Return the rows of instances of known motion at either instant, and which ids deform.

    They are there at both, with one history; of what deforms both vertices are there.
    """
    _, rows, others = np.intersect1d(begin.ids, end.ids, assume_unique=True, return_indices=True)
    same = begin.histories[rows] == end.histories[others]
    rows, others = rows[same], others[same]
    ids, deforming, known = begin.ids[rows], [], np.ones(len(rows), np.bool_)
    for key in begin.surfaces.keys() | end.surfaces.keys():
        one, other = begin.surfaces.get(key), end.surfaces.get(key)
        if one is None or other is None:
            known[ids == key] = False
        elif one.shape is not other.shape and (ids == key).any():
            deforming.append(key)
    return rows[known], others[known], tuple(sorted(deforming))


@dataclass(frozen=True, eq=False, kw_only=True)
class MotionTable:
    """Arguments of the kernel; computed by `motion_table`.

    Attributes
    ----------
    row_of_instance : (65536,) uint16
        Row of each instance id; 0 for what has no motion. Id 0 is the background's.
    motions : (R, 3, 4) float64
        D of the docstring above.
    by_rows : RowMotions or None
        What counts instead where a shutter rolls.
    deforming_ids : tuple of int
        Instances whose points move besides; see `deforming_motion`.
    """

    row_of_instance: NDArray[np.uint16]
    motions: NDArray[np.float64]
    by_rows: RowMotions | None = None
    deforming_ids: tuple[int, ...] = ()
    _camera: Camera
    _first: NDArray[np.float64]
    _last: NDArray[np.float64]

    @cached_property
    def displacements(self) -> NDArray[np.float64]:
        """(R, 3, 4) float64: displacement in the world, in the axes of the first camera."""
        result = np.zeros_like(self.motions)
        moves = np.flatnonzero((self._first != self._last).any(axis=(1, 2)))
        if len(moves):
            carried = self._last[moves] @ invert(self._first[moves])
            moved = (carried - np.eye(4)) @ self._camera.world_from_camera
            axes = self._camera.camera_from_world[:3, :3]
            result[_FIRST_ROW + moves] = axes @ moved[:, :3]
        return result


def motion_table(begin: ObservedPoses, end: ObservedPoses) -> MotionTable:
    """Compute how what the one instant's camera sees has moved at the other.

    Instances that there are at both, with one history, have a motion; and so has the background, by
    the camera's turn. Where the other's rays are parallel it has none unless the camera rests: a
    direction alone has no place there.
    """
    rows, others, deforming = matched(begin, end)
    row_of_instance = np.zeros(65536, np.uint16)
    row_of_instance[0] = _SKY_ROW
    row_of_instance[begin.ids[rows]] = np.arange(len(rows)) + _FIRST_ROW
    motions = np.zeros((_FIRST_ROW + len(rows), 3, 4))
    first, last = begin.world_from_instance[rows], end.world_from_instance[others]
    world_from_camera = begin.camera.world_from_camera
    to_camera = end.camera.camera_from_world
    camera_is_still = np.array_equal(begin.camera.camera_from_world, to_camera)
    if not camera_is_still and end.camera.intrinsics.is_parallel:
        row_of_instance[0] = 0
    elif not camera_is_still:
        turn = to_camera[:3, :3] @ world_from_camera[:3, :3]
        motions[_SKY_ROW, :, :3] = turn - np.eye(3)
    if len(rows):
        chain = to_camera @ last @ invert(first)
        motion = (chain @ world_from_camera)[:, :3] - np.eye(4)[:3]
        if camera_is_still:
            # Rounding must not make a still world move.
            motion[(first == last).all(axis=(1, 2))] = 0.0
        motions[_FIRST_ROW:] = motion
    return MotionTable(
        row_of_instance=row_of_instance,
        motions=motions,
        deforming_ids=deforming,
        _camera=begin.camera,
        _first=first,
        _last=last,
    )


def rigid_points(
    depth: NDArray[np.float32], instance: NDArray[np.uint16], poses: ObservedPoses, *, threads: int
) -> NDArray[np.float32]:
    """Return each pixel's surface point in its instance's own frame, where it is now.

    Parameters
    ----------
    depth, instance : (H, W) float32, uint16
        The camera's views; of the two that tell it the one that `reach_view` names.
    poses : ObservedPoses
    threads : int

    Returns
    -------
    points : (H, W, 3) float32
        [m]; nan where nothing was hit, or its depth is not known.
    """
    if poses.rows is not None:
        return _object_points_by_rows(depth, instance, poses)
    count = len(poses.ids)
    rows = np.zeros(65536, np.uint16)
    rows[poses.ids] = np.arange(1, count + 1)
    transforms = np.zeros((count + 1, 3, 4))
    if count:
        own_from_camera = invert(poses.world_from_instance) @ poses.camera.world_from_camera
        transforms[1:] = own_from_camera[:, :3]
    lens = poses.camera.intrinsics
    return transform_points(
        depth,
        instance,
        rows,
        transforms,
        lens.lens_record,
        rays=None if tells_depth(lens) else unit_ray_planes(lens),
        parallel=lens.is_parallel,
        threads=threads,
    )


def _object_points_by_rows(
    depth: NDArray[np.float32], instance: NDArray[np.uint16], poses: ObservedPoses
) -> NDArray[np.float32]:
    """Return the same where each row has poses of its own."""
    assert poses.rows is not None
    points = camera_points(depth, poses.camera.intrinsics)
    points = rows_moved(poses.rows.world_from_camera, points)
    found = np.full(points.shape, np.nan, np.float32)
    seen = np.isfinite(depth)
    _, known, _ = np.intersect1d(poses.ids, instance[seen], return_indices=True)
    for id_, world_from_instance in zip(
        poses.ids[known], poses.world_from_instance[known], strict=True
    ):
        v, u = np.nonzero(seen & (instance == id_))
        to_own = invert(poses.rows.of_instance(int(id_), world_from_instance)[v])
        found[v, u] = np.einsum("nij,nj->ni", to_own[:, :3, :3], points[v, u]) + to_own[:, :3, 3]
    return found


def camera_points(reach: NDArray[np.float32], lens: CameraIntrinsics) -> NDArray[np.float64]:
    """Return (H, W, 3) float64: points of the optical frame, from depths, or ranges, of pixels."""
    rays = lens.rays() if tells_depth(lens) else unit_rays(lens)
    with np.errstate(invalid="ignore"):
        points: NDArray[np.float64] = rays * reach[..., None].astype(np.float64)
    if lens.is_parallel:
        points[..., :2] = rays[..., :2]
    return points


def rows_moved(poses: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (H, W, 3) points, those of each row moved by a pose (H, 4, 4) of its own."""
    with np.errstate(invalid="ignore"):
        moved: NDArray[np.float64] = (
            np.einsum("hij,hwj->hwi", poses[:, :3, :3], points) + poses[:, None, :3, 3]
        )
    return moved
