"""Tone curves: from exposed radiance to what an sRGB picture stores.

Settings come in, a table over all half-precision numbers goes out, so that a curve costs a pixel
one look-up whatever it is.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sailenv_ros.types.colour import srgb_from_linear
from sailenv_ros.types.picture_settings import PictureSettings, ToneCurve

__all__ = ["code_table", "filmic", "tone_mapped"]


def filmic(radiance: ArrayLike) -> NDArray[np.float64]:
    """Roll off highlights and shadows as film does; 0 to 1.

    A rational fit to the ACES reference tone scale (Narkowicz 2015, "ACES filmic tone mapping").
    """
    c = np.asarray(radiance, np.float64)
    # From here on the curve is 1; beyond it, squares of infinity would have no quotient.
    c = np.minimum(c, 1e3)
    return np.clip(c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14), 0.0, 1.0)


def tone_mapped(
    radiance: ArrayLike, curve: ToneCurve = "filmic", exposure: float = 0.0
) -> NDArray[np.float64]:
    """Return the sRGB value, 0 to 1, of a radiance.

    Parameters
    ----------
    radiance : array-like
        Linear, 0 or more, as the scene's exposure left it.
    curve : {'filmic', 'linear'}
    exposure : float
        Stops.
    """
    exposed = np.asarray(radiance, np.float64) * 2.0**exposure
    return srgb_from_linear(filmic(exposed) if curve == "filmic" else exposed)


def code_table(settings: PictureSettings) -> NDArray[np.uint8]:
    """Return (65536,) uint8 read-only: the picture's value of each half-precision radiance.

    The index is the number's bits; what is negative or no number is black.
    """
    # Gain amplifies what was collected, exposure what arrives: to the curve they are one.
    return _code_table(settings.tone_curve, settings.exposure + settings.gain)


@lru_cache(maxsize=32)
def _code_table(curve: ToneCurve, exposure: float) -> NDArray[np.uint8]:
    with np.errstate(invalid="ignore"):  # some processors report bits that are no number
        halves = np.arange(65536, dtype=np.uint16).view(np.float16).astype(np.float64)
    lit = np.where(halves > 0.0, halves, 0.0)
    table = np.floor(tone_mapped(lit, curve, exposure) * 255.0 + 0.5).astype(np.uint8)
    table.flags.writeable = False
    return table
