"""Arrays from the differences of their numbers, by the kernel of array_sums.cpp."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import Kernel, checked

__all__ = ["sum_steps"]

_SUM_STEPS = Kernel("sum_steps", "aiiiia")


def sum_steps(
    planes: NDArray[np.uint8], rows: tuple[int, int, int], kind: np.dtype[Any]
) -> NDArray[Any]:
    """Return the numbers of which `light.bake.array_coding` keeps the steps.

    Parameters
    ----------
    planes : (B * R * L * C,) uint8
        The lowest bytes of all steps, then the next ones; the sign is a step's last bit.
    rows : tuple of int
        R rows of L numbers in each of C channels, 1 or 3. Of three, the first and the last are
        told by what they differ from the second in.
    kind : dtype
        Of 1, 2, 4 or 8 bytes, B.

    Returns
    -------
    numbers : (R, L, C) array
    """
    numbers = np.empty(rows, kind)
    checked("planes", planes, np.uint8, (numbers.nbytes,))
    _SUM_STEPS(planes, *rows, numbers.itemsize, numbers)
    return numbers
