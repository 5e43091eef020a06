"""Patterns of rays for neighbouring texels. From `ray_patterns` to directions; knows no scene.

Everything is deterministic: neighbouring texels of a tile of 4 by 4 take shifted copies of one
pattern, which together are a pattern 16 times as fine, so that averaging over tiles leaves no
noise (interleaved sampling, Keller and Heidrich 2001).
"""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

__all__ = [
    "around_axis",
    "hemisphere_rays",
    "pass_shift",
    "shifted",
    "shifted_point",
    "tile_shift",
]

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
def shifted_point(point, shift, cells):  # type: ignore[no-untyped-def]
    """Return u, v: one point of a net moved within its own cell, as `shifted` does."""
    u, v = point[0] * cells, point[1] * cells
    left, low = np.floor(u), np.floor(v)
    u, v = u - left + shift[0], v - low + shift[1]
    return (left + u - np.floor(u)) / cells, (low + v - np.floor(v)) / cells


@numba.njit(cache=True, nogil=True)
def around_axis(ax, ay, az, x, y, z):  # type: ignore[no-untyped-def]
    """Return a direction that is given about z, about a unit axis instead.

    Duff and others 2017, "Building an orthonormal basis, revisited".
    """
    sign = 1.0 if az >= 0.0 else -1.0
    a = -1.0 / (sign + az)
    b = ax * ay * a
    dx = x * (1.0 + sign * ax * ax * a) + y * b + z * ax
    dy = x * sign * b + y * (sign + ay * ay * a) + z * ay
    dz = -x * sign * ax - y * ay + z * az
    return dx, dy, dz


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
        for m in range(len(pattern)):
            u, v = shifted_point(pattern[m], shifts[k], cells)
            radius = np.sqrt(u)
            x, y = radius * np.cos(2.0 * np.pi * v), radius * np.sin(2.0 * np.pi * v)
            z = np.sqrt(max(1.0 - u, 0.0))
            dx, dy, dz = around_axis(nx, ny, nz, x, y, z)
            below = dx * faces[k, 0] + dy * faces[k, 1] + dz * faces[k, 2]
            if below < 0.0:
                dx -= 2.0 * below * faces[k, 0]
                dy -= 2.0 * below * faces[k, 1]
                dz -= 2.0 * below * faces[k, 2]
            directions[k, m, 0] = dx
            directions[k, m, 1] = dy
            directions[k, m, 2] = dz
