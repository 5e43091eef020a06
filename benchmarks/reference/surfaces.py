"""Materials as Mitsuba describes them; metallic-roughness is a BSDF of our own (lit_surface.py).

A `Material` in, a dict for Mitsuba out; its textures go to `Parts`. Texture rows stay as they
are: Mitsuba reads row 0 at v = 0, for which `export` turns v around.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.reference.parts import Parts
from sailenv_ros.types.colour import LINEAR_OF_SRGB8, srgb_from_linear
from sailenv_ros.types.model import Material

__all__ = ["bsdf", "emitter"]

LEAST_ROUGHNESS = 0.045
"""The renderer's own limit (textures.glsl)."""

Dict = dict[str, Any]


def bsdf(material: Material, parts: Parts) -> Dict:
    """Describe how a material reflects; seen from behind it looks alike.

    What is see-through (``blend``) is as the renderer has it (see_through.py).
    """
    if material.alpha == "blend":
        return _see_through(material, parts)
    if material.metallic == 1.0 and _is_plain(material) and material.roughness < LEAST_ROUGHNESS:
        # Silvered glass: at the least roughness the sun's glare would still hide what it shows.
        mirror = {"type": "conductor", "material": "none"}
        colour = _base_colour(material, parts)
        return {"type": "twosided", "bsdf": {**mirror, "specular_reflectance": colour}}
    inner: Dict = {
        "type": "sailenv_surface",
        "base_color": _base_colour(material, parts),
        "metallic": _finish(material, 2, material.metallic, 0.0, parts),
        "roughness": _finish(material, 1, material.roughness, LEAST_ROUGHNESS, parts),
    }
    if material.normal_texture is not None:
        bumps = _bitmap(_rgb(material.normal_texture), parts, raw=True)
        inner = {"type": "normalmap", "normalmap": bumps, "bsdf": inner}
    if material.alpha == "mask" and material.base_colour_texture is not None:
        return {"type": "mask", "opacity": _opacity(material, parts), "bsdf": inner}
    return inner


def _is_plain(material: Material) -> bool:
    """Return whether a material is opaque, without reliefs or a finish that varies."""
    textures = (material.metallic_roughness_texture, material.normal_texture)
    return material.alpha == "opaque" and all(texture is None for texture in textures)


def emitter(material: Material, parts: Parts) -> Dict | None:
    """Describe what a material emits, None if nothing; its texture has the glow's pattern."""
    glow = np.asarray(material.emission, dtype=np.float64)
    if glow.max() <= 0.0:
        return None
    if material.base_colour_texture is None:
        return {"type": "area", "radiance": _rgb_value(glow)}
    pattern = LINEAR_OF_SRGB8[material.base_colour_texture[..., :3]] * glow
    return {"type": "area", "radiance": _bitmap(pattern.astype(np.float32), parts, raw=True)}


def _see_through(material: Material, parts: Parts) -> Dict:
    """Describe a face; a ray meets two of a body, which together cover and tint as it says.

    Of what has two sides each is a sheet. A texture's opacity is its mean.
    """
    red, green, blue, opacity = (float(channel) for channel in material.base_colour)
    if material.base_colour_texture is not None:
        opacity *= float(material.base_colour_texture[..., 3].mean()) / 255.0
    colour = np.array([red, green, blue])
    hue = colour / max(float(colour.max()), 1e-3)
    part = 1.0 if material.double_sided else 0.5
    faces = 2.0 if material.double_sided else 1.0
    return {
        "type": "sailenv_see_through",
        "base_color": _base_colour(material, parts),
        "tint": _rgb_value((1.0 + opacity * (hue - 1.0)) ** part),
        "opacity": _rgb_value(np.full(3, 1.0 - (1.0 - min(opacity, 1.0)) ** part)),
        "faces": _rgb_value(np.full(3, 0.0 if material.is_veil else faces)),
    }


def _base_colour(material: Material, parts: Parts) -> Dict:
    factor = np.clip(np.asarray(material.base_colour[:3], dtype=np.float64), 0.0, 1.0)
    texture = material.base_colour_texture
    if texture is None:
        return _rgb_value(factor)
    if (factor > 0.999).all():
        return _bitmap(_rgb(texture), parts, raw=False)
    shaded = srgb_from_linear(LINEAR_OF_SRGB8[texture[..., :3]] * factor)
    return _bitmap(np.rint(255.0 * shaded).astype(np.uint8), parts, raw=False)


def _finish(material: Material, channel: int, factor: float, least: float, parts: Parts) -> Dict:
    """Return metal or roughness: a number, or the texture's channel times its factor."""
    texture = material.metallic_roughness_texture
    if texture is None:
        return _rgb_value(np.full(3, np.clip(factor, least, 1.0)))
    scaled = np.clip(texture[..., channel].astype(np.float64) * factor, 255.0 * least, 255.0)
    return _bitmap(np.rint(scaled).astype(np.uint8)[..., None], parts, raw=True)


def _opacity(material: Material, parts: Parts) -> Dict:
    texture = material.base_colour_texture
    assert texture is not None
    shown = texture[..., 3] / 255.0 * material.base_colour[3] >= material.alpha_cutoff
    return _bitmap((255 * shown).astype(np.uint8)[..., None], parts, raw=True)


def _bitmap(pixels: NDArray[Any], parts: Parts, *, raw: bool) -> Dict:
    return {"type": "bitmap", "array": parts.array(np.ascontiguousarray(pixels)), "raw": raw}


def _rgb(texture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return texture[..., :3]


def _rgb_value(colour: NDArray[np.float64]) -> Dict:
    return {"type": "rgb", "value": [float(channel) for channel in colour]}
