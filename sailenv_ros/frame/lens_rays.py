"""The rays of lenses that bend straight lines, computed once: directions of pixels' centres.

A lens comes in; unit rays go out, and what ground truth makes of them. Through a pin-hole, and
where rays are parallel, points are told by their depth; through other lenses by their distance
along the ray, for these may see to the side and behind.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.lens_models import MOST_COEFFICIENTS
from sailenv_ros.native.motion_kernels import BentLenses
from sailenv_ros.system.memory import cached_for_scenes
from sailenv_ros.types.camera import CameraIntrinsics

__all__ = [
    "bent_lenses",
    "depth_shares",
    "fine_sample_places",
    "ranges_of_depths",
    "ray_lengths",
    "rays_of_fine_samples",
    "reach_lines",
    "reach_of",
    "reach_of_points",
    "reach_view",
    "tells_depth",
    "unit_ray_planes",
    "unit_rays",
]

SAMPLE_SHIFT_PX = 0.25
"""By how much the native renderer's fine samples in even rows and columns lie beside a grid; as in
``native/src/kernels/raster.h``, which says why [px]."""

_NODES = np.arange(-2.0, 4.0)
"""Of Lagrange's polynomials, around a place between 0 and 1; the middle four for those of four."""

_LEAST_SURE = 1e-7
"""By how much the polynomials may differ: 1e-4 px at a focal length of 1000 px."""

_NO_COEFFICIENTS = np.zeros(MOST_COEFFICIENTS)


def tells_depth(lens: CameraIntrinsics) -> bool:
    """Return whether depths along the axis tell where on their rays points are."""
    return lens.is_pinhole or lens.is_parallel


def reach_view(lens: CameraIntrinsics) -> str:
    """Return the view that tells where on its ray a point is: ``depth`` or ``range``."""
    return "depth" if tells_depth(lens) else "range"


def reach_of_points(points: NDArray[np.float64], lens: CameraIntrinsics) -> NDArray[np.float64]:
    """Return what `reach_view` would tell of points (..., 3) of the optical frame [m]."""
    return points[..., 2] if tells_depth(lens) else np.linalg.norm(points, axis=-1)


def reach_lines(
    lens: CameraIntrinsics, pixels: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return where rays begin and lead to: after t of the latter `reach_view` tells t.

    Parameters
    ----------
    lens : CameraIntrinsics
    pixels : (..., 2) float64
        Columns and rows [px].

    Returns
    -------
    origins, directions : (..., 3) float64
        In the optical frame [m]; nan where the lens sees nothing.
    """
    if tells_depth(lens):
        return lens.sight_lines(pixels)
    directions = lens.unit_rays_through(pixels)
    return np.zeros_like(directions), directions


@cached_for_scenes(8)
def unit_ray_planes(lens: CameraIntrinsics) -> NDArray[np.float64]:
    """Return (3, H, W) float64 read-only: x, y, z of `unit_rays`, as kernels read them."""
    planes = np.ascontiguousarray(np.moveaxis(lens.unit_rays(), -1, 0))
    planes.flags.writeable = False
    return planes


@cached_for_scenes(8)
def _single_ray_planes(lens: CameraIntrinsics) -> NDArray[np.float32]:
    """Return `unit_ray_planes` as float32: half the memory to read, off by 3e-8 rad."""
    planes = unit_ray_planes(lens).astype(np.float32)
    planes.flags.writeable = False
    return planes


def unit_rays(lens: CameraIntrinsics) -> NDArray[np.float64]:
    """Return (H, W, 3) float64 read-only: where each pixel's centre looks, in the optical frame.

    nan where the lens sees nothing.
    """
    return np.moveaxis(unit_ray_planes(lens), 0, -1)


@cached_for_scenes(8)
def ray_lengths(lens: CameraIntrinsics) -> NDArray[np.float64]:
    """Return (H, W) float64 read-only: how long rays are to where they are 1 m deep [m].

    nan where the lens does not see that deep.
    """
    lengths: NDArray[np.float64] = np.linalg.norm(lens.rays(), axis=-1)
    lengths.flags.writeable = False
    return lengths


def fine_sample_places(lens: CameraIntrinsics) -> NDArray[np.float64]:
    """Return (2 H + 1, 2 W + 1, 2) float64: where fine samples lie in the picture [px].

    Half a pixel apart, those of odd numbers in the pixels' centres; but those in even rows lie
    `SAMPLE_SHIFT_PX` to the right of that, those in even columns below.
    """
    rows, columns = np.indices((2 * lens.height + 1, 2 * lens.width + 1))
    x = 0.5 * (columns - 1) + SAMPLE_SHIFT_PX * (rows % 2 == 0)
    y = 0.5 * (rows - 1) + SAMPLE_SHIFT_PX * (columns % 2 == 0)
    return np.stack([x, y], axis=-1)


def rays_of_fine_samples(lens: CameraIntrinsics) -> NDArray[np.float64]:
    """Return (2 H + 1, 2 W + 1, 3) float64: where fine samples look; a new array.

    Those of odd numbers are the pixels' centres. The others lie between the rays of six pixels in a
    line, by the polynomial through these; where one through four is not as good, or the lens does
    not see all of them, the lens is asked. nan where it sees nothing.
    """
    height, width, side = lens.height, lens.width, len(_NODES) // 2
    around = np.empty((height + 2 * side, width + 2 * side, 3))
    around[side:-side, side:-side] = unit_rays(lens)
    rows, columns = np.indices(around.shape[:2]) - side
    ring = (rows < 0) | (rows >= height) | (columns < 0) | (columns >= width)
    around[ring] = lens.unit_rays_through(np.stack([columns[ring], rows[ring]], axis=-1))
    rays = np.empty((2 * height + 1, 2 * width + 1, 3))
    known = np.ones(rays.shape[:2], np.bool_)
    rays[1::2, 1::2] = around[side:-side, side:-side]
    half, shift = 0.5, SAMPLE_SHIFT_PX
    for row, column, down, across in (
        (1, 0, shift, half),
        (0, 1, half, shift),
        (0, 0, half + shift, half + shift),
    ):
        # The first places lie behind what stands before the first pixels.
        wide, sure_across = _between(around, 1, across)
        found, sure = _between(wide[:, column:], 0, down)
        for first in range(len(_NODES)):
            sure &= sure_across[first : first + len(sure), column:]
        rays[row::2, column::2], known[row::2, column::2] = found[row:], sure[row:]
    rays[~known] = lens.unit_rays_through(fine_sample_places(lens)[~known])
    return rays


def _between(
    rays: NDArray[np.float64], axis: int, share: float
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return rays at a share of the way to the next neighbour along an axis, and which are good.

    Of N neighbours in a line there are N - 5 places: from between the third and the fourth on.
    """
    six, four = _lagrange(_NODES, share), np.zeros(len(_NODES))
    four[1:-1] = _lagrange(_NODES[1:-1], share)
    count = rays.shape[axis] - len(_NODES) + 1
    parts = [rays[(slice(None),) * axis + (slice(k, k + count),)] for k in range(len(_NODES))]
    found = sum(weight * part for weight, part in zip(six, parts, strict=True))
    off = sum(weight * part for weight, part in zip(six - four, parts, strict=True))
    return np.asarray(found), (np.abs(off) <= _LEAST_SURE).all(axis=-1)


def _lagrange(nodes: NDArray[np.float64], place: float) -> NDArray[np.float64]:
    """Return the weights of nodes in Lagrange's polynomial at a place."""
    apart = nodes[:, None] - nodes
    np.fill_diagonal(apart, 1.0)
    to_place = np.broadcast_to(place - nodes, apart.shape).copy()
    np.fill_diagonal(to_place, 1.0)
    return np.asarray((to_place / apart).prod(axis=1))


@cached_for_scenes(8)
def depth_shares(lens: CameraIntrinsics) -> NDArray[np.float32]:
    """Return (H, W) float32 read-only: depth along the axis over distance along the ray."""
    shares = unit_rays(lens)[..., 2].astype(np.float32)
    shares.flags.writeable = False
    return shares


def ranges_of_depths(depth: NDArray[np.float32], lens: CameraIntrinsics) -> NDArray[np.float32]:
    """Return (H, W) float32: distances along rays [m] from depths along the axis [m].

    nan where the lens looks to the side or behind, where depths do not tell them.
    """
    shares = unit_rays(lens)[..., 2]
    shares = np.where(shares > 0.0, shares, np.nan)
    return (depth / shares).astype(np.float32)


def reach_of(
    views: Mapping[str, NDArray[Any]], lens: CameraIntrinsics
) -> NDArray[np.float32] | None:
    """Return where on its ray each pixel's point is [m], as `reach_view` says it; None if unknown.

    Of a frame without ``range`` it comes of ``depth``.
    """
    found = views.get(reach_view(lens))
    if found is None and "depth" in views:
        found = ranges_of_depths(views["depth"], lens)
    return found


def bent_lenses(begin: CameraIntrinsics, end: CameraIntrinsics) -> BentLenses | None:
    """Return two lenses as kernels of motion take them; None if both are pin-holes."""
    if begin.is_pinhole and end.is_pinhole:
        return None
    straight = end.is_pinhole
    return BentLenses(
        from_rays=None if tells_depth(begin) else _single_ray_planes(begin),
        from_parallel=begin.is_parallel,
        to_model=-1 if straight else end.law.model.number,
        to_coefficients=_NO_COEFFICIENTS if straight else end.law.padded,
        to_limit_rad=0.0 if straight else end.law.limit_rad,
        same=begin == end,
    )
