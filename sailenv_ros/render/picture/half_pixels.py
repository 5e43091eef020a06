"""Samples half a pixel apart, of which pictures with smooth edges are made.

They are the pixels of `Camera.of_half_pixels`; those of odd numbers are the centres of the camera's
own. OpenGL smooths edges by them, and both renderers the borders of mirrors; for the edges of the
native renderer see `native/src/kernels/edges.cpp`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["pixel_shares"]


def pixel_shares(samples: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Return the share of each pixel that samples half a pixel apart say.

    Parameters
    ----------
    samples : (2 H + 1, 2 W + 1) bool

    Returns
    -------
    shares : (H, W) float32
        By the trapezoid rule: the middle counts 4, the sides 2, the corners 1, of 16.
    """
    values = samples.astype(np.float32)
    rows = values[:-1:2] + 2.0 * values[1::2] + values[2::2]
    sums: NDArray[np.float32] = rows[:, :-1:2] + 2.0 * rows[:, 1::2] + rows[:, 2::2]
    return sums / np.float32(16.0)
