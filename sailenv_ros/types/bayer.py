"""The colour filter array of sensors: which colour each pixel counts, and the levels of RAW data.

The pattern is Bayer's (US patent 3,971,065) with red in the top-left corner, RGGB.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["BLACK_LEVEL", "WHITE_LEVEL", "colours_of_cells", "mosaic"]

BLACK_LEVEL = 4096
"""Value of a pixel without light and noise: noise below it is not cut off."""

WHITE_LEVEL = 65535
"""Value of an exposed and amplified radiance of 1, at which pixels are full."""


def mosaic(colours: NDArray[Any]) -> NDArray[Any]:
    """Return (H, W) of (H, W, C): of each pixel the colour of its own filter; a fresh array."""
    values = colours[..., 1].copy()
    values[0::2, 0::2] = colours[0::2, 0::2, 0]
    values[1::2, 1::2] = colours[1::2, 1::2, 2]
    return values


def colours_of_cells(raw: NDArray[np.uint16]) -> NDArray[np.float32]:
    """Return the colour of each cell of two by two pixels, for all four of them.

    Parameters
    ----------
    raw : (H, W) uint16
        The view ``raw``, of at least two pixels a side.

    Returns
    -------
    linear : (H, W, 3) float32
        0 at `BLACK_LEVEL`, 1 at `WHITE_LEVEL`, less than 0 where noise is below black; the green
        is the mean of both.
    """
    height, width = raw.shape
    # Where the last cell is cut, the pixel two before has the colour that is missing.
    whole = np.pad(raw, ((0, height % 2), (0, width % 2)), "reflect").astype(np.float32)
    green = 0.5 * (whole[0::2, 1::2] + whole[1::2, 0::2])
    cells = np.stack([whole[0::2, 0::2], green, whole[1::2, 1::2]], axis=-1)
    cells = (cells - np.float32(BLACK_LEVEL)) / np.float32(WHITE_LEVEL - BLACK_LEVEL)
    return cells.repeat(2, axis=0).repeat(2, axis=1)[:height, :width]
