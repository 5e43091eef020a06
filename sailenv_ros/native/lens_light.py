"""The kernels of light that a lens and a camera's balance weaken; see `render.picture.optics`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import Kernel, checked

__all__ = ["scale_light", "weigh_light"]

_WEIGH = Kernel("weigh_light", "iiiaaa")
_SCALE = Kernel("scale_light", "iiiaaaaa")


def weigh_light(
    radiance: NDArray[np.float16], weight: NDArray[np.float32], *, threads: int
) -> NDArray[np.float64]:
    """Return (3,) float64: the sums of red, green and blue, each pixel's times its weight.

    Parameters
    ----------
    radiance : (H, W, 4) float16
        Linear, 0 or more.
    weight : (H, W) float32
    threads : int

    Raises
    ------
    InvalidRequest, NativeLibraryError
        If an array has another type or shape, or there is no native library.
    """
    height, width = radiance.shape[:2]
    checked("radiance", radiance, np.float16, (height, width, 4))
    checked("weight", weight, np.float32, (height, width))
    sums = np.zeros(3)
    _WEIGH(threads, height, width, radiance, weight, sums)
    return sums


def scale_light(
    radiance: NDArray[np.float16],
    share: NDArray[np.float32] | None,
    factors: NDArray[np.float32],
    offsets: NDArray[np.float32],
    *,
    threads: int,
) -> NDArray[np.float16]:
    """Weaken light by pixels and by colours, and add to all pixels alike.

    Parameters
    ----------
    radiance : (H, W, 4) float16
        Linear, 0 or more; the fourth number is kept.
    share : (H, W) float32 or None
        None is 1.
    factors, offsets : (3,) float32
        For red, green and blue.
    threads : int

    Returns
    -------
    radiance : (H, W, 4) float16
        A fresh array, 0 to 65504.

    Raises
    ------
    InvalidRequest, NativeLibraryError
        If an array has another type or shape, or there is no native library.
    """
    height, width = radiance.shape[:2]
    checked("radiance", radiance, np.float16, (height, width, 4))
    if share is not None:
        checked("share", share, np.float32, (height, width))
    for name, numbers in (("factors", factors), ("offsets", offsets)):
        checked(name, numbers, np.float32, (3,))
    result = np.empty((height, width, 4), np.float16)
    _SCALE(threads, height, width, radiance, share, factors, offsets, result)
    return result
