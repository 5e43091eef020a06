"""Patterns of rays for neighbouring texels. From `ray_patterns` to directions; knows no scene.

Everything is deterministic: neighbouring texels of a tile of 4 by 4 take shifted copies of one
pattern, which together are a pattern 16 times as fine, so that averaging over tiles leaves no
noise (interleaved sampling, Keller and Heidrich 2001).
"""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

__all__ = ["hemisphere_rays", "pass_shift", "shifted", "tile_shift"]

Floats = NDArray[np.float32]

_ORDER = np.array([0, 2, 1, 3], dtype=np.float32)
"""Neighbours in a tile take places far from each other."""


def tile_shift(rows: NDArray[np.int32], columns: NDArray[np.int32]) -> Floats:
    """Return (N, 2) float32: how far each texel moves a net's points, in sizes of cells."""
    shift = np.stack([_ORDER[columns & 3], _ORDER[rows & 3]], axis=1)
    return np.asarray(shift / 4.0, dtype=np.float32)


def pass_shift(number: int) -> tuple[float, float]:
    """Return how much farther points are moved in a pass, in sizes of cells.

    A tile's points lie a quarter of a cell apart. Those of further passes lie between them, so
    that all passes together fill the cells evenly; and what a texel gets in a pass lies far from
    what it got before.
    """
    x = y = 0.0
    half, between = 0.5, 0.125
    while number:
        right, up = number & 1, number >> 1 & 1
        x += between * right + half * (right ^ up)
        y += between * up + half * right
        half, between, number = half / 2.0, between / 2.0, number >> 2
    return x % 1.0, y % 1.0


def shifted(pattern: Floats, shifts: Floats) -> Floats:
    """Return (N, M, 2) float32: each point of a net moved within its own cell of the square.

    A net of M points has one in each of M square cells. Moved modulo the cell, the nets of a tile
    fill all cells evenly; moved modulo 1 they would leave gaps.
    """
    cells = np.float32(np.sqrt(len(pattern)))
    cell = np.floor(pattern * cells)
    inside = (pattern * cells - cell)[None] + shifts[:, None]
    return np.asarray((cell + inside - np.floor(inside)) / cells, dtype=np.float32)


@numba.njit(cache=True, nogil=True)
def hemisphere_rays(normals, faces, pattern, shifts, directions):  # type: ignore[no-untyped-def]
    """Fill in directions whose density is the cosine to the normal, over pi.

    Parameters
    ----------
    normals, faces : (N, 3) float32
        Directions that would run into the face are mirrored at it.
    pattern : (M, 2) float32
        A net of points of the unit square that become the directions; see `shifted`.
    shifts : (N, 2) float32
    directions : (N, M, 3) float32
        Filled in; unit length.
    """
    cells = np.sqrt(len(pattern))
    for k in range(len(normals)):
        nx, ny, nz = normals[k]
        # Duff and others 2017, "Building an orthonormal basis, revisited".
        sign = 1.0 if nz >= 0.0 else -1.0
        a = -1.0 / (sign + nz)
        b = nx * ny * a
        for m in range(len(pattern)):
            u, v = pattern[m, 0] * cells, pattern[m, 1] * cells
            left, low = np.floor(u), np.floor(v)
            u, v = u - left + shifts[k, 0], v - low + shifts[k, 1]
            u, v = (left + u - np.floor(u)) / cells, (low + v - np.floor(v)) / cells
            radius = np.sqrt(u)
            x, y = radius * np.cos(2.0 * np.pi * v), radius * np.sin(2.0 * np.pi * v)
            z = np.sqrt(max(1.0 - u, 0.0))
            dx = x * (1.0 + sign * nx * nx * a) + y * b + z * nx
            dy = x * sign * b + y * (sign + ny * ny * a) + z * ny
            dz = -x * sign * nx - y * ny + z * nz
            below = dx * faces[k, 0] + dy * faces[k, 1] + dz * faces[k, 2]
            if below < 0.0:
                dx -= 2.0 * below * faces[k, 0]
                dy -= 2.0 * below * faces[k, 1]
                dz -= 2.0 * below * faces[k, 2]
            directions[k, m, 0] = dx
            directions[k, m, 1] = dy
            directions[k, m, 2] = dz
