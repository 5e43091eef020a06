"""Reference implementation of the ray kernels in plain NumPy; see `reference_kernels`.

Every ray is held against every triangle, without a tree: right, and slow.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.ray_kernels import RayHits, RayModels, TriangleTree

__all__ = ["build_tree", "cast_rays"]

EDGE = 1e-9
"""Tolerance beside a triangle, in its own coordinates, within which a ray still hits its edge."""

Doubles = NDArray[np.float64]


def build_tree(corners: Doubles) -> TriangleTree:
    """Return one leaf of all triangles."""
    count = len(corners)
    flat = corners.reshape(-1, 3) if count else np.zeros((1, 3))
    bounds = np.concatenate([flat.min(axis=0), flat.max(axis=0)])[None]
    return TriangleTree(bounds, np.array([[0, count]], np.int32), np.arange(count, dtype=np.int32))


def cast_rays(
    models: RayModels,
    model_from_world: Doubles,
    model_of_instance: NDArray[np.int32],
    origins: Doubles,
    directions: Doubles,
    nearest: Doubles,
    *,
    threads: int,
) -> RayHits:
    """Find what rays meet first; see `native.ray_kernels`.

    Of equal distances the lower instance and the lower triangle win.
    """
    rays = len(origins)
    hits = RayHits(
        distance=np.full(rays, np.inf),
        instance=np.full(rays, -1, np.int32),
        triangle=np.full(rays, -1, np.int64),
        weights=np.zeros((rays, 2)),
    )
    for instance, m in enumerate(model_from_world):
        o = [r[0] * origins[:, 0] + r[1] * origins[:, 1] + r[2] * origins[:, 2] + r[3] for r in m]
        d = [r[0] * directions[:, 0] + r[1] * directions[:, 1] + r[2] * directions[:, 2] for r in m]
        model = model_of_instance[instance]
        for triangle in range(models.first_triangle[model], models.first_triangle[model + 1]):
            both = bool(models.two_sided[triangle])
            distance, second, third = _meet(o, d, models.corners[triangle], both)
            met = (distance > nearest) & (distance < hits.distance)
            hits.distance[met] = distance[met]
            hits.instance[met], hits.triangle[met] = instance, triangle
            hits.weights[met] = np.stack([second, third], axis=-1)[met]
    return hits


def _meet(
    o: list[Doubles], d: list[Doubles], corners: Doubles, both: bool
) -> tuple[Doubles, Doubles, Doubles]:
    """Return where rays meet a triangle (nan for not at all), and the weights of its corners.

    T. Möller, B. Trumbore, "Fast, minimum storage ray-triangle intersection", 1997.
    """
    ab, ac = corners[1] - corners[0], corners[2] - corners[0]
    p = _cross(d, list(ac))
    determinant = ab[0] * p[0] + ab[1] * p[1] + ab[2] * p[2]
    ao = [o[axis] - corners[0, axis] for axis in range(3)]
    q = _cross(ao, list(ab))
    with np.errstate(all="ignore"):
        second = (ao[0] * p[0] + ao[1] * p[1] + ao[2] * p[2]) / determinant
        third = (d[0] * q[0] + d[1] * q[1] + d[2] * q[2]) / determinant
        distance = (ac[0] * q[0] + ac[1] * q[1] + ac[2] * q[2]) / determinant
        faces = (determinant != 0.0) if both else determinant > 0.0
        met = faces & (second >= -EDGE) & (second <= 1.0 + EDGE)
        met &= (third >= -EDGE) & (second + third <= 1.0 + EDGE)
    return np.where(met, distance, np.nan), second, third


def _cross(a: list[Doubles], b: list[Doubles]) -> list[Doubles]:
    return [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
