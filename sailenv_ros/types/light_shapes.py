"""How large lights are, whose shadows are computed beforehand, and how kernels take them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.ray_types import RAY_LIGHT
from sailenv_ros.native.render_types import record
from sailenv_ros.types.lights import Light, area_sides, lamp_rows

__all__ = ["LAMP_RADIUS_M", "SUN_DISC_RADIUS", "SUN_RADIUS", "light_record"]

SUN_RADIUS = math.tan(math.radians(0.4))
"""Radius of a directional light's disc at distance 1, for texels: their shadow edges are as
wide."""

SUN_DISC_RADIUS = math.tan(math.radians(0.265))
"""The sun's own, for `SunEdges`."""

LAMP_RADIUS_M = 0.03
"""Radius of point and spot lights, used for the edges of their shadows only."""


def light_record(light: Light, sun_radius: float = SUN_RADIUS) -> NDArray[np.void]:
    """Return (1,) RAY_LIGHT: a light as kernels look for it.

    Parameters
    ----------
    sun_radius : float
        Of a directional light's disc at a distance of 1.
    """
    row = record(RAY_LIGHT, lamp=lamp_rows([light])[0])
    if light.type == "area":
        row["across"][0], row["up"][0] = area_sides(light)
    else:
        row["radius"] = sun_radius if light.type == "directional" else LAMP_RADIUS_M
    return row
