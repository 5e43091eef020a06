"""Bloom: a share of the light of each pixel is spread around it, as lenses and eyes do.

Radiance comes in, radiance goes out. The light that is spread is taken away where it came from,
so a uniform picture stays as it is.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

__all__ = ["add_bloom"]

LEVELS = 5
"""Halvings of the picture: each doubles how far light is spread."""


def add_bloom(radiance: NDArray[np.float16], share: float) -> NDArray[np.float16]:
    """Spread light.

    Parameters
    ----------
    radiance : (H, W, 4) float16
        Linear; the fourth number is kept.
    share : float
        Of the light, 0 to 1.

    Returns
    -------
    radiance : (H, W, 4) float16
        A fresh array.
    """
    light = radiance[..., :3].astype(np.float32)
    height, width = light.shape[:2]
    halo = np.zeros_like(light)
    small = light
    for _ in range(LEVELS):
        size = max(1, (small.shape[1] + 1) // 2), max(1, (small.shape[0] + 1) // 2)
        small = np.asarray(cv2.resize(small, size, interpolation=cv2.INTER_AREA), np.float32)
        soft = cv2.GaussianBlur(small, (0, 0), 1.2, borderType=cv2.BORDER_REPLICATE)
        halo += cv2.resize(soft, (width, height), interpolation=cv2.INTER_LINEAR)
    result = radiance.copy()
    result[..., :3] = light + np.float32(share) * (halo / LEVELS - light)
    return result
