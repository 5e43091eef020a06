"""The kernel that measures the instances of a picture in one pass over its ids.

What is measured stands in `frame.truth.visible_parts`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import Kernel, checked

__all__ = ["measure_instances"]

_KERNEL = Kernel(
    "measure_instances", *("integer", "integer"), *("array", "array", "array", "array", "array"),
    *("array", "array"),
)  # fmt: skip
_IDS = 65536


def measure_instances(
    instance: NDArray[np.uint16], flow: NDArray[np.float32] | None
) -> tuple[NDArray[np.uint16], NDArray[np.int32], NDArray[np.int32], NDArray[np.int64]]:
    """Measure what is seen of each instance.

    Parameters
    ----------
    instance : (H, W) uint16
    flow : (H, W, 2) float32 or None
        [px/s]; what is NaN, or 1e7 px/s and more, is left out.

    Returns
    -------
    ids : (N,) uint16
        Ascending, without the background.
    pixels : (N,) int32
    boxes : (N, 4) int32
        Left, top, right, bottom [px], the last ones included.
    sums : (N, 3) int64
        Flow to the right and down in steps of 2**-20 px/s, and the number of pixels that have any;
        0 without flow.

    Raises
    ------
    InvalidRequest
        If an array has another type or shape.
    NativeLibraryError
        If there is no library.
    """
    height, width = instance.shape
    checked("instance", instance, np.uint16, (height, width))
    if flow is not None:
        checked("flow", flow, np.float32, (height, width, 2))
    counts = np.zeros(_IDS, np.int32)
    boxes = np.empty((_IDS, 4), np.int32)
    sums = None if flow is None else np.empty((_IDS, 3), np.int64)
    seen, seen_count = np.empty(_IDS, np.uint16), np.zeros(1, np.int64)
    _KERNEL(height, width, instance, flow, counts, boxes, sums, seen, seen_count)
    ids = np.sort(seen[: seen_count[0]])
    ids = ids[ids != 0]
    added = np.zeros((len(ids), 3), np.int64) if sums is None else sums[ids]
    return ids, counts[ids], boxes[ids], added
