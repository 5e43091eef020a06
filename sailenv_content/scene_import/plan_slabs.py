"""Floors and ceilings of drawn rooms: outlines become slabs with a thickness.

Outlines (N, 2) in the world [m] in, meshes and convex pieces out.
"""

from __future__ import annotations

from collections.abc import Sequence

import mapbox_earcut
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.types.model import ConvexShape

__all__ = ["inside", "slab"]

Doubles = NDArray[np.float64]


def slab(outline: Doubles, low_m: float, high_m: float) -> tuple[RawMesh, tuple[ConvexShape, ...]]:
    """Return the prism over an outline between two heights, with u, v = x, y [m].

    Parameters
    ----------
    outline : (N, 2) float64
        Either way round; N at least 3.
    low_m, high_m : float

    Returns
    -------
    mesh : RawMesh
        No triangles where the outline has no area.
    hulls : tuple of ConvexShape
        One of a convex outline, else one for each triangle.
    """
    if _area(outline) < 0.0:
        outline = outline[::-1]
    ends = np.array([len(outline)], np.uint32)
    cut = mapbox_earcut.triangulate_float64(np.ascontiguousarray(outline), ends)
    flat = np.asarray(cut, np.int64).reshape(-1, 3)
    count = len(outline)
    low, high = (_at(outline, z) for z in (low_m, high_m))
    areas = [_area(outline[t]) for t in flat]
    flat = np.array([t if a > 0.0 else t[::-1] for t, a in zip(flat, areas, strict=True)], np.int64)
    flat = flat.reshape(-1, 3)
    around = np.arange(count)
    after = np.roll(around, -1)
    # The sides have corners of their own, because their edges are sharp.
    side = np.concatenate([low, high])
    quads = np.concatenate(
        [
            np.column_stack([around, after, after + count]),
            np.column_stack([around, after + count, around + count]),
        ]
    )
    positions = np.concatenate([high, low, side])
    triangles = np.concatenate([flat, flat[:, ::-1] + count, quads + 2 * count])
    mesh = RawMesh(positions=positions, uvs=positions[:, :2].copy(), triangles=triangles)
    pieces: Sequence[Doubles] = [outline] if _is_convex(outline) else [outline[t] for t in flat]
    hulls = [
        ConvexShape(
            points=np.concatenate(
                [np.column_stack([p, np.full(len(p), z)]) for z in (low_m, high_m)]
            )
        )
        for p in pieces
        if abs(_area(p)) > 1e-6
    ]
    return mesh, tuple(hulls)


def inside(outline: Doubles, point: Doubles) -> bool:
    """Return whether a point (2,) lies in an outline."""
    x, y = point
    ax, ay = outline.T
    bx, by = np.roll(outline, -1, axis=0).T
    crosses = (ay > y) != (by > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        at = ax + (y - ay) / (by - ay) * (bx - ax)
    return bool(np.count_nonzero(crosses & (x < at)) % 2)


def _at(outline: Doubles, z: float) -> Doubles:
    return np.column_stack([outline, np.full(len(outline), z)])


def _area(outline: Doubles) -> float:
    x, y = outline.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def _is_convex(outline: Doubles) -> bool:
    ahead = np.roll(outline, -1, axis=0) - outline
    later = np.roll(ahead, -1, axis=0)
    return bool((ahead[:, 0] * later[:, 1] - ahead[:, 1] * later[:, 0] >= -1e-9).all())
