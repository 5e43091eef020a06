"""Point on a triangle that each texel of the light map stands for.

From `StaticGeometry` and `Layout` to `Texels`. Knows neither rays nor light.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.layout import Layout
from sailenv_ros.native.bake_types import TexelMap
from sailenv_ros.native.texel_kernels import cover_texels, nearest_triangles
from sailenv_ros.rays.static_geometry import StaticGeometry

__all__ = ["TexelPoints", "Texels", "block_points", "normals_at", "rasterised"]

REACH = 1.5
"""Texels this near to a triangle stand for its nearest point: bilinear look-ups meet them."""

EDGE = 1e-3
"""Points of which a corner's weight is less lie on the edge."""

EDGE_M = 3e-3
"""Distance by which points are moved away from an edge [m]."""


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
        """Number of texels."""
        return len(self.triangle)

    @property
    def places(self) -> NDArray[np.int64]:
        """(N,) int64: the number of each texel's place in the map."""
        places: NDArray[np.int64] = self.rows.astype(np.int64) * self.index.shape[1]
        return places + self.columns

    def tiles(self, chosen: NDArray[np.intp]) -> Texels:
        """Return some texels, one for each tile of 4 by 4, as those of a map a quarter the size."""
        rows, columns = self.rows[chosen] // 4, self.columns[chosen] // 4
        index = np.full((self.index.shape[0] // 4 + 1,) * 2, -1, np.int32)
        index[rows, columns] = np.arange(len(chosen))
        return Texels(
            index=index,
            rows=rows,
            columns=columns,
            triangle=self.triangle[chosen],
            weights=self.weights[chosen],
            positions=self.positions[chosen],
            normals=self.normals[chosen],
            faces=self.faces[chosen],
        )

    def of_map(self, owners: NDArray[np.int32]) -> TexelMap:
        """Return what filters over the map need; `owners`, (N,) int32, tells surfaces apart."""
        return TexelMap(
            self.index, self.rows, self.columns, owners, self.positions, self.normals, self.faces
        )


def rasterised(geometry: StaticGeometry, layout: Layout) -> Texels:
    """Find the texels that the charts cover, and those that touch them."""
    side = layout.side
    owner, weights = cover_texels(layout.places, side, REACH)
    rows, columns = np.nonzero(owner >= 0)
    index = np.full((side, side), -1, dtype=np.int32)
    index[rows, columns] = np.arange(len(rows))
    triangle = owner[rows, columns]
    share = off_the_edges(geometry.corners[triangle], weights[rows, columns])
    faces = geometry.faces[triangle]
    return Texels(
        index=index,
        rows=rows.astype(np.int32),
        columns=columns.astype(np.int32),
        triangle=triangle,
        weights=share,
        positions=np.einsum("nc,ncx->nx", share, geometry.corners[triangle]),
        normals=normals_at(geometry, triangle, share, faces),
        faces=faces,
    )


class TexelPoints(NamedTuple):
    """Points of triangles, (N, …) each, with their normals to the side that is lit."""

    triangle: NDArray[np.int32]
    weights: NDArray[np.float32]
    positions: NDArray[np.float32]
    faces: NDArray[np.float32]


def block_points(
    geometry: StaticGeometry,
    places: NDArray[np.float32],
    texels: Texels,
    chosen: NDArray[np.intp],
) -> TexelPoints:
    """Return the points of some texels: so many of each, one after another, as of its block.

    Parameters
    ----------
    places : (T, 3, 2) float32
        Of the triangles' corners in the map [texels].
    chosen : (K,) int
        Numbers of the texels.
    """
    of_map = texels.of_map(geometry.owner[texels.triangle])
    triangle, weights = nearest_triangles(
        of_map, texels.triangle, places, np.asarray(chosen, np.int64)
    )
    corners = geometry.corners[triangle]
    weights = off_the_edges(corners, weights)
    # Two-sided surfaces have the side of their texel.
    side = np.einsum("nx,nx->n", texels.faces[chosen], geometry.faces[texels.triangle[chosen]])
    sides = np.repeat(side, len(triangle) // max(len(chosen), 1))
    return TexelPoints(
        triangle=triangle,
        weights=weights,
        positions=np.einsum("nc,ncx->nx", weights, corners),
        faces=geometry.faces[triangle] * np.sign(sides)[:, None].astype(np.float32),
    )


def normals_at(
    geometry: StaticGeometry,
    triangles: NDArray[np.int32],
    weights: NDArray[np.float32],
    faces: NDArray[np.float32],
) -> NDArray[np.float32]:
    """Return (N, 3) float32: normals of the smooth surface at points, to the side of `faces`."""
    normals: NDArray[np.float32] = np.einsum("nc,ncx->nx", weights, geometry.normals[triangles])
    normals *= np.sign(np.einsum("nx,nx->n", faces, geometry.faces[triangles]))[:, None]
    # Normals that point through their own triangle are none.
    through = np.einsum("nx,nx->n", normals, faces) < 0.05
    normals[through] = faces[through]
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    return normals


def off_the_edges(corners: NDArray[np.float32], share: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the weights of points a little further in: at the very edge others may begin."""
    edge = np.flatnonzero(share.min(axis=1) < EDGE)
    own, near = share[edge], corners[edge]
    points = np.einsum("nc,ncx->nx", own, near)
    far = np.maximum(np.linalg.norm(near.mean(axis=1) - points, axis=1), 1e-9)
    inwards = np.minimum(EDGE_M / far, 1.0 / 3.0)[:, None]
    moved = share.astype(np.float32)
    moved[edge] = own * (1.0 - inwards) + inwards / 3.0
    return moved
