"""A catalogue's material and its finish → the physically based material of the pack."""

from __future__ import annotations

import dataclasses

import numpy as np

from sailenv_content.standard.patterns import PATTERNS, pattern_maps
from sailenv_ros.assets.finishes import FINISHES, Finish
from sailenv_ros.types.model import Material

__all__ = ["finished"]

Vector3 = tuple[float, float, float]

_STEEL = (0.56, 0.55, 0.53)


def finished(
    material: Material,
    kind: str | None,
    *,
    colour: Vector3 | None = None,
    roughness: float | None = None,
    metallic: float | None = None,
    pattern: str | None = None,
) -> Material:
    """Return a material as its kind is, with what the recipe says besides.

    Parameters
    ----------
    kind : str or None
        In `FINISHES`; None keeps the catalogue's roughness.
    colour : (3,) tuple of float or None
        Linear; replaces colour and picture.
    """
    finish = FINISHES[kind] if kind else Finish(roughness=max(material.roughness, 0.3))
    bare = finish.metallic > 0.5
    if colour is not None:
        material = dataclasses.replace(material, base_colour_texture=None)
    elif finish.colour is not None:
        colour = finish.colour
        material = dataclasses.replace(material, base_colour_texture=None)
    elif bare and material.base_colour_texture is None and _is_grey(material):
        colour = _STEEL
    red, green, blue = material.base_colour[:3] if colour is None else colour
    material = _patterned(material, finish.pattern if pattern is None else pattern)
    return dataclasses.replace(
        material,
        base_colour=(red, green, blue, 1.0),
        roughness=finish.roughness if roughness is None else roughness,
        metallic=finish.metallic if metallic is None else metallic,
        alpha="mask" if material.alpha == "mask" else "opaque",
        double_sided=material.double_sided or finish.sheet,
    )


def _is_grey(material: Material) -> bool:
    """Tell if a metal has only a stand-in for its colour, and is not painted black."""
    colour = np.asarray(material.base_colour[:3])
    return bool(np.ptp(colour) < 0.15 * colour.max() and colour.max() > 0.15)


def _patterned(material: Material, pattern: str) -> Material:
    """Return a material that has no picture a fine structure."""
    if not pattern or material.base_colour_texture is not None:
        return material
    maps = pattern_maps(PATTERNS[pattern])
    return dataclasses.replace(
        material,
        base_colour_texture=maps["base_colour_texture"],
        normal_texture=maps.get("normal_texture"),
    )
