"""Where masked materials have a surface. From `Material` and texture coordinates to booleans.

There is one rule: at a point of a masked material there is a surface if the alpha of its base
colour, times that of the texel in which the point lies, is not below the cutoff. Rays that find
ground truth ask it of the point that they meet. Rays of light ask it of whole triangles, once and
not at every ray: a triangle stops light if the rule holds for half of it or more.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.model import Material

__all__ = ["mostly_opaque", "surface_at"]

_STEPS = 6
_SPOTS = [
    ((i + 1 / 3) / _STEPS, (j + 1 / 3) / _STEPS) for i in range(_STEPS) for j in range(_STEPS - i)
]
"""Points spread over a triangle, as weights of its second and third corner."""


def surface_at(
    material: Material, uv: NDArray[np.float32] | NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Return (R,) bool: whether a masked material has a surface at points.

    Parameters
    ----------
    material : Material
        With ``alpha = 'mask'``.
    uv : (R, 2) float32 or float64
        Texture coordinates; the texture repeats.
    """
    alpha = np.full(len(uv), material.base_colour[3], np.float64)
    texture = material.base_colour_texture
    if texture is not None:
        height, width = texture.shape[:2]
        column = np.floor(uv[:, 0] * width).astype(np.int64) % width
        row = np.floor((1.0 - uv[:, 1]) * height).astype(np.int64) % height
        alpha *= texture[row, column, 3] / 255.0
    return np.asarray(alpha >= material.alpha_cutoff)


def mostly_opaque(material: Material, uvs: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Return (T,) bool: whether a masked material has a surface on half of a triangle or more.

    Parameters
    ----------
    material : Material
        With ``alpha = 'mask'``.
    uvs : (T, 3, 2) float32
        Texture coordinates of the corners.
    """
    there = np.zeros(len(uvs))
    for p, q in _SPOTS:
        there += surface_at(material, (1 - p - q) * uvs[:, 0] + p * uvs[:, 1] + q * uvs[:, 2])
    return np.asarray(there >= len(_SPOTS) / 2)
