"""Results of the motion kernels, in plain NumPy: the definition; see `reference_kernels`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["move_points", "transform_points"]

ROUNDING_PX = 1e-3
"""Greatest distance from a pixel's centre at which that pixel alone decides on occlusion [px]."""

Doubles = NDArray[np.float64]


def move_points(
    depth: NDArray[np.float32],
    instance: NDArray[np.uint16],
    row_of_instance: NDArray[np.uint16],
    motions: Doubles,
    displacements: Doubles | None,
    from_lens: NDArray[np.void],
    to_lens: NDArray[np.void],
    to_depth: NDArray[np.float32] | None,
    to_instance: NDArray[np.uint16] | None,
    tolerance: float,
    outputs: Mapping[str, NDArray[Any]],
    *,
    duration_s: float = 1.0,
    threads: int,
) -> None:
    """Find where the points of one picture are in another; see `native.motion_kernels`."""
    height, width = depth.shape
    focal, _, cx, cy, _, _ = from_lens[0].item()
    to_focal, _, to_cx, to_cy, _, to_far_m = to_lens[0].item()
    u, v = np.arange(width, dtype=np.float64)[None], np.arange(height, dtype=np.float64)[:, None]
    x, y = (u - cx) / focal, (v - cy) / focal
    z = depth.astype(np.float64)
    rows = row_of_instance[instance]
    rows[rows >= len(motions)] = 0
    at_infinity = z == np.inf
    known = (rows != 0) & ~np.isnan(z)
    reach, shift = np.where(at_infinity, 1.0, z), np.where(at_infinity, 0.0, 1.0)
    found = {}
    with np.errstate(all="ignore"):
        d = _applied(motions[rows], x, y, reach, shift)
        z_to = reach + d[2]
        valid = known & (z_to > 0.0)
        back_x, back_y = (x * d[2] - d[0]) / z_to, (y * d[2] - d[1]) / z_to
        right = (to_focal - focal) * x + (to_cx - cx)
        down = (to_focal - focal) * y + (to_cy - cy)
        rate, per = 1.0 / duration_s, to_focal / duration_s
        found["flow"] = _where(valid, [rate * right - per * back_x, rate * down - per * back_y])
        z_to[at_infinity] = np.inf
        there_u, there_v = u + (right - to_focal * back_x), v + (down - to_focal * back_y)
        size = (0, 0) if to_depth is None else to_depth.shape
        inside = valid & (there_u >= -0.5) & (there_u <= size[1] - 0.5)
        inside &= (there_v >= -0.5) & (there_v <= size[0] - 0.5)
        if to_instance is not None:
            inside &= (z_to <= to_far_m) | (z_to == np.inf)
        seen = np.zeros_like(inside)
        if to_depth is not None:
            seen = inside & _seen(
                to_depth, to_instance, there_u, there_v, z_to, instance, to_lens, tolerance
            )
        if displacements is not None:
            scene = _applied(displacements[rows], x, y, reach, np.ones_like(shift))
            found["scene_flow"] = _where(known & ~at_infinity, scene)
    found |= {
        "valid": valid,
        "occluded": inside & ~seen,
        "out_of_view": known & ~inside,
        "hidden": ~seen,
    }
    for name, array in outputs.items():
        array[:] = found[name]


def transform_points(
    depth: NDArray[np.float32],
    instance: NDArray[np.uint16],
    row_of_instance: NDArray[np.uint16],
    transforms: Doubles,
    lens: NDArray[np.void],
    *,
    threads: int,
) -> NDArray[np.float32]:
    """Return each pixel's surface point in other axes; see `native.motion_kernels`."""
    height, width = depth.shape
    focal, _, cx, cy, _, _ = lens[0].item()
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
    to_instance: NDArray[np.uint16] | None,
    u: Doubles,
    v: Doubles,
    z: Doubles,
    ids: NDArray[np.uint16],
    to_lens: NDArray[np.void],
    tolerance: float,
) -> NDArray[np.bool_]:
    """Find which points of instances at (u, v), depth z, the other picture shows.

    One of the four pixels around must be of the same instance and not nearer than the point by
    more than the tolerance; where its depth is not known, the point must be as near. Without
    instances a pixel's depth must be known.
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
            if to_instance is not None:
                shows |= np.isnan(there) & (z < to_lens["near_m"] * (1.0 + tolerance))
                shows &= to_instance[at] == ids
            seen |= shows
    return seen
