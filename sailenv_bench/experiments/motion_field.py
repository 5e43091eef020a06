"""The motion field of moving boxes before a moving camera, by rays and rigid-body arithmetic.

Boxes with their poses at two instants in, displacement of each pixel's surface point out; float64
throughout. The judge of every flow here: shares no code with the renderer and sees no picture.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.camera import Camera
from sailenv_ros.types.geometry import Pose

__all__ = ["BoxSolid", "Instant", "MotionField", "motion_field"]

Array = NDArray[np.float64]

SURFACE = 1e-9
"""Share of its distance by which a point may lie within the box whose surface it is on."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BoxSolid:
    """A box in its body's axes.

    Attributes
    ----------
    name : str
    instance_id : int
        Value of its pixels.
    low, high : (3,) tuple of float
        Its opposite corners, scale included [m].
    """

    name: str
    instance_id: int
    low: tuple[float, float, float]
    high: tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Instant:
    """Poses of the camera and the boxes at one instant.

    Attributes
    ----------
    camera : Camera
    poses : sequence of Pose
        Of the boxes, in their order.
    """

    camera: Camera
    poses: Sequence[Pose]


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionField:
    """Analytic ground truth of each pixel.

    Attributes
    ----------
    displacement_px : (H, W, 2) float64
        From the earlier picture to the present pixel, u right, v down [px]; nan where the point
        was not in front of the earlier camera.
    instance : (H, W) int64
        Id of the box that is seen; 0 for none.
    moved_m : (H, W, 3) float64
        From the point's earlier place in the world to its present one, in the axes of the present
        optical frame [m]; nan where nothing is seen.
    leaves : (H, W) bool
        Where the point was not within the earlier picture.
    hidden : (H, W) bool
        Where it was, and a box stood before it.
    """

    displacement_px: Array
    instance: NDArray[np.int64]
    moved_m: Array
    leaves: NDArray[np.bool_]
    hidden: NDArray[np.bool_]


def motion_field(boxes: Sequence[BoxSolid], now: Instant, then: Instant) -> MotionField:
    """Compute where each pixel's surface point came from, or, if `then` is later, goes to.

    A pixel's ray meets the nearest box (Kay and Kajiya's slabs); the point goes into that box's
    axes, with the box to where it was, and is projected by the earlier camera. What meets no box is
    infinitely far away and moves by the camera's turn alone.
    """
    rays = now.camera.intrinsics.rays()
    depth = np.full(rays.shape[:2], np.inf)
    row = np.full(rays.shape[:2], -1)
    for index, (box, pose) in enumerate(zip(boxes, now.poses, strict=True)):
        met = _depth(box, pose, now.camera, rays)
        nearer = met < depth
        depth[nearer], row[nearer] = met[nearer], index
    earlier = np.full((*row.shape, 2), np.nan)
    sky = row < 0
    turn = then.camera.camera_from_world[:3, :3] @ now.camera.world_from_camera[:3, :3]
    earlier[sky] = then.camera.intrinsics.project(rays[sky] @ turn.T)
    moved = np.full(rays.shape, np.nan)
    there = rays @ turn.T
    for index in range(len(boxes)):
        seen = row == index
        point = rays[seen] * depth[seen][:, None]
        there[seen] = _carried(point, index, now, then)
        earlier[seen] = then.camera.intrinsics.project(there[seen])
        moved[seen] = -_displacement(point, index, now, then)
    rows, columns = np.indices(row.shape)
    here = np.stack([columns, rows], axis=-1)
    ids = np.array([*(box.instance_id for box in boxes), 0])
    leaves = ~_within(earlier, there[..., 2], sky, then.camera)
    return MotionField(
        displacement_px=here - earlier,
        instance=ids[row],
        moved_m=moved,
        leaves=leaves,
        hidden=~leaves & _is_hidden(boxes, then, there, sky),
    )


def _within(pixels: Array, depth: Array, sky: NDArray[np.bool_], camera: Camera) -> Any:
    """Return where points at these places and depths lie within a camera's picture."""
    lens = camera.intrinsics
    size = np.array([lens.width, lens.height]) - 0.5
    inside = ((pixels >= -0.5) & (pixels <= size)).all(axis=-1)
    return inside & (depth > 0.0) & (sky | (depth <= lens.far_m))


def _is_hidden(
    boxes: Sequence[BoxSolid], then: Instant, points: Array, sky: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Return where a box stands between a camera and points of its optical frame."""
    with np.errstate(divide="ignore", invalid="ignore"):
        rays = points / points[..., 2:]
    nearest = np.full(sky.shape, np.inf)
    for box, pose in zip(boxes, then.poses, strict=True):
        nearest = np.minimum(nearest, _depth(box, pose, then.camera, rays))
    return nearest < np.where(sky, np.inf, points[..., 2] * (1.0 - SURFACE))


def _depth(box: BoxSolid, pose: Pose, camera: Camera, rays: Array) -> Array:
    """Return (H, W) the depth at which rays enter a box from outside; inf where they do not."""
    matrix = pose.matrix()
    box_from_camera = matrix[:3, :3].T @ camera.world_from_camera[:3, :3]
    eye = matrix[:3, :3].T @ (camera.world_from_camera[:3, 3] - matrix[:3, 3])
    direction = rays @ box_from_camera.T
    with np.errstate(divide="ignore", invalid="ignore"):
        first = (np.asarray(box.low) - eye) / direction
        second = (np.asarray(box.high) - eye) / direction
    enters = np.minimum(first, second).max(axis=-1)
    leaves = np.maximum(first, second).min(axis=-1)
    return np.where((enters <= leaves) & (enters > camera.intrinsics.near_m), enters, np.inf)


def _places(points: Array, index: int, now: Instant, then: Instant) -> tuple[Array, Array]:
    """Return where points (N, 3) of a box, present optical frame, are in the world, and were."""
    world_from_camera = now.camera.world_from_camera
    world = points @ world_from_camera[:3, :3].T + world_from_camera[:3, 3]
    present, past = now.poses[index].matrix(), then.poses[index].matrix()
    body = (world - present[:3, 3]) @ present[:3, :3]
    return world, body @ past[:3, :3].T + past[:3, 3]


def _displacement(points: Array, index: int, now: Instant, then: Instant) -> Array:
    """Return (N, 3) from the present to the other place of points of a box, optical axes [m]."""
    world, other = _places(points, index, now, then)
    moved: Array = (other - world) @ now.camera.world_from_camera[:3, :3]
    return moved


def _carried(points: Array, index: int, now: Instant, then: Instant) -> Array:
    """Carry points (N, 3) of the present optical frame with a box into the earlier one."""
    _, world = _places(points, index, now, then)
    camera_from_world = then.camera.camera_from_world
    return world @ camera_from_world[:3, :3].T + camera_from_world[:3, 3]
