"""Presence of the triangles of a masked material. From `Material` and uvs to booleans."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.model import Material

__all__ = ["is_mostly_there"]

_STEPS = 6
_GRID = [(i + 1 / 3, j + 1 / 3) for i in range(_STEPS) for j in range(_STEPS - i)]
"""Points spread over a triangle, as multiples of a step along its two sides."""


def is_mostly_there(material: Material, uvs: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Return for each triangle whether its mask leaves at least half of it.

    Parameters
    ----------
    material : Material
        With ``alpha = 'mask'``.
    uvs : (T, 3, 2) float32

    Returns
    -------
    (T,) bool
    """
    alpha = np.full(len(uvs), material.base_colour[3], dtype=np.float64)
    texture = material.base_colour_texture
    if texture is None:
        return alpha >= material.alpha_cutoff
    height, width = texture.shape[:2]
    there = np.zeros(len(uvs))
    for a, b in _GRID:
        p, q = a / _STEPS, b / _STEPS
        at = (1 - p - q) * uvs[:, 0] + p * uvs[:, 1] + q * uvs[:, 2]
        column = np.floor(at[:, 0] * width).astype(np.int64) % width
        row = np.floor((1.0 - at[:, 1]) * height).astype(np.int64) % height
        there += alpha * texture[row, column, 3] / 255.0 >= material.alpha_cutoff
    return there >= len(_GRID) / 2
