"""How far neighbouring texels move their patterns of rays. Knows no scene.

Everything is deterministic: neighbouring texels of a tile of 4 by 4 take shifted copies of one
pattern, which together are a pattern 16 times as fine, so that averaging over tiles leaves no
noise (interleaved sampling, Keller and Heidrich 2001).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["pass_shift", "tile_shift"]

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
