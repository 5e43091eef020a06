"""Which clusters of triangles an eye sees, for the OpenGL renderer.

Clusters (see `clusters`) and an eye come in, the indices of the triangles that it may see go out.
Alone in its module, because only this back end needs numba for its frames; importing it takes a
quarter of a second.
"""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.scene.clusters import CLUSTER

__all__ = ["seen_indices", "warm_up"]

MARGIN = 0.01
"""What is so little beyond the picture's sides, or faces away by so little, is still drawn: the
GPU's roundings decide there."""


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
    """Return whether a cluster's sphere lies beyond one of the picture's four sides."""
    c = cluster.centre
    for s in range(4):
        inside = sides[s, 0] * c[0] + sides[s, 1] * c[1] + sides[s, 2] * c[2] + sides[s, 3]
        if inside < -cluster.radius:
            return True
    return False


@numba.njit(cache=True, nogil=True)
def _faces_away(cluster, eye):  # type: ignore[no-untyped-def]  # compiled
    """Return whether no triangle in the sphere, with a normal in the cone, can face the eye."""
    dx, dy, dz = cluster.centre[0] - eye[0], cluster.centre[1] - eye[1], cluster.centre[2] - eye[2]
    distance = np.sqrt(dx * dx + dy * dy + dz * dz)
    along = cluster.axis[0] * dx + cluster.axis[1] * dy + cluster.axis[2] * dz
    if cluster.cosine <= 0.0 or along <= 0.0:
        return False
    across = np.sqrt(max(distance * distance - along * along, 0.0))
    sine = np.sqrt(1.0 - min(cluster.cosine, 1.0) ** 2)
    return along * cluster.cosine - across * sine >= cluster.radius + MARGIN * distance
