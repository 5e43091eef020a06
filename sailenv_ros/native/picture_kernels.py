"""The kernel of pictures: from radiance to 8-bit sRGB; see `render.tone_map`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import Kernel, checked

__all__ = ["make_picture"]

_KERNEL = Kernel(
    "make_picture",
    *("integer", "integer", "integer", "array", "array", "array", "array", "array", "number"),
    "array",
)


def make_picture(
    radiance: NDArray[np.float16],
    table: NDArray[np.uint8],
    visibility: NDArray[np.uint8] | None,
    inverse: NDArray[np.float32] | None,
    surface: NDArray[np.float32] | None,
    *,
    same_surface: float,
    threads: int,
) -> NDArray[np.uint8]:
    """Make the picture.

    Parameters
    ----------
    radiance : (H, W, 4) float16
        Linear, 0 or more; the fourth number is the share of the light that came from around.
    table : (65536,) uint8
        Stored value of each half-precision number, by its bits.
    visibility, inverse : arrays or None
        What `find_ambient_visibility` returns; None where all light arrives.
    surface : (H, W, 2) float32 or None
        Depth [m] and instance id; needed beside `visibility`.
    same_surface : float
        Share of its depth by which a sample of `visibility` may lie off a pixel's own surface.
    threads : int

    Returns
    -------
    rgb : (H, W, 3) uint8
        A fresh array.

    Raises
    ------
    InvalidRequest
        If an array has another type or shape.
    NativeLibraryError
        If there is no library, or no memory.
    """
    height, width = radiance.shape[:2]
    checked("radiance", radiance, np.float16, (height, width, 4))
    checked("table", table, np.uint8, (65536,))
    if surface is not None:
        checked("surface", surface, np.float32, (height, width, 2))
    if visibility is not None and inverse is not None and surface is not None:
        half = (height + 1) // 2, (width + 1) // 2
        checked("visibility", visibility, np.uint8, half)
        checked("inverse", inverse, np.float32, half)
    else:
        visibility = inverse = None
    rgb = np.empty((height, width, 3), np.uint8)
    _KERNEL(
        *(threads, height, width, radiance, table, visibility, inverse, surface),
        *(same_surface, rgb),
    )
    return rgb
