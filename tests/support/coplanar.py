"""Faces of different parts of a model that lie in one plane and face the same way."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.rays.model_triangles import triangles_of
from sailenv_ros.types.model import Model

WITHIN_M = 2e-4
"""Steps by which the heights of planes are rounded [m]."""

LEAST_M2 = 1e-7
"""Smaller triangles have no plane of their own [m²]."""

PLACES = np.array([[1, 1, 1], [3, 1, 1], [1, 3, 1], [1, 1, 3]]) / np.array([[3], [5], [5], [5]])
"""Weights of corners at the points of a triangle that stand for it."""


def shared_faces(model: Model) -> dict[int, float]:
    """Return the area of each part's triangles that lies on triangles of other parts [m²]."""
    triangles = triangles_of(model)
    real = triangles.areas_m2 > LEAST_M2
    areas, parts = triangles.areas_m2[real], triangles.part[real]
    corners = triangles.corners[real].astype(np.float64)
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = across / (2.0 * areas[:, None])
    heights = np.einsum("nk,nk->n", corners[:, 0], normals)
    keys = np.rint(np.column_stack([normals * 200.0, heights / WITHIN_M])).astype(np.int64)
    _, planes = np.unique(keys, axis=0, return_inverse=True)
    planes = planes.reshape(-1)
    order = np.argsort(planes, kind="stable")
    found: dict[int, float] = {}
    for plane in np.split(order, np.flatnonzero(np.diff(planes[order])) + 1):
        for part in set(parts[plane].tolist()):
            own, others = plane[parts[plane] == part], plane[parts[plane] != part]
            if len(others):
                points = np.einsum("pc,ncx->npx", PLACES, corners[own]).reshape(-1, 3)
                share = _covered(points, corners[others]).reshape(len(own), -1).mean(axis=1)
                found[part] = found.get(part, 0.0) + float(share @ areas[own])
    return found


def _covered(points: NDArray[np.float64], corners: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return (K,) bool: points that lie in any of some triangles of their plane."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    a, b, c = (first**2).sum(1), (first * second).sum(1), (second**2).sum(1)
    area = a * c - b * b
    inside = np.zeros(len(points), bool)
    for begin in range(0, len(points), 4096):
        away = points[begin : begin + 4096, None] - corners[None, :, 0]
        along, up = np.einsum("pnk,nk->pn", away, first), np.einsum("pnk,nk->pn", away, second)
        one, other = (c * along - b * up) / area, (a * up - b * along) / area
        within = (one > 1e-3) & (other > 1e-3) & (one + other < 1.0 - 1e-3)
        inside[begin : begin + 4096] = within.any(axis=1)
    return inside
