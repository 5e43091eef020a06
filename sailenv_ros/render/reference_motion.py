"""What the kernels of motion compute, in plain NumPy: their definition; see `reference_kernels`.

A surface point at X = Z (x, y, 1) of one camera's optical frame is at X + D X (D = T - 1,
homogeneous) in another one's, so it has moved in the picture by

    (f' - f) x + (cx' - cx) + f' (dX - x dZ) / (Z + dZ),   (dX, dY, dZ) = D X

and the same in y: exactly 0 where the lenses are equal and D is 0. Points at infinity have
X = (x, y, 1) without translation.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.motion_kernels import MovedPoints

__all__ = ["move_points", "transform_points"]

ROUNDING_PX = 1e-3
"""How far from a pixel's centre that pixel alone decides whether a point is hidden."""

Doubles = NDArray[np.float64]


def move_points(
    depth: NDArray[np.float32],
    instance: NDArray[np.uint16],
    row_of_instance: NDArray[np.uint16],
    motions: Doubles,
    displacements: Doubles,
    from_lens: Doubles,
    to_lens: Doubles,
    to_depth: NDArray[np.float32],
    to_instance: NDArray[np.uint16],
    tolerance: float,
    *,
    threads: int,
) -> MovedPoints:
    """Find where the points of one picture are in another; see `native.motion_kernels`."""
    height, width = depth.shape
    focal, cx, cy, _, _ = from_lens
    to_focal, to_cx, to_cy, _, to_far_m = to_lens
    u, v = np.arange(width, dtype=np.float64)[None], np.arange(height, dtype=np.float64)[:, None]
    x, y = (u - cx) / focal, (v - cy) / focal
    z = depth.astype(np.float64)
    rows = row_of_instance[instance]
    rows[rows >= len(motions)] = 0
    at_infinity = z == np.inf
    known = (rows != 0) & ~np.isnan(z)
    reach, shift = np.where(at_infinity, 1.0, z), np.where(at_infinity, 0.0, 1.0)
    with np.errstate(all="ignore"):
        d = _applied(motions[rows], x, y, reach, shift)
        z_to = reach + d[2]
        valid = known & (z_to > 0.0)
        moved_u = (to_focal - focal) * x + (to_cx - cx) + to_focal * ((d[0] - x * d[2]) / z_to)
        moved_v = (to_focal - focal) * y + (to_cy - cy) + to_focal * ((d[1] - y * d[2]) / z_to)
        z_to[at_infinity] = np.inf
        there_u, there_v = u + moved_u, v + moved_v
        inside = valid & (there_u >= -0.5) & (there_u <= to_depth.shape[1] - 0.5)
        inside &= (there_v >= -0.5) & (there_v <= to_depth.shape[0] - 0.5)
        inside &= (z_to <= to_far_m) | (z_to == np.inf)
        scene = _applied(displacements[rows], x, y, reach, np.ones_like(shift))
        return MovedPoints(
            flow=_where(valid, [moved_u, moved_v]),
            scene_flow=_where(known & ~at_infinity, scene),
            valid=valid,
            occluded=inside
            & ~_seen(to_depth, to_instance, there_u, there_v, z_to, instance, to_lens, tolerance),
            out_of_view=known & ~inside,
        )


def transform_points(
    depth: NDArray[np.float32],
    instance: NDArray[np.uint16],
    row_of_instance: NDArray[np.uint16],
    transforms: Doubles,
    lens: Doubles,
    *,
    threads: int,
) -> NDArray[np.float32]:
    """Return each pixel's surface point in other axes; see `native.motion_kernels`."""
    height, width = depth.shape
    focal, cx, cy, _, _ = lens
    u, v = np.arange(width, dtype=np.float64)[None], np.arange(height, dtype=np.float64)[:, None]
    z = depth.astype(np.float64)
    rows = row_of_instance[instance]
    rows[rows >= len(transforms)] = 0
    with np.errstate(all="ignore"):
        places = _applied(transforms[rows], (u - cx) / focal, (v - cy) / focal, z, np.ones_like(z))
        return _where((rows != 0) & np.isfinite(z), places)


def _applied(
    matrices: Doubles, x: Doubles, y: Doubles, reach: Doubles, shift: Doubles
) -> list[Doubles]:
    """Apply (H, W, 3, 4) matrices to points reach · (x, y, 1) with the homogeneous part shift."""
    return [
        reach * (m[..., 0] * x + m[..., 1] * y + m[..., 2]) + shift * m[..., 3]
        for m in np.moveaxis(matrices, 2, 0)
    ]


def _where(known: NDArray[np.bool_], values: list[Doubles]) -> NDArray[np.float32]:
    unknown = np.float32(np.nan)
    return np.stack([np.where(known, value.astype(np.float32), unknown) for value in values], -1)


def _seen(
    to_depth: NDArray[np.float32],
    to_instance: NDArray[np.uint16],
    u: Doubles,
    v: Doubles,
    z: Doubles,
    ids: NDArray[np.uint16],
    to_lens: Doubles,
    tolerance: float,
) -> NDArray[np.bool_]:
    """Find which points of instances at (u, v), depth z, the other picture shows.

    One of the four pixels around must be of the same instance and not nearer than the point by
    more than the tolerance; where its depth is not known, the point must be as near.
    """
    rows, columns = to_depth.shape
    seen = np.zeros(z.shape, np.bool_)
    for row in (np.floor(v + ROUNDING_PX), np.ceil(v - ROUNDING_PX)):
        for column in (np.floor(u + ROUNDING_PX), np.ceil(u - ROUNDING_PX)):
            # What is no number lies nowhere, and is not asked for.
            at = tuple(
                np.clip(np.nan_to_num(place), 0, size - 1).astype(np.intp)
                for place, size in ((row, rows), (column, columns))
            )
            there = to_depth[at].astype(np.float64)
            shows = (there == z) | (there > z * (1.0 - tolerance))
            shows |= np.isnan(there) & (z < to_lens[3] * (1.0 + tolerance))
            seen |= shows & (to_instance[at] == ids)
    return seen
