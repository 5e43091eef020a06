"""The clusters of triangles that an eye sees, by src/kernels/cluster_culling.cpp.

Clusters (see `mesh_kernels`) and an eye come in, the indices of the triangles that it may
see go out.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.bake_types import Record
from sailenv_ros.native.library import Kernel, checked

__all__ = ["MARGIN", "seen_indices"]

_SEEN = Kernel("seen_indices", "aiaaa")

MARGIN = 0.01
"""Margin beyond the picture's sides, and of faces that turn away, that is still drawn: the
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
    count, index_count = len(ranges), len(indices)
    arrays: dict[str, NDArray[Any]] = {
        "parts": checked("parts", parts.astype(np.int64), np.int64, (None,)),
        "clusters": checked("clusters", clusters, clusters.dtype, (None,)),
        "ranges": checked("ranges", ranges, np.int64, (None, 3)),
        "sides": checked("sides", sides, np.float64, (count, 4, 4)),
        "eyes": checked("eyes", np.ascontiguousarray(eyes), np.float64, (count, 3)),
        "one_sided": checked("one-sided parts", one_sided, np.bool_, (count,)),
        "by_corner": checked("parts by corner", by_corner, np.bool_, (count,)),
        "indices": checked("indices", indices, np.uint32, (None,)),
        "corner_indices": checked("corner indices", corner_indices, np.uint32, (index_count,)),
    }
    numbers = {
        "count": len(parts),
        "part_count": count,
        "cluster_count": len(clusters),
        "index_count": index_count,
    }
    query = Record(arrays, numbers)
    seen = np.empty(int(ranges[parts, 2].sum()), np.uint32)
    lies, made = np.zeros((count, 2), np.int64), np.zeros(1, np.int64)
    _SEEN(query.record, len(seen), seen, lies, made)
    return seen[: int(made[0])], lies
