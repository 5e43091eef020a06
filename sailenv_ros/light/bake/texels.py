"""Which point of which triangle each texel of the light map stands for.

From `StaticGeometry` and `Layout` to `Texels`. Knows neither rays nor light.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.layout import Layout
from sailenv_ros.light.bake.static_geometry import StaticGeometry

__all__ = ["Texels", "closest_point", "off_the_edges", "rasterised"]

REACH = 1.5
"""Texels this near to a triangle stand for its nearest point: bilinear look-ups meet them."""

EDGE = 1e-3
"""Points of which a corner's weight is less lie on the edge."""

EDGE_M = 3e-3
"""How far they are moved in [m]."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Texels:
    """The texels in use, row by row.

    Attributes
    ----------
    index : (H, W) int32
        Place of each texel of the map in the arrays below, -1 where it is unused.
    rows, columns : (N,) int32
    triangle : (N,) int32
    weights : (N, 3) float32
        Of the triangle's corners.
    positions : (N, 3) float32
        World frame [m].
    normals : (N, 3) float32
        Of the smooth surface, unit length, towards the side that is lit.
    faces : (N, 3) float32
        Of the triangle, unit length, to the same side.
    """

    index: NDArray[np.int32]
    rows: NDArray[np.int32]
    columns: NDArray[np.int32]
    triangle: NDArray[np.int32]
    weights: NDArray[np.float32]
    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    faces: NDArray[np.float32]

    @property
    def count(self) -> int:
        """How many there are."""
        return len(self.triangle)


def rasterised(geometry: StaticGeometry, layout: Layout) -> Texels:
    """Find the texels that the charts cover, and those that touch them."""
    side = layout.side
    owner = np.full((side, side), -1, dtype=np.int32)
    weights = np.zeros((side, side, 3), dtype=np.float32)
    _cover(layout.places, owner, weights, np.full((side, side), REACH * REACH, dtype=np.float32))
    rows, columns = np.nonzero(owner >= 0)
    index = np.full((side, side), -1, dtype=np.int32)
    index[rows, columns] = np.arange(len(rows))
    triangle = owner[rows, columns]
    share = off_the_edges(geometry.corners[triangle], weights[rows, columns])
    faces = geometry.faces[triangle]
    normals = np.einsum("nc,ncx->nx", share, geometry.normals[triangle])
    # Normals that point through their own triangle are none.
    facing = np.einsum("nx,nx->n", normals, faces)
    normals[facing < 0.05] = faces[facing < 0.05]
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    return Texels(
        index=index,
        rows=rows.astype(np.int32),
        columns=columns.astype(np.int32),
        triangle=triangle,
        weights=share,
        positions=np.einsum("nc,ncx->nx", share, geometry.corners[triangle]),
        normals=normals,
        faces=faces,
    )


def off_the_edges(corners: NDArray[np.float32], share: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the weights of points a little further in: at the very edge others may begin."""
    middles = corners.mean(axis=1)
    points = np.einsum("nc,ncx->nx", share, corners)
    far = np.maximum(np.linalg.norm(middles - points, axis=1), 1e-9)
    inwards = np.where(share.min(axis=1) < EDGE, np.minimum(EDGE_M / far, 1.0 / 3.0), 0.0)
    moved = share * (1.0 - inwards[:, None]) + inwards[:, None] / 3.0
    return np.asarray(moved, dtype=np.float32)


@numba.njit(cache=True, nogil=True)
def _cover(places, owner, weights, nearest):  # type: ignore[no-untyped-def]
    """Assign each texel the triangle that is nearest to its centre, in order of the triangles."""
    height, width = owner.shape
    share = np.zeros(3, np.float32)
    for t in range(len(places)):
        corners = places[t]
        left = max(int(np.floor(corners[:, 0].min() - REACH)), 0)
        right = min(int(np.ceil(corners[:, 0].max() + REACH)), width)
        top = max(int(np.floor(corners[:, 1].min() - REACH)), 0)
        bottom = min(int(np.ceil(corners[:, 1].max() + REACH)), height)
        for row in range(top, bottom):
            for column in range(left, right):
                if nearest[row, column] == 0.0:
                    continue
                far = closest_point(corners, column + 0.5, row + 0.5, share)
                if far < nearest[row, column]:
                    nearest[row, column] = far
                    owner[row, column] = t
                    weights[row, column] = share


@numba.njit(cache=True, nogil=True)
def closest_point(corners, x, y, share):  # type: ignore[no-untyped-def]
    """Return the squared distance of a point from a triangle, and in `share` the nearest point."""
    ax, ay = corners[0, 0], corners[0, 1]
    bx, by = corners[1, 0], corners[1, 1]
    cx, cy = corners[2, 0], corners[2, 1]
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    if abs(area) > 1e-9:
        wb = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area
        wc = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area
        if wb >= 0.0 and wc >= 0.0 and wb + wc <= 1.0:
            share[0], share[1], share[2] = 1.0 - wb - wc, wb, wc
            return 0.0
    best = np.inf
    for k in range(3):
        px, py = corners[k, 0], corners[k, 1]
        dx, dy = corners[(k + 1) % 3, 0] - px, corners[(k + 1) % 3, 1] - py
        along = ((x - px) * dx + (y - py) * dy) / max(dx * dx + dy * dy, 1e-12)
        along = min(max(along, 0.0), 1.0)
        far = (x - px - along * dx) ** 2 + (y - py - along * dy) ** 2
        if far < best:
            best = far
            share[k], share[(k + 1) % 3], share[(k + 2) % 3] = 1.0 - along, along, 0.0
    return best
