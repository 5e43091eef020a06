"""A photographed sky as it is seen behind windows."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.lights import SkyMap

__all__ = ["seen_sky"]

CAPPED = 0.97
"""Pixels of more than this share of the greatest luminance belong to the sun and its glare."""

SPOT_PX, BLUR_PX = 15, 6.0
"""Largest spot, and how far around it colours are averaged."""

LUMINANCE = np.array([0.2126, 0.7152, 0.0722], np.float32)


def seen_sky(sky: SkyMap) -> NDArray[np.float16]:
    """Return (H, 2 H, 3) float16: the radiance of a sky, with one colour of the sun's glare.

    A sky's file holds no sun (`assets.skies`): where it stood, luminance is capped, and what is
    left of the pixels that overflowed in the camera are odd hues and dark rings. Such spots amidst
    the glare take the mean colour of what is around them.
    """
    radiance = sky.radiance.astype(np.float32)
    light = radiance @ LUMINANCE
    glare = (light >= CAPPED * light.max()).astype(np.uint8)
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (SPOT_PX, SPOT_PX))
    mended = cv2.morphologyEx(glare, cv2.MORPH_CLOSE, disc)[..., None] > 0
    capped = glare.astype(np.float32)
    share = cv2.GaussianBlur(capped, (0, 0), BLUR_PX)[..., None]
    mean = cv2.GaussianBlur(radiance * capped[..., None], (0, 0), BLUR_PX)
    mean /= np.maximum(share, 1e-6)
    result: NDArray[np.float16] = np.where(mended, mean, radiance)
    return np.clip(result, 0.0, 6e4).astype(np.float16)
