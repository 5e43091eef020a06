"""What lights give to points, by src/kernels/form_factors.cpp; see `bake.area_light`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import Kernel, checked

__all__ = ["rectangle_form_factors"]

_FORM_FACTORS = Kernel("form_factors", "array", "array", "integer", "array", "array", "array")


def rectangle_form_factors(
    corners: NDArray[np.float64],
    direction: NDArray[np.float64],
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
) -> NDArray[np.float32]:
    """Return (N,) float32: irradiance / pi from a rectangle of radiance 1, 0 to 1.

    Parameters
    ----------
    corners : (4, 3) float64
        One after another.
    direction : (3,) float64
        In which it shines.
    positions, normals : (N, 3) float32
        Of what it shines on.
    """
    checked("corners", corners, np.float64, (4, 3))
    checked("direction", direction, np.float64, (3,))
    checked("positions", positions, np.float32, (None, 3))
    checked("normals", normals, np.float32, (len(positions), 3))
    found = np.empty(len(positions), np.float32)
    _FORM_FACTORS(corners, direction, len(positions), positions, normals, found)
    return found
