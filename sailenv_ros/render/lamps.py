"""Which lamps are drawn in real time, and with what power: the same for every back end."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.lights import Light
from sailenv_ros.render.lightmap_compositing import strength

__all__ = ["LAMP_KINDS", "MAX_LIGHTS", "lamp_power", "strongest_lamps"]

MAX_LIGHTS = 16
"""Lights that are taken into account, the strongest first."""

LAMP_KINDS = {"directional": 0.0, "point": 1.0, "spot": 2.0, "area": 3.0}
"""Numbers by which kernels tell kinds of lamps apart."""


def strongest_lamps(lamps: Iterable[Light]) -> list[Light]:
    """Return the lamps that shine, the strongest first, at most `MAX_LIGHTS`."""
    shining = [light for light in lamps if light.intensity > 0.0]
    return sorted(shining, key=strength, reverse=True)[:MAX_LIGHTS]


def lamp_power(light: Light) -> NDArray[np.float64]:
    """Return (3,) float64: radiant intensity [W/sr] of each colour (irradiance, if directional)."""
    power: NDArray[np.float64] = np.asarray(light.colour) * light.intensity
    if light.type == "area":
        # Seen from afar an area light is a point with the area's radiant intensity.
        power = power * light.width_m * light.height_m
    return power
