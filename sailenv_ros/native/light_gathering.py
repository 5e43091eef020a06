"""The kernel of what a sensor does to light: bloom and noise.

What it does stands in `render.sensor`; the tests define its sums in plain NumPy.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import Kernel, checked

__all__ = ["gather_light"]

_KERNEL = Kernel(
    "gather_light",
    *("integer", "integer", "integer", "array", "number", "number", "number", "integer", "array"),
    "array",
)


def gather_light(
    radiance: NDArray[np.float16],
    bloom: float,
    shot: float,
    read: float,
    seed: int,
    normal: NDArray[np.float32] | None,
    *,
    threads: int,
) -> NDArray[np.float16]:
    """Spread light and add noise.

    Parameters
    ----------
    radiance : (H, W, 4) float16
        Linear, 0 or more; the fourth number is kept.
    bloom : float
        Share of the light that is spread.
    shot, read : float
        The variance of a radiance x is x · shot + read.
    seed : int
        64 bits, signed.
    normal : (65536,) float32 or None
        Numbers that noise is drawn from; None for no noise.
    threads : int

    Returns
    -------
    radiance : (H, W, 4) float16
        A fresh array, 0 to 6e4.

    Raises
    ------
    InvalidRequest
        If an array has another type or shape.
    NativeLibraryError
        If there is no library, or no memory.
    """
    height, width = radiance.shape[:2]
    checked("radiance", radiance, np.float16, (height, width, 4))
    if normal is not None:
        checked("normal", normal, np.float32, (65536,))
    result = np.empty((height, width, 4), np.float16)
    _KERNEL(threads, height, width, radiance, bloom, shot, read, seed, normal, result)
    return result
