"""The renderer's tone curve in NumPy, so that only light is compared; and the match of exposures.

Linear radiance in, 8-bit sRGB out, and back. The curve is that of picture.glsl: Narkowicz's
rational fit to the ACES tone scale, then its fit to sRGB.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["matched_stops", "picture_of", "radiance_of"]

WIDEST_STOPS = 6.0
"""Exposures are matched up to this far from the scene's own."""

Floats = NDArray[np.float64]


def display_of(radiance: NDArray[np.floating], stops: float = 0.0) -> Floats:
    """Give sRGB values from 0 to 1 of linear radiance that is brightened by some stops."""
    c = np.asarray(radiance, dtype=np.float64) * 2.0**stops
    c = np.clip(c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14), 0.0, 1.0)
    fourth = c**0.25
    # The renderer's fit to the sRGB curve, darker than it by up to two levels of 255 near black.
    curved = 0.662002687 * fourth**2 + 0.68412206 * fourth - 0.323583601 * np.sqrt(fourth)
    return np.asarray(np.maximum(curved - 0.022541147 * c, 0.0))


def picture_of(radiance: NDArray[np.floating], stops: float = 0.0) -> NDArray[np.uint8]:
    """Develop linear radiance as the renderer does.

    Parameters
    ----------
    radiance : (H, W, 3) float
    stops : float
        Exposure: factor 2**stops.

    Returns
    -------
    picture : (H, W, 3) uint8
        RGB.
    """
    return np.rint(255.0 * display_of(radiance, stops)).astype(np.uint8)


def radiance_of(picture: NDArray[np.uint8], stops: float = 0.0) -> Floats:
    """Give the linear radiance that a picture's values stand for; for 255 the least that is white.

    As exact as eight bits are: within 1 % for values from 60 to 230.
    """
    levels = np.geomspace(1e-5, 40.0, 20001)
    wanted = np.arange(256) / 255.0
    radiance = np.interp(wanted, display_of(levels), levels, left=0.0)
    return np.asarray(radiance[picture] / 2.0**stops)


def matched_stops(radiance: NDArray[np.floating], picture: NDArray[np.uint8]) -> float:
    """Find the exposure at which radiance is most like a picture: least squares of sRGB values.

    Parameters
    ----------
    radiance : (H, W, 3) float
    picture : (H, W, 3) uint8

    Returns
    -------
    stops : float
        Within a hundredth; between -6 and 6.
    """
    shown = picture / 255.0
    low, high = -WIDEST_STOPS, WIDEST_STOPS
    while high - low > 0.01:
        tried = np.linspace(low, high, 9)
        errors = [float(np.square(display_of(radiance, stops) - shown).mean()) for stops in tried]
        best, step = tried[int(np.argmin(errors))], tried[1] - tried[0]
        low, high = max(best - step, -WIDEST_STOPS), min(best + step, WIDEST_STOPS)
    return float((low + high) / 2.0)
