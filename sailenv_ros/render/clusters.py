"""Clusters: small groups of neighbouring triangles that face alike, and which of them an eye sees.

Meshes come in once, their triangles reordered and a table of clusters go out; for each eye, the
indices of those triangles that it may see. A software rasteriser brings every vertex of a draw to
the screen before it finds that its triangle faces away; asking a cluster costs as much as a vertex.
"""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

__all__ = ["CLUSTER", "CLUSTER_TRIANGLES", "clusters_of", "seen_indices", "warm_up"]

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

MARGIN = 0.01
"""What is so little beyond the picture's sides, or faces away by so little, is still drawn: the
GPU's roundings decide there."""


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


def seen_indices(
    parts: NDArray[np.intp],
    clusters: NDArray[np.void],
    ranges: NDArray[np.int64],
    clip_from_part: NDArray[np.float64],
    eyes: NDArray[np.float64],
    one_sided: NDArray[np.bool_],
    indices: NDArray[np.uint32],
    corner_indices: NDArray[np.uint32],
    by_corner: NDArray[np.bool_],
) -> tuple[NDArray[np.uint32], NDArray[np.int64]]:
    """Gather the triangles that an eye may see.

    Parameters
    ----------
    parts : (K,) int
        Numbers of the parts to look at, in the order in which their triangles are wanted.
    clusters : (C,) CLUSTER
    ranges : (P, 3) int64
        First cluster, number of clusters, and number of indices of each part.
    clip_from_part : (P, 4, 4) float64
        Perspective projection of each part.
    eyes : (P, 3) float64
        Where the eye is in each part's frame [m].
    one_sided : (P,) bool
        True for parts of which triangles that face away are not wanted.
    indices, corner_indices : (I,) uint32
        All indices, and those of the same triangles by position alone.
    by_corner : (P,) bool
        Which of the two are wanted of a part.

    Returns
    -------
    seen : (N,) uint32
    lies : (P, 2) int64
        First index and number of indices of each part in `seen`; 0, 0 for others than `parts`.
    """
    wide = (1.0 + MARGIN) * clip_from_part[:, 3:]
    sides = np.concatenate([wide + clip_from_part[:, :2], wide - clip_from_part[:, :2]], axis=1)
    sides /= np.linalg.norm(sides[..., :3], axis=2, keepdims=True)
    seen = np.empty(int(ranges[parts, 2].sum()), np.uint32)
    lies = np.zeros((len(ranges), 2), np.int64)
    count = _gather(
        parts,
        clusters,
        ranges,
        sides,
        eyes,
        one_sided,
        indices,
        corner_indices,
        by_corner,
        seen,
        lies,
    )
    return seen[:count], lies


def warm_up() -> None:
    """Compile the walk now (or load it from numba's cache), not at the first frame."""
    seen_indices(
        np.zeros(1, np.intp),
        np.zeros(1, CLUSTER),
        np.array([[0, 1, 0]]),
        np.ones((1, 4, 4)),
        np.zeros((1, 3)),
        np.ones(1, bool),
        np.zeros(1, np.uint32),
        np.zeros(1, np.uint32),
        np.ones(1, bool),
    )


def _normals(corners: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Give unit normals (0 for triangles without area), and twice the areas."""
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    twice = np.linalg.norm(cross, axis=1)
    some = twice[:, None] > 0.0
    return np.divide(cross, twice[:, None], out=np.zeros_like(cross), where=some), twice


def _morton_codes(points: NDArray[np.float64]) -> NDArray[np.int64]:
    """Give the places of points on Morton's curve through their box, 1024 steps a side."""
    low = points.min(axis=0)
    size = max(float((points.max(axis=0) - low).max()), 1e-12)
    cells = np.minimum((points - low) / size * 1024.0, 1023.0).astype(np.int64)
    # Two empty places after each bit: those of the other axes go there.
    for shift, mask in ((16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249)):
        cells = (cells | cells << shift) & mask
    codes: NDArray[np.int64] = cells @ np.array([1, 2, 4])
    return codes


@numba.njit(cache=True, nogil=True)
def _gather(  # type: ignore[no-untyped-def]  # compiled
    parts,
    clusters,
    ranges,
    sides,
    eyes,
    one_sided,
    indices,
    corner_indices,
    by_corner,
    seen,
    lies,
):
    count = 0
    for part in parts:
        first = count
        source = corner_indices if by_corner[part] else indices
        for number in range(ranges[part, 0], ranges[part, 0] + ranges[part, 1]):
            cluster = clusters[number]
            if _is_beyond(cluster, sides[part]):
                continue
            if one_sided[part] and _faces_away(cluster, eyes[part]):
                continue
            begin = cluster.first_index
            for index in range(begin, begin + cluster.index_count):
                seen[count] = source[index]
                count += 1
        lies[part, 0] = first
        lies[part, 1] = count - first
    return count


@numba.njit(cache=True, nogil=True)
def _is_beyond(cluster, sides):  # type: ignore[no-untyped-def]  # compiled
    """Tell if a cluster's sphere lies beyond one of the picture's four sides."""
    c = cluster.centre
    for s in range(4):
        inside = sides[s, 0] * c[0] + sides[s, 1] * c[1] + sides[s, 2] * c[2] + sides[s, 3]
        if inside < -cluster.radius:
            return True
    return False


@numba.njit(cache=True, nogil=True)
def _faces_away(cluster, eye):  # type: ignore[no-untyped-def]  # compiled
    """Tell if no triangle within the sphere, with a normal within the cone, can face the eye."""
    dx, dy, dz = cluster.centre[0] - eye[0], cluster.centre[1] - eye[1], cluster.centre[2] - eye[2]
    distance = np.sqrt(dx * dx + dy * dy + dz * dz)
    along = cluster.axis[0] * dx + cluster.axis[1] * dy + cluster.axis[2] * dz
    if cluster.cosine <= 0.0 or along <= 0.0:
        return False
    across = np.sqrt(max(distance * distance - along * along, 0.0))
    sine = np.sqrt(1.0 - min(cluster.cosine, 1.0) ** 2)
    return along * cluster.cosine - across * sine >= cluster.radius + MARGIN * distance
