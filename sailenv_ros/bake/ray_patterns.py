"""Evenly spread points and directions. Nothing in but how many; knows no scene."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["fibonacci_sphere", "net"]

Floats = NDArray[np.float32]


def net(count: int) -> Floats:
    """Return (count, 2) float32: points of the unit square, one in each of its even parts.

    Of a square of a power of two there is one in each of as many square cells.

    The set of Hammersley (1960) in base 2, moved to the middles of its intervals.
    """
    index = np.arange(count, dtype=np.uint64)
    bits = max(int(count - 1).bit_length(), 1)
    mirrored = np.zeros(count, dtype=np.uint64)
    for bit in range(bits):
        mirrored |= ((index >> np.uint64(bit)) & np.uint64(1)) << np.uint64(bits - 1 - bit)
    first = (index + 0.5) / count
    second = (mirrored + 0.5) / 2.0**bits
    return np.stack([first, second], axis=1).astype(np.float32)


def fibonacci_sphere(count: int) -> Floats:
    """Return (count, 3) float32: unit vectors spread evenly over the sphere."""
    index = np.arange(count) + 0.5
    z = 1.0 - 2.0 * index / count
    radius = np.sqrt(1.0 - z * z)
    turn = index * (np.pi * (3.0 - np.sqrt(5.0)))
    return np.stack([radius * np.cos(turn), radius * np.sin(turn), z], axis=1).astype(np.float32)
