"""Evenly spread points and directions. Nothing in but how many; knows no scene."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "TURN",
    "fibonacci_sphere",
    "in_turns",
    "low_discrepancy_points",
    "sequence_points",
]

Floats = NDArray[np.float32]


TURN = 16
"""Points of a net that are enough by themselves; see `in_turns`."""


@lru_cache(maxsize=32)
def low_discrepancy_points(count: int) -> Floats:
    """Return (count, 2) float32: points of the unit square, one in each of its even parts.

    The array is shared, and cannot be written to.

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
    points = np.stack([first, second], axis=1).astype(np.float32)
    points.flags.writeable = False
    return points


def in_turns(pattern: Floats) -> Floats:
    """Return a net in another order: each `TURN` points on end are one in each of as many cells."""
    cells = np.floor(pattern * np.sqrt(TURN)).astype(np.intp)
    cell = cells[:, 0] * int(np.sqrt(TURN)) + cells[:, 1]
    by_cell = np.argsort(cell, kind="stable")
    if len(pattern) <= TURN:
        return pattern
    # Which of a cell's points comes first turns with the cell, so that no turn leans to a side.
    number = np.arange(len(pattern)) % (len(pattern) // TURN)
    number = (number + cell[by_cell]) % (len(pattern) // TURN)
    return pattern[by_cell[np.lexsort((cell[by_cell], number))]]


@lru_cache(maxsize=32)
def sequence_points(count: int) -> Floats:
    """Return (count, 2) float32: points of the unit square, of which the first ones are even, too.

    Each power of two of them from the first on have one in each strip of that share of the square,
    along either side. The array is shared, and cannot be written to.

    The first two dimensions of the sequence of Sobol (1967), after Kollig and Keller (2002),
    "Efficient multidimensional sampling", moved to the middles of the intervals of all.
    """
    index = np.arange(count, dtype=np.uint64)
    points = np.zeros((count, 2), np.uint64)
    first = second = np.uint64(1 << 31)
    for bit in range(32):
        wanted = (index >> np.uint64(bit)) & np.uint64(1)
        points[:, 0] ^= wanted * first
        points[:, 1] ^= wanted * second
        first, second = first >> np.uint64(1), second ^ (second >> np.uint64(1))
    middle = 0.5 / 2.0 ** max(int(count - 1).bit_length(), 0)
    made = (points / 2.0**32 + middle).astype(np.float32)
    made.flags.writeable = False
    return made


def fibonacci_sphere(count: int) -> Floats:
    """Return (count, 3) float32: unit vectors spread evenly over the sphere."""
    index = np.arange(count) + 0.5
    z = 1.0 - 2.0 * index / count
    radius = np.sqrt(1.0 - z * z)
    turn = index * (np.pi * (3.0 - np.sqrt(5.0)))
    return np.stack([radius * np.cos(turn), radius * np.sin(turn), z], axis=1).astype(np.float32)
