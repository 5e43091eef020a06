"""White balance: factors of red, green and blue of a camera that takes the light for another.

Radiance is relative to daylight, D65. A camera that balances for another black body divides by
that one's colour.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.lens_light import scale_light
from sailenv_ros.types.colour import XYZ_FROM_RGB

__all__ = ["balance_factors", "white_balanced"]

DAYLIGHT_MIRED = 1e6 / 6504.0


def white_balanced(
    radiance: NDArray[np.float16], mired: float, *, threads: int = 1
) -> NDArray[np.float16]:
    """Return (H, W, 4) float16: radiance with a wrong white balance; a fresh array.

    Parameters
    ----------
    radiance : (H, W, 4) float16
        Linear; the fourth number is kept.
    mired : float
        By which the light is taken for bluer than it is, see `PictureSettings.white_balance`.
    threads : int
        The result does not depend on it.
    """
    factors = np.array(balance_factors(mired), np.float32)
    return scale_light(radiance, None, factors, np.zeros(3, np.float32), threads=threads)


@lru_cache(maxsize=64)
def balance_factors(mired: float) -> tuple[float, float, float]:
    """Return the factors of red, green and blue; that of green is 1."""
    white = _white(1e6 / DAYLIGHT_MIRED) / _white(1e6 / (DAYLIGHT_MIRED - mired))
    red, green, blue = (white / white[1]).tolist()
    return red, green, blue


def _white(kelvin: float) -> NDArray[np.float64]:
    """Return linear red, green and blue of a black body with luminance 1.

    B. Kang et al., "Design of advanced color temperature control system for HDTV applications"
    (Journal of the Korean Physical Society 41, 2002), for 1,667 to 25,000 K.
    """
    t = 1000.0 / kelvin
    if kelvin <= 4000.0:
        x = ((-0.2661239 * t - 0.2343589) * t + 0.8776956) * t + 0.179910
    else:
        x = ((-3.0258469 * t + 2.1070379) * t + 0.2226347) * t + 0.240390
    if kelvin <= 2222.0:
        y = ((-1.1063814 * x - 1.34811020) * x + 2.18555832) * x - 0.20219683
    elif kelvin <= 4000.0:
        y = ((-0.9549476 * x - 1.37418593) * x + 2.09137015) * x - 0.16748867
    else:
        y = ((3.0817580 * x - 5.87338670) * x + 3.75112997) * x - 0.37001483
    xyz = [x / y, 1.0, (1.0 - x - y) / y]
    return np.asarray(np.linalg.solve(XYZ_FROM_RGB, xyz), np.float64)
