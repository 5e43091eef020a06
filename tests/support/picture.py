"""Reading numbers out of pictures."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sailenv_ros.types.colour import linear_from_srgb


def linear(rgb: ArrayLike) -> NDArray[np.float64]:
    """Undo sRGB and the filmic curve: the radiance that the lighting pass computed."""
    c = linear_from_srgb(np.asarray(rgb, np.float64) / 255)
    a, b, d = 2.51 - 2.43 * c, 0.03 - 0.59 * c, -0.14 * c
    return (-b + np.sqrt(b * b - 4 * a * d)) / (2 * a)
