"""Denoises light within charts, and dilates it into texels that have none.

From values at texels to values at texels. Knows neither rays nor lights.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.texels import Texels
from sailenv_ros.native.texel_kernels import denoise_texels, dilate_texels, texel_stand_ins
from sailenv_ros.rays.static_geometry import StaticGeometry

__all__ = ["denoised", "dilated", "stand_ins"]

Floats = NDArray[np.float32]

DILATIONS = 12
"""Number of texels by which light is dilated into regions inside of solids."""

STAND_INS = 2
"""Number of texels beside the inside of a solid in which rays that hit it find light."""


def denoised(
    geometry: StaticGeometry,
    texels: Texels,
    values: Floats,
    valid: NDArray[np.bool_],
    nearness: Floats,
    workers: int = 1,
) -> Floats:
    """Average over tiles of 4 by 4 texels, twice, as far as the surface continues.

    Where other things are near either texel, light changes quickly: there it is averaged over
    less.

    Parameters
    ----------
    values : (N, C) float32
    valid : (N,) bool
    nearness : (N,) float32
        Harmonic mean of the distances of what each texel sees [m].
    """
    of_map = texels.of_map(geometry.owner[texels.triangle])
    return denoise_texels(of_map, values, valid, nearness, threads=workers)


def dilated(
    geometry: StaticGeometry, texels: Texels, values: Floats, valid: NDArray[np.bool_]
) -> Floats:
    """Return texels inside of other things what their neighbours of the same surface have."""
    of_map = texels.of_map(geometry.owner[texels.triangle])
    return dilate_texels(of_map, values, valid, DILATIONS)


def stand_ins(
    texels: Texels, owner: NDArray[np.int32], valid: NDArray[np.bool_]
) -> NDArray[np.int32]:
    """Return (N,) int32: which texel has the light that rays to each one meet, mostly its own.

    The middle of a texel may lie inside of other things though a corner of it is seen: along the
    edge of a ceiling that continues above the walls. Light knows nothing of such a texel; its
    nearest neighbour of the same surface stands for it. One that has none near stands for itself.

    Parameters
    ----------
    owner : (N,) int32
        The instance of each texel.
    valid : (N,) bool
        False inside of other things.
    """
    return texel_stand_ins(texels.of_map(owner), valid, STAND_INS)
