"""How large lights are, whose shadows are worked out beforehand."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.lights import Light

__all__ = ["LAMP_RADIUS_M", "SUN_DISC_RADIUS", "SUN_RADIUS", "area_sides"]

SUN_RADIUS = math.tan(math.radians(0.4))
"""Of a directional light's disc at a distance of 1, for texels: shadows end as they are wide."""

SUN_DISC_RADIUS = math.tan(math.radians(0.265))
"""The sun's own, for `SunEdges`."""

LAMP_RADIUS_M = 0.03
"""Of point and spot lights, for their shadows' edges alone."""


def area_sides(light: Light) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the vectors along an area light's width and height, as long as these are.

    The width is horizontal; of a light that shines straight up or down it lies along y.
    """
    forward = np.asarray(light.direction)
    across = np.array([-forward[1], forward[0], 0.0])
    if np.linalg.norm(across) < 1e-6:
        across = np.array([0.0, 1.0, 0.0])
    across /= np.linalg.norm(across)
    return across * light.width_m, np.cross(forward, across) * light.height_m
