"""Back-to-back faces: sheets of two layers in one place. From `StaticGeometry` to pairs.

A ray meets either layer by chance; the one that faces it is meant.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.rays.static_geometry import StaticGeometry

__all__ = ["BackToBack", "back_to_back_faces"]

GRID_M = 1e-4
"""Corners this near to each other are one."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class BackToBack:
    """Triangles that lie on one another and face opposite ways.

    Attributes
    ----------
    other : (T,) int32
        The triangle behind each triangle, -1 if it has none.
    corner : (T, 3) int32
        Which corner of that one each corner lies on.
    """

    other: NDArray[np.int32]
    corner: NDArray[np.int32]


def back_to_back_faces(geometry: StaticGeometry) -> BackToBack:
    """Find them among the solid triangles."""
    count = geometry.triangle_count
    other, corner = np.full(count, -1, np.int32), np.zeros((count, 3), np.int32)
    if not count:
        return BackToBack(other=other, corner=corner)
    cells = np.round(geometry.corners / GRID_M).astype(np.int64)
    # One number per corner; what few corners share one by chance is told apart by the faces.
    names = (cells * np.array([1, 2_097_169, 4_398_050_705_407])).sum(axis=2)
    order = np.argsort(names, axis=1, kind="stable")
    sorted_names = np.take_along_axis(names, order, axis=1)
    turns = np.lexsort((np.arange(count), *sorted_names.T[::-1]))
    a, b = turns[:-1], turns[1:]
    same = (sorted_names[a] == sorted_names[b]).all(axis=1)
    same &= np.einsum("tx,tx->t", geometry.faces[a], geometry.faces[b]) < -0.99
    same &= geometry.solid[a] & geometry.solid[b]
    for one, two in ((a[same], b[same]), (b[same], a[same])):
        other[one] = two
        np.put_along_axis(matched := corner[one], order[one], order[two].astype(np.int32), axis=1)
        corner[one] = matched
    return BackToBack(other=other, corner=corner)
