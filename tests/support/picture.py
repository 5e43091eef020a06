"""Reading numbers out of pictures."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from sailenv_ros.types.colour import linear_from_srgb


def linear(rgb: ArrayLike) -> NDArray[np.float64]:
    """Undo sRGB and the filmic curve: the radiance that the lighting pass computed."""
    c = linear_from_srgb(np.asarray(rgb, np.float64) / 255)
    a, b, d = 2.51 - 2.43 * c, 0.03 - 0.59 * c, -0.14 * c
    return (-b + np.sqrt(b * b - 4 * a * d)) / (2 * a)


def read_picture(path: Path) -> np.ndarray:
    """Return a picture file's values as they are; OpenCV's order of colours."""
    picture = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    assert picture is not None, path
    return picture
