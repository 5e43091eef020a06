"""First hits of rays through a scene; the result of `cast_rays`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["RayCast"]


class RayCast(NamedTuple):
    """First hit of each ray.

    Attributes
    ----------
    instance_ids : (R,) uint16
        The value of the instance's pixels; 0 where nothing was met.
    distances_m : (R,) float64
        From the origin, along the ray [m]; inf where nothing was met.
    points_m : (R, 3) float64
        Where it was met, in the world [m]; NaN where nothing was.
    normals : (R, 3) float64
        Unit normal of the triangle there, in the world, towards the ray's origin; 0 where nothing
        was met.
    """

    instance_ids: NDArray[np.uint16]
    distances_m: NDArray[np.float64]
    points_m: NDArray[np.float64]
    normals: NDArray[np.float64]
