"""Faces of different materials that lie in one plane and face the same way: which is seen?"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.model import Model

WITHIN_M = 2e-4
"""Planes nearer than this count as one [m]."""

PLACES = np.array([[1, 1, 1], [3, 1, 1], [1, 3, 1], [1, 1, 3]]) / np.array([[3], [5], [5], [5]])
"""Weights of corners at the points of a triangle that stand for it."""


def shared_faces(model: Model) -> dict[tuple[int, int], float]:
    """Return the area [m²] by two parts: of the first's triangles that lie on the second's."""
    meshes = [part.mesh for part in model.parts]
    corners = np.concatenate([mesh.positions[mesh.triangles] for mesh in meshes]).astype(float)
    parts = np.repeat(np.arange(len(meshes)), [len(mesh.triangles) for mesh in meshes])
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(across, axis=1)
    real = size > 2e-7
    corners, parts, size = corners[real], parts[real], size[real]
    normals = across[real] / size[:, None]
    heights = np.einsum("nk,nk->n", corners[:, 0], normals)
    keys = np.rint(np.column_stack([normals * 200.0, heights / WITHIN_M])).astype(np.int64)
    found: dict[tuple[int, int], float] = {}
    _, planes = np.unique(keys, axis=0, return_inverse=True)
    order = np.argsort(planes.reshape(-1), kind="stable")
    for plane in np.split(order, np.flatnonzero(np.diff(planes.reshape(-1)[order])) + 1):
        for part in set(parts[plane].tolist()):
            own, others = plane[parts[plane] == part], plane[parts[plane] != part]
            if not len(others):
                continue
            points = np.einsum("pc,ncx->npx", PLACES, corners[own])
            for other in set(parts[others].tolist()):
                chosen = others[parts[others] == other]
                covered = _covered(points.reshape(-1, 3), corners[chosen])
                area = float(covered.reshape(len(own), -1).mean(axis=1) @ size[own] / 2.0)
                if area > 0.0:
                    found[part, other] = found.get((part, other), 0.0) + area
    return found


def _covered(points: NDArray[np.float64], corners: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return (K,) bool: points that lie in any of some triangles of their plane."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    a, b, c = (np.einsum("nk,nk->n", *pair) for pair in (
        (first, first), (first, second), (second, second)
    ))  # fmt: skip
    area = a * c - b * b
    inside = np.zeros(len(points), bool)
    for begin in range(0, len(points), 4096):
        away = points[begin : begin + 4096, None] - corners[None, :, 0]
        along, up = np.einsum("pnk,nk->pn", away, first), np.einsum("pnk,nk->pn", away, second)
        one, other = (c * along - b * up) / area, (a * up - b * along) / area
        within = (one > 1e-3) & (other > 1e-3) & (one + other < 1.0 - 1e-3)
        inside[begin : begin + 4096] = within.any(axis=1)
    return inside
