"""Denoises light within charts, and dilates it into texels that have none.

From values at texels to values at texels. Knows neither rays nor lights.
"""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.rays import in_chunks
from sailenv_ros.light.bake.static_geometry import StaticGeometry
from sailenv_ros.light.bake.texels import Texels

__all__ = ["denoised", "dilated", "stand_ins"]

Floats = NDArray[np.float32]

CHUNK_TEXELS = 32_768

DILATIONS = 12
"""How many texels light is dilated into what lies inside of other things."""

STAND_INS = 2
"""How many texels rays that meet what lies inside of other things find light beside it."""


def denoised(
    geometry: StaticGeometry,
    texels: Texels,
    values: Floats,
    valid: NDArray[np.bool_],
    nearness: Floats,
    workers: int = 1,
) -> Floats:
    """Average over tiles of 4 by 4 texels, twice, as far as the surface goes on.

    Where other things are near, light changes quickly: there it is averaged over less.

    Parameters
    ----------
    values : (N, C) float32
    valid : (N,) bool
    nearness : (N,) float32
        Harmonic mean of the distances of what each texel sees [m].
    """
    result = values.copy()
    owner = geometry.owner[texels.triangle]

    def denoise(first: int, end: int) -> None:
        _denoise(
            texels.index, texels.rows, texels.columns, owner, texels.positions, texels.normals,
            values, valid, nearness, result, first, end,
        )  # fmt: skip

    in_chunks(denoise, texels.count, CHUNK_TEXELS, workers)
    return result


def dilated(
    geometry: StaticGeometry, texels: Texels, values: Floats, valid: NDArray[np.bool_]
) -> Floats:
    """Return texels inside of other things what their neighbours of the same surface have."""
    values, known = values.copy(), valid.copy()
    owner = geometry.owner[texels.triangle]
    for _ in range(DILATIONS):
        before = known.copy()
        unknown = np.flatnonzero(~known).astype(np.int32)
        if not len(unknown):
            break
        _dilate(
            texels.index, texels.rows, texels.columns, owner, texels.faces,
            unknown, before, known, values,
        )  # fmt: skip
    return values


def stand_ins(
    texels: Texels, owner: NDArray[np.int32], valid: NDArray[np.bool_]
) -> NDArray[np.int32]:
    """Return (N,) int32: which texel has the light that rays to each one meet, mostly its own.

    The middle of a texel may lie inside of other things though a corner of it is seen: along the
    edge of a ceiling that goes on above the walls. Light knows nothing of such a texel; its nearest
    neighbour of the same surface stands for it. One that has none near stands for itself.

    Parameters
    ----------
    owner : (N,) int32
        The instance of each texel.
    valid : (N,) bool
        False inside of other things.
    """
    found = np.arange(texels.count, dtype=np.int32)
    known = valid.copy()
    for _ in range(STAND_INS):
        unknown = np.flatnonzero(~known).astype(np.int32)
        before = known.copy()
        _find_stand_ins(
            texels.index, texels.rows, texels.columns, owner, texels.faces, texels.positions,
            unknown, before, known, found,
        )  # fmt: skip
    return found


@numba.njit(cache=True, nogil=True)
def _neighbour(index, row, column, owner, faces, known, k):  # type: ignore[no-untyped-def]
    """Return the texel at a place of the map if it is known and of texel k's surface, else -1."""
    height, width = index.shape
    if row < 0 or row >= height or column < 0 or column >= width:
        return -1
    other = index[row, column]
    if other < 0 or not known[other] or owner[other] != owner[k]:
        return -1
    alike = 0.0
    for c in range(3):
        alike += faces[other, c] * faces[k, c]
    return other if alike > 0.5 else -1


@numba.njit(cache=True, nogil=True)
def _find_stand_ins(  # type: ignore[no-untyped-def]
    index, rows, columns, owner, faces, positions, unknown, before, known, found
):
    for place in range(len(unknown)):
        k = unknown[place]
        nearest = np.inf
        for down in range(-1, 2):
            for right in range(-1, 2):
                other = _neighbour(
                    index, rows[k] + down, columns[k] + right, owner, faces, before, k
                )
                if other < 0:
                    continue
                far2 = 0.0
                for c in range(3):
                    far2 += (positions[found[other], c] - positions[k, c]) ** 2
                if far2 < nearest:
                    nearest = far2
                    known[k] = True
                    found[k] = found[other]


@numba.njit(cache=True, nogil=True)
def _denoise(  # type: ignore[no-untyped-def]
    index, rows, columns, owner, positions, normals, values, valid, nearness, result, start, end
):
    height, width = index.shape
    channels = values.shape[1]
    total = np.empty(channels, np.float32)
    for k in range(start, end):
        if not valid[k]:
            continue
        total[:] = 0.0
        weights = 0.0
        scale = 2.0 / max(nearness[k] * nearness[k], 1e-6)
        for down in range(-3, 4):
            row = rows[k] + down
            if row < 0 or row >= height:
                continue
            for right in range(-3, 4):
                column = columns[k] + right
                if column < 0 or column >= width:
                    continue
                other = index[row, column]
                if other < 0 or not valid[other] or owner[other] != owner[k]:
                    continue
                alike = 0.0
                far2 = 0.0
                off = 0.0
                for c in range(3):
                    alike += normals[other, c] * normals[k, c]
                    step = positions[other, c] - positions[k, c]
                    far2 += step * step
                    off += step * normals[k, c]
                if alike < 0.8 or far2 > 0.04 or off * off > 0.1 * far2 + 1e-8:
                    continue
                weight = (4 - abs(down)) * (4 - abs(right)) * alike * np.exp(-far2 * scale)
                weights += weight
                for c in range(channels):
                    total[c] += weight * values[other, c]
        if weights > 0.0:  # else another stands at its place
            for c in range(channels):
                result[k, c] = total[c] / weights


@numba.njit(cache=True, nogil=True)
def _dilate(  # type: ignore[no-untyped-def]
    index, rows, columns, owner, faces, unknown, before, known, values
):
    channels = values.shape[1]
    total = np.empty(channels, np.float32)
    for place in range(len(unknown)):
        k = unknown[place]
        total[:] = 0.0
        found = 0
        for down in range(-1, 2):
            for right in range(-1, 2):
                other = _neighbour(
                    index, rows[k] + down, columns[k] + right, owner, faces, before, k
                )
                if other >= 0:
                    found += 1
                    for c in range(channels):
                        total[c] += values[other, c]
        if found:
            known[k] = True
            for c in range(channels):
                values[k, c] = total[c] / found
