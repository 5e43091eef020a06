"""Reading numbers out of pictures."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def linear(rgb: ArrayLike) -> NDArray[np.float64]:
    """Undo sRGB and the filmic curve: the radiance that the lighting pass computed."""
    c = np.asarray(rgb, np.float64) / 255
    c = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    a, b, d = 2.51 - 2.43 * c, 0.03 - 0.59 * c, -0.14 * c
    return (-b + np.sqrt(b * b - 4 * a * d)) / (2 * a)
