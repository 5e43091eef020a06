"""The kernel that averages the samples of each pixel, and takes away what light does not arrive.

What it does stands in `render.supersampling`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import Kernel, checked

__all__ = ["resolve_samples"]

_KERNEL = Kernel(
    "resolve",
    *("integer", "integer", "integer", "integer", "array", "array", "array", "array", "number"),
    *("integer", "array"),
)


def resolve_samples(
    samples: NDArray[np.float16],
    times: int,
    visibility: NDArray[np.uint8] | None,
    inverse: NDArray[np.float32] | None,
    surface: NDArray[np.float32] | None,
    *,
    same_surface: float,
    keep_ambient_share: bool = False,
    threads: int,
) -> NDArray[np.float16]:
    """Average the samples of each pixel.

    Parameters
    ----------
    samples : (times H, times W, 4) float16
        Linear radiance, 0 or more, and the share of it that came from around.
    times : int
        Samples on a side of a pixel.
    visibility, inverse : arrays or None
        What `find_ambient_visibility` returns for the pixels; None where all light arrives.
    surface : (times H, times W, 2) float32 or None
        Depth [m] and instance id of the samples; needed beside `visibility`.
    same_surface : float
        Share of its depth by which a sample of `visibility` may lie off another's surface.
    keep_ambient_share : bool
        True keeps the fourth number, where there is one sample a pixel; else it becomes 0.
    threads : int

    Returns
    -------
    radiance : (H, W, 4) float16
        A fresh array.

    Raises
    ------
    InvalidRequest
        If an array has another type or shape.
    NativeLibraryError
        If there is no library, or an argument cannot be accepted.
    """
    height, width = samples.shape[0] // times, samples.shape[1] // times
    checked("samples", samples, np.float16, (times * height, times * width, 4))
    if visibility is not None and inverse is not None and surface is not None:
        half = (height + 1) // 2, (width + 1) // 2
        checked("visibility", visibility, np.uint8, half)
        checked("inverse", inverse, np.float32, half)
        checked("surface", surface, np.float32, (times * height, times * width, 2))
    else:
        visibility = inverse = surface = None
    radiance = np.empty((height, width, 4), np.float16)
    _KERNEL(
        *(threads, height, width, times, samples, visibility, inverse, surface),
        *(same_surface, int(keep_ambient_share), radiance),
    )
    return radiance
