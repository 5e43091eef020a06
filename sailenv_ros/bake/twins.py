"""Sheets made of two layers in one place, one facing each way. From `Scenery` to pairs.

A ray meets either layer by chance; the one that faces it is meant.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.bake.scenery import Scenery

__all__ = ["Twins", "twins_of"]

GRID_M = 1e-4
"""Corners this near to each other are one."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Twins:
    """Which triangle lies on which, facing the other way.

    Attributes
    ----------
    other : (T,) int32
        The twin of each triangle, -1 if it has none.
    corner : (T, 3) int32
        Which corner of the twin each corner lies on.
    """

    other: NDArray[np.int32]
    corner: NDArray[np.int32]


def twins_of(scenery: Scenery) -> Twins:
    """Find them among the solid triangles."""
    count = scenery.triangle_count
    other, corner = np.full(count, -1, np.int32), np.zeros((count, 3), np.int32)
    if not count:
        return Twins(other=other, corner=corner)
    cells = np.round(scenery.corners / GRID_M).astype(np.int64)
    # One number per corner; what few corners share one by chance is told apart by the faces.
    names = (cells * np.array([1, 2_097_169, 4_398_050_705_407])).sum(axis=2)
    order = np.argsort(names, axis=1, kind="stable")
    sorted_names = np.take_along_axis(names, order, axis=1)
    turns = np.lexsort((np.arange(count), *sorted_names.T[::-1]))
    a, b = turns[:-1], turns[1:]
    same = (sorted_names[a] == sorted_names[b]).all(axis=1)
    same &= np.einsum("tx,tx->t", scenery.faces[a], scenery.faces[b]) < -0.99
    same &= scenery.solid[a] & scenery.solid[b]
    for one, two in ((a[same], b[same]), (b[same], a[same])):
        other[one] = two
        np.put_along_axis(matched := corner[one], order[one], order[two].astype(np.int32), axis=1)
        corner[one] = matched
    return Twins(other=other, corner=corner)
