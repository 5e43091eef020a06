"""Patterns of rays for neighbouring texels. From `ray_patterns` to shifted ones; knows no scene.

Everything is deterministic: neighbouring texels of a tile of 4 by 4 take shifted copies of one
pattern, which together are a pattern 16 times as fine, so that averaging over tiles leaves no
noise (interleaved sampling, Keller and Heidrich 2001).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["pass_shift", "shifted", "tile_shift"]

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
