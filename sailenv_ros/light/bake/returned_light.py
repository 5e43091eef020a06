"""Share of uniform ambient light that a surface reflects, by its material."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["BELOW", "GLOSS", "returned"]

BELOW = 0.9565
"""Share of the light from everywhere that meets the colour of something that is no metal."""

GLOSS = np.array(
    [0.0857, 0.0854, 0.0810, 0.0730, 0.0632, 0.0531, 0.0442, 0.0366, 0.0296, 0.0238, 0.0191]
)
"""Share that its surface gives back before, for roughness 0, 0.1 … 1: both are the lobes of
lighting.frag, integrated over the hemispheres of where light comes from and where it goes to."""


def returned(
    base: NDArray[np.floating], roughness: NDArray[np.floating], metallic: NDArray[np.floating]
) -> NDArray[np.float64]:
    """Return the share of the light from everywhere that a surface gives back to everywhere.

    Parameters
    ----------
    base : (N, 3) float
        Linear colour.
    roughness, metallic : (N, 1) or (1, 1) float
        Of a metal all microfacets together give back its colour.
    """
    gloss = np.interp(roughness, np.linspace(0.0, 1.0, len(GLOSS)), GLOSS)
    plain: NDArray[np.float64] = gloss + BELOW * base
    return plain + metallic * (base - plain)
