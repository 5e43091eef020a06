"""Clusters: small groups of neighbouring triangles that face alike.

Meshes come in once, their triangles reordered and a table of clusters go out. A software
rasteriser brings every vertex of a draw to the screen before it finds that its triangle faces away;
asking a cluster costs as much as a vertex.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["CLUSTER", "CLUSTER_TRIANGLES", "clusters_of"]

CLUSTER_TRIANGLES = 32
"""Triangles of a cluster, at most."""

CLUSTER = np.dtype(
    [
        ("first_index", "<i8"),
        ("index_count", "<i8"),
        ("centre", "<f8", 3),
        ("radius", "<f8"),
        ("axis", "<f8", 3),
        ("cosine", "<f8"),
    ]
)
"""A cluster: its indices, the sphere around it, the middle of its normals, and the cosine of the
angle by which one of them deviates at most (-1: nothing can be said of where it faces)."""


def clusters_of(
    positions: NDArray[np.float32], triangles: NDArray[np.uint32]
) -> tuple[NDArray[np.uint32], NDArray[np.void]]:
    """Order a mesh's triangles by cluster.

    Parameters
    ----------
    positions : (V, 3) float32
        In the object's frame [m].
    triangles : (M, 3) uint32
        Counter-clockwise as seen from in front.

    Returns
    -------
    triangles : (M, 3) uint32
        The same in another order.
    clusters : (C,) CLUSTER
    """
    if not len(triangles):
        return triangles, np.zeros(0, CLUSTER)
    corners = positions[triangles].astype(np.float64)
    normals, areas = _normals(corners)
    centroids = corners.mean(axis=1)
    # Which of the six sides of a cube a triangle faces; then neighbours by Morton's curve.
    side = 2 * np.abs(normals).argmax(axis=1)
    side += np.take_along_axis(normals, side[:, None] // 2, axis=1)[:, 0] < 0.0
    order = np.lexsort((_morton_codes(centroids), side))
    side = side[order]
    place = np.arange(len(order))
    first_of_side = np.maximum.accumulate(np.where(np.diff(side, prepend=-1) != 0, place, 0))
    starts = np.flatnonzero((place - first_of_side) % CLUSTER_TRIANGLES == 0)
    clusters = np.zeros(len(starts), CLUSTER)
    counts = np.diff(starts, append=len(order))
    clusters["first_index"], clusters["index_count"] = 3 * starts, 3 * counts
    of = np.repeat(np.arange(len(starts)), counts)
    corners, normals, areas = corners[order], normals[order], areas[order]
    low = np.minimum.reduceat(corners.min(axis=1), starts)
    high = np.maximum.reduceat(corners.max(axis=1), starts)
    clusters["centre"] = 0.5 * (low + high)
    away = np.linalg.norm(corners - clusters["centre"][of][:, None], axis=2).max(axis=1)
    clusters["radius"] = np.maximum.reduceat(away, starts)
    axis = np.add.reduceat(normals * areas[:, None], starts)
    length = np.linalg.norm(axis, axis=1)
    axis = np.divide(axis, length[:, None], out=np.zeros_like(axis), where=length[:, None] > 0.0)
    along = np.where(areas > 0.0, (normals * axis[of]).sum(axis=1), 1.0)
    clusters["axis"] = axis
    clusters["cosine"] = np.where(length > 0.0, np.minimum.reduceat(along, starts), -1.0)
    return np.ascontiguousarray(triangles[order]), clusters


def _normals(corners: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return unit normals (0 for triangles without area), and twice the areas."""
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    twice = np.linalg.norm(cross, axis=1)
    some = twice[:, None] > 0.0
    return np.divide(cross, twice[:, None], out=np.zeros_like(cross), where=some), twice


def _morton_codes(points: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the places of points on Morton's curve through their box, 1024 steps a side."""
    low = points.min(axis=0)
    size = max(float((points.max(axis=0) - low).max()), 1e-12)
    cells = np.minimum((points - low) / size * 1024.0, 1023.0).astype(np.int64)
    # Two empty places after each bit: those of the other axes go there.
    for shift, mask in ((16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249)):
        cells = (cells | cells << shift) & mask
    codes: NDArray[np.int64] = cells @ np.array([1, 2, 4])
    return codes
