"""Numbers of a material by which shading multiplies its textures.

Knows no graphics library: every back end shades with the same numbers.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sailenv_ros.render.scene.coverage import cutoff_by_level
from sailenv_ros.render.scene.texture_images import SIZES_PX, array_of
from sailenv_ros.types.lights import Light
from sailenv_ros.types.model import Material

__all__ = ["EMISSION_SCALE", "MaterialFactors", "glow_alone", "material_factors"]

EMISSION_SCALE = 16.0
"""Radiance, in units of the base colour, that the G-buffer's 8 bits can hold."""


DARKEST = 0.1
"""Brightness that the colour of what glows has at least: 8 bits hold few shades of black."""


@dataclass(frozen=True, slots=True)
class MaterialFactors:
    """The numbers of one material.

    Attributes
    ----------
    base : (3,) tuple of float
        Square root of linear base colour.
    colour : (4,) tuple of float
        The same, or that of the glow where there is one, and alpha.
    roughness, metallic : float
    alpha_cutoff : float
    emission : float
        Radiance over base colour, 0 to `EMISSION_SCALE`.
    cutoff_fall, least_cutoff : float
        See `coverage.cutoff_by_level`.
    """

    base: tuple[float, float, float]
    colour: tuple[float, float, float, float]
    roughness: float
    metallic: float
    alpha_cutoff: float
    emission: float
    cutoff_fall: float
    least_cutoff: float


def material_factors(
    material: Material, lamp_power: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> MaterialFactors:
    """Return the numbers of a material.

    Parameters
    ----------
    lamp_power : (3,) tuple of float
        Colour times intensity of the lights by which it glows; see `DrawnInstance.lamp_power`.
    """
    base = np.asarray(material.base_colour, dtype=np.float64)
    root_red, root_green, root_blue = (float(number) for number in np.sqrt(base[:3]))
    emission = np.asarray(material.emission) + np.multiply(material.glow, lamp_power)
    glow = float(emission.max())
    if glow > 0.0:
        # The G-buffer holds one colour and one strength: what glows has the glow's colour, about
        # as bright as its own, so that it gives back as much light.
        bright = float(min(1.0, max(base[:3].max(), DARKEST, glow / EMISSION_SCALE)))
        base[:3] = emission / glow * bright
        glow /= bright
    red, green, blue = (float(number) for number in np.sqrt(base[:3]))
    edge = SIZES_PX[array_of(material.base_colour_texture)]
    fall, least = cutoff_by_level(material, edge)
    return MaterialFactors(
        base=(root_red, root_green, root_blue),
        colour=(red, green, blue, float(base[3])),
        roughness=material.roughness,
        metallic=material.metallic,
        alpha_cutoff=material.alpha_cutoff,
        emission=min(EMISSION_SCALE, glow),
        cutoff_fall=fall,
        least_cutoff=least,
    )


def glow_alone(material: Material, light: Light) -> MaterialFactors:
    """Return the numbers of a lamp's material that emits nothing but what it does by one light."""
    return material_factors(replace(material, emission=(0.0, 0.0, 0.0)), light.power)
