"""The texels of light maps: which triangles they stand for, and filters over them.

By src/kernels/texel_coverage.cpp and texel_filters.cpp; see `light.bake.texels`,
`light.bake.sun_edges` and `light.bake.denoise`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.bake_types import TexelMap
from sailenv_ros.native.library import Kernel, checked

__all__ = [
    "BLOCK_POINTS",
    "bordered_blocks",
    "cover_texels",
    "denoise_texels",
    "dilate_texels",
    "nearest_triangles",
    "texel_stand_ins",
]

Floats = NDArray[np.float32]
Integers = NDArray[np.int32]

BLOCK_POINTS = 4
"""Points of a texel's block along a side; `SIDE` of texel_coverage.cpp."""

_COVER = Kernel("cover_texels", "iinaaaa")
_NEAREST = Kernel("nearest_triangles", "aaiaiaaa")
_BORDERED = Kernel("bordered_blocks", "aaa")
_DENOISE = Kernel("denoise_texels", "iaiaaaa")
_DILATE = Kernel("dilate_texels", "aiaaiaa")
_STAND_INS = Kernel("texel_stand_ins", "aiaaaa")


def cover_texels(places: Floats, side: int, reach: float) -> tuple[Integers, Floats]:
    """Find the triangle that each texel of a map stands for: the nearest within reach.

    Parameters
    ----------
    places : (T, 3, 2) float32
        Of the triangles' corners in the map, x then y [texels].
    side : int
        Of the map [texels].
    reach : float
        From a texel's centre [texels].

    Returns
    -------
    owner : (side, side) int32
        -1 where there is none.
    weights : (side, side, 3) float32
        Of the triangle's corners, at its point nearest to the texel's centre.
    """
    checked("places", places, np.float32, (None, 3, 2))
    owner = np.full((side, side), -1, np.int32)
    weights = np.zeros((side, side, 3), np.float32)
    nearest = np.full((side, side), reach * reach, np.float32)
    _COVER(len(places), side, reach, places, owner, weights, nearest)
    return owner, weights


def nearest_triangles(
    texels: TexelMap, triangles: Integers, places: Floats, chosen: NDArray[np.int64]
) -> tuple[Integers, Floats]:
    """Find what `BLOCK_POINTS` by `BLOCK_POINTS` points of some texels stand for.

    Parameters
    ----------
    triangles : (N,) int32
        Of the map's texels.
    places : (T, 3, 2) float32
        Of the triangles' corners in the map [texels].
    chosen : (K,) int64
        Numbers of the texels.

    Returns
    -------
    triangle : (16 K,) int32
    weights : (16 K, 3) float32
        Of its corners.
    """
    checked("triangles", triangles, np.int32, (texels.count,))
    checked("places", places, np.float32, (None, 3, 2))
    checked("chosen texels", chosen, np.int64, (None,))
    points = len(chosen) * BLOCK_POINTS**2
    triangle, weights = np.zeros(points, np.int32), np.zeros((points, 3), np.float32)
    _NEAREST(
        texels.record, triangles, len(places), places, len(chosen), chosen, triangle, weights
    )  # fmt: skip
    return triangle, weights


def bordered_blocks(texels: TexelMap, shares: Floats) -> Floats:
    """Return (N, 6, 6) float32: blocks with borders, from neighbours where the surface continues.

    Parameters
    ----------
    shares : (N, 4, 4) float32
    """
    side = BLOCK_POINTS
    checked("shares", shares, np.float32, (texels.count, side, side))
    blocks = np.empty((texels.count, side + 2, side + 2), np.float32)
    _BORDERED(texels.record, shares, blocks)
    return blocks


def denoise_texels(
    texels: TexelMap, values: Floats, valid: NDArray[np.bool_], nearness: Floats, *, threads: int
) -> Floats:
    """Return (N, C) float32: values averaged over tiles of 4 by 4 texels, twice.

    Parameters
    ----------
    values : (N, C) float32
    valid : (N,) bool
        Others keep their values and are not looked at.
    nearness : (N,) float32
        Over how far light changes there [m].
    """
    checked("values", values, np.float32, (texels.count, None))
    checked("valid texels", valid, np.bool_, (texels.count,))
    checked("nearness", nearness, np.float32, (texels.count,))
    result = values.copy()
    if values.size:
        _DENOISE(threads, texels.record, values.shape[1], values, valid, nearness, result)
    return result


def dilate_texels(texels: TexelMap, values: Floats, valid: NDArray[np.bool_], steps: int) -> Floats:
    """Return (N, C) float32: others than the valid texels have the means of their neighbours.

    Parameters
    ----------
    values : (N, C) float32
    valid : (N,) bool
    steps : int
        How far [texels].
    """
    checked("values", values, np.float32, (texels.count, None))
    checked("valid texels", valid, np.bool_, (texels.count,))
    values, known = values.copy(), valid.copy()
    for _ in range(steps):
        unknown = np.flatnonzero(~known).astype(np.int32)
        if not unknown.size or not values.size:
            break
        before = known.copy()
        _DILATE(
            texels.record, len(unknown), unknown, before, values.shape[1], known, values
        )  # fmt: skip
    return values


def texel_stand_ins(texels: TexelMap, valid: NDArray[np.bool_], steps: int) -> Integers:
    """Return (N,) int32: the valid texel nearest to each one, up to some steps away, else itself.

    Parameters
    ----------
    valid : (N,) bool
    steps : int
    """
    checked("valid texels", valid, np.bool_, (texels.count,))
    found, known = np.arange(texels.count, dtype=np.int32), valid.copy()
    for _ in range(steps):
        unknown = np.flatnonzero(~known).astype(np.int32)
        before = known.copy()
        _STAND_INS(texels.record, len(unknown), unknown, before, known, found)
    return found
