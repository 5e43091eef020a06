"""The kernel of ambient visibility: from depth and ids to how much light from around arrives.

The method and its constants stand in `render.ambient_occlusion`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import Kernel, checked

__all__ = ["find_ambient_visibility"]

_KERNEL = Kernel(
    "ambient_visibility",
    *("integer", "integer", "integer", "array", "array", "array", "array", "array", "array"),
)


def find_ambient_visibility(
    surface: NDArray[np.float32],
    baked: NDArray[np.bool_],
    numbers: NDArray[np.float32],
    pattern: NDArray[np.float32],
    *,
    threads: int,
) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """Compute the share of the light from around that arrives, at half resolution.

    Parameters
    ----------
    surface : (H, W, 2) float32
        Depth [m] and instance id.
    baked : (65536,) bool
        By instance id: surfaces whose light was baked.
    numbers : (10,) float32
        Focal length and principal point of the samples [px], radius [m], the least and the
        greatest radius [px], bias, scale, the share of its depth by which a sample may lie off
        another's surface, and how many samples lie from one to the next of the second average,
        1 to 4.
    pattern : (16, 2, 12) float32
        For each place in a block, points in the unit disc.
    threads : int

    Returns
    -------
    visibility : (h, w) uint8
        255 = all of it; h and w are half of H and W, rounded up.
    inverse : (h, w) float32
        1 / depth [1/m], negative where light was baked, -1e-9 where nothing was hit.

    Raises
    ------
    InvalidRequest
        If an array has another type or shape.
    NativeLibraryError
        If there is no library, or no memory.
    """
    height, width = surface.shape[:2]
    checked("surface", surface, np.float32, (height, width, 2))
    checked("baked", baked, np.bool_, (65536,))
    checked("numbers", numbers, np.float32, (10,))
    checked("pattern", pattern, np.float32, (16, 2, 12))
    shape = (height + 1) // 2, (width + 1) // 2
    inverse, visibility = np.empty(shape, np.float32), np.empty(shape, np.uint8)
    _KERNEL(threads, height, width, surface, baked, numbers, pattern, inverse, visibility)
    return visibility, inverse
