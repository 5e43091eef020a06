"""Masks of the pixels at edges, where a ray through the middle may meet another surface."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray


def grown(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return a mask with the pixels beside it."""
    return cv2.dilate(mask.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(bool)


def near_edges(
    ids: NDArray[Any], reach: NDArray[np.float64], least_bend: float
) -> NDArray[np.bool_]:
    """Return which pixels are beside another instance, or another surface of the same one.

    A surface seen at a slant changes the inverse of its depth evenly: no second difference.
    """
    kernel = np.ones((3, 3), np.uint8)
    as_float = ids.astype(np.float32)
    other = cv2.dilate(as_float, kernel) != cv2.erode(as_float, kernel)
    inverse = np.where(np.isfinite(reach), 1.0 / reach, 0.0)
    bend = np.zeros(ids.shape)
    bend[:, 1:-1] += np.abs(inverse[:, 2:] - 2.0 * inverse[:, 1:-1] + inverse[:, :-2])
    bend[1:-1] += np.abs(inverse[2:] - 2.0 * inverse[1:-1] + inverse[:-2])
    return np.asarray(other | grown(bend > least_bend))
