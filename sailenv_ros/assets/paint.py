"""Painting: a model with one colour, metalness or roughness instead of its own.

Models are compared by identity, so equal paint on the same model gives the same object.
"""

from __future__ import annotations

import dataclasses
import threading
import weakref

from sailenv_ros.types.model import Material, Model, Texture

__all__ = ["painted", "painted_material"]

Vector3 = tuple[float, float, float]
_Paint = tuple[Vector3 | None, float | None, float | None]

_lock = threading.Lock()
_cache: weakref.WeakKeyDictionary[Model, weakref.WeakValueDictionary[_Paint, Model]] = (
    weakref.WeakKeyDictionary()
)
"""Painted models while they are used: colours that change from frame to frame must not add up."""


def painted(
    model: Model,
    *,
    colour: Vector3 | None = None,
    metallic: float | None = None,
    roughness: float | None = None,
) -> Model:
    """Return a model painted over; ``None`` leaves a property as it is.

    Parameters
    ----------
    model : Model
    colour : (3,) tuple of float or None
        Linear red, green, blue, 0 to 1; replaces colour textures but keeps their alpha where a
        material is cut out or transparent.
    metallic, roughness : float or None
        0 to 1; either one replaces the metallic-roughness texture.

    Returns
    -------
    model : Model
        The given model if nothing is painted; else the same object for the same paint.
    """
    paint = (colour, metallic, roughness)
    if paint == (None, None, None):
        return model
    with _lock:
        variants = _cache.setdefault(model, weakref.WeakValueDictionary())
        found = variants.get(paint)
        if found is None:
            parts = tuple(
                dataclasses.replace(part, material=painted_material(part.material, *paint))
                for part in model.parts
            )
            found = variants[paint] = Model(name=model.name, parts=parts)
        return found


def painted_material(
    material: Material, colour: Vector3 | None, metallic: float | None, roughness: float | None
) -> Material:
    """Return a material painted over; see `painted`."""
    if colour is not None:
        red, green, blue = colour
        material = dataclasses.replace(
            material,
            base_colour=(red, green, blue, material.base_colour[3]),
            base_colour_texture=_outline(material),
        )
    if metallic is not None or roughness is not None:
        # What is not given keeps its mean where the texture of both goes.
        own_roughness, own_metallic = _means(material)
        material = dataclasses.replace(
            material,
            metallic=own_metallic if metallic is None else metallic,
            roughness=own_roughness if roughness is None else roughness,
            metallic_roughness_texture=None,
        )
    return material


def _means(material: Material) -> tuple[float, float]:
    """Return the mean roughness and metallic, their texture included."""
    texture = material.metallic_roughness_texture
    if texture is None:
        return material.roughness, material.metallic
    roughness, metallic = (float(texture[..., channel].mean()) / 255.0 for channel in (1, 2))
    return material.roughness * roughness, material.metallic * metallic


def _outline(material: Material) -> Texture | None:
    """Keep a texture's alpha where it cuts a shape out (leaves, strings), in white."""
    texture = material.base_colour_texture
    if texture is None or material.alpha == "opaque":
        return None
    white = texture.copy()
    white[..., :3] = 255
    white.flags.writeable = False
    return white
