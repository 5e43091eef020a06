"""Which clusters of triangles an eye sees, by src/kernels/cluster_culling.cpp."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.bake_types import Record
from sailenv_ros.native.library import Kernel, checked

__all__ = ["gather_seen_indices"]

_SEEN = Kernel("seen_indices", "aiaaa")


def gather_seen_indices(
    parts: NDArray[np.int64],
    clusters: NDArray[np.void],
    ranges: NDArray[np.int64],
    sides: NDArray[np.float64],
    eyes: NDArray[np.float64],
    one_sided: NDArray[np.bool_],
    indices: tuple[NDArray[np.uint32], NDArray[np.uint32]],
    by_corner: NDArray[np.bool_],
) -> tuple[NDArray[np.uint32], NDArray[np.int64]]:
    """Gather the triangles that an eye may see.

    Parameters
    ----------
    sides : (P, 4, 4) float64
        Planes of each part's frame that look inwards, of unit length.
    indices : (I,), (I,) uint32
        Those of which `by_corner` chooses, the second ones where it is true.
    parts, clusters, ranges, eyes, one_sided, by_corner
        As in `render.cluster_culling.seen_indices`.

    Returns
    -------
    seen : (N,) uint32
    lies : (P, 2) int64
    """
    count, index_count = len(ranges), len(indices[0])
    arrays: dict[str, NDArray[Any]] = {
        "parts": checked("parts", parts, np.int64, (None,)),
        "clusters": checked("clusters", clusters, clusters.dtype, (None,)),
        "ranges": checked("ranges", ranges, np.int64, (None, 3)),
        "sides": checked("sides", sides, np.float64, (count, 4, 4)),
        "eyes": checked("eyes", eyes, np.float64, (count, 3)),
        "one_sided": checked("one-sided parts", one_sided, np.bool_, (count,)),
        "by_corner": checked("parts by corner", by_corner, np.bool_, (count,)),
        "indices": checked("indices", indices[0], np.uint32, (None,)),
        "corner_indices": checked("corner indices", indices[1], np.uint32, (index_count,)),
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
