"""Culling of clusters of triangles, for the OpenGL renderer.

Clusters (see `clusters`) and an eye come in, the indices of the triangles that it may see go out.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.cluster_kernels import gather_seen_indices

__all__ = ["seen_indices"]

MARGIN = 0.01
"""What is so little beyond the picture's sides, or faces away by so little, is still drawn: the
GPU's roundings decide there; `CULL_MARGIN` of src/kernels/cluster_culling.h."""


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
    return gather_seen_indices(
        parts.astype(np.int64), clusters, ranges, sides, np.ascontiguousarray(eyes), one_sided,
        (indices, corner_indices), by_corner,
    )  # fmt: skip
