"""Runs the library's kernel that tests itself: that threads do each row once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import Kernel

__all__ = ["run_self_test"]

_KERNEL = Kernel("self_test", "iiiaa")


def run_self_test(
    rows: int, *, tile_rows: int, threads: int
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Work on rows by tiles.

    Parameters
    ----------
    rows, tile_rows : int
    threads : int
        At least 1.

    Returns
    -------
    counts : (rows,) int32
        How often each row was worked on.
    slots : (rows,) int32
        Which of the threads did it, from 0.

    Raises
    ------
    NativeLibraryError
        If there is no library, or an argument is negative.
    """
    counts, slots = np.zeros(max(rows, 0), np.int32), np.full(max(rows, 0), -1, np.int32)
    _KERNEL(threads, rows, tile_rows, counts, slots)
    return counts, slots
