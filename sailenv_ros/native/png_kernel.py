"""Content of PNG files, by the kernels of png_data.cpp and png_rows.cpp."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import Kernel, checked

__all__ = ["png_data", "png_rows"]

_PNG_DATA = Kernel("png_data", "aiiiiaia")
_PNG_ROWS = Kernel("png_rows", "aiiiaa")

LARGER, MORE_BYTES = 2, 4096
"""Capacity beyond which no stream goes: twice what it is made of, and its heads."""


def png_data(rows: NDArray[np.uint8], step: int, *, paeth: bool) -> memoryview:
    """Return filtered and compressed rows, the content of a file's IDAT chunk.

    Parameters
    ----------
    rows : (H, B) uint8
        The bytes of each row as the file has them.
    step : int
        Bytes of a pixel, 1 to 8.
    paeth : bool
        True filters by Paeth's predictor, for colours; False by the row above, for labels.
    """
    checked("rows", rows, np.uint8, (None, None))
    height, width = rows.shape
    data = np.empty(LARGER * height * (width + 1) + MORE_BYTES, np.uint8)
    written = np.zeros(1, np.int64)
    _PNG_DATA(rows, height, width, step, int(paeth), data, data.nbytes, written)
    return data[: int(written[0])].data


def png_rows(filtered: NDArray[np.uint8], step: int) -> NDArray[np.uint8] | None:
    """Return the rows of a PNG file from what is compressed in its IDAT chunk.

    Parameters
    ----------
    filtered : (H, 1 + B) uint8
        Number of each row's filter, and its filtered bytes.
    step : int
        Bytes of a pixel, 1 to 8.

    Returns
    -------
    rows : (H, B) uint8 or None
        None if there is no such filter.
    """
    checked("filtered", filtered, np.uint8, (None, None))
    height, width = filtered.shape[0], filtered.shape[1] - 1
    rows, read = np.empty((height, width), np.uint8), np.zeros(1, np.int64)
    _PNG_ROWS(filtered, height, width, step, rows, read)
    return rows if read[0] else None
