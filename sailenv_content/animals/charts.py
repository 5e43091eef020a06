"""Layout of a picture for a mesh: each triangle is seen along the axis that it faces most.

Triangles that would lie upon each other are seen apart: those of the left and of the right half, of
the front and of the back, of the top and of the paws. A point of the picture knows its place on the
body, so a coat is painted by places and has no seams.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.texel_kernels import cover_texels

__all__ = ["Layout", "layout_of"]

Doubles = NDArray[np.float64]
Indices = NDArray[np.int64]

_GAP_PX = 6
_REACH_PX = 4.0
_PLANES = ((1, 2), (0, 2), (0, 1))
"""Axes of the picture for triangles that face x, y and z."""


@dataclass(frozen=True, eq=False, slots=True)
class Layout:
    """Where the vertices of a mesh are in its picture.

    Attributes
    ----------
    sources : (V,) int64
        The vertex of the mesh that each one of ours is: at borders of charts there are several.
    triangles : (T, 3) int64
        Of ours.
    uvs : (V, 2) float64
    side : int
        Of the picture [px].
    """

    sources: Indices
    triangles: Indices
    uvs: Doubles
    side: int

    def spread(self, values: Doubles) -> tuple[Doubles, NDArray[np.bool_]]:
        """Return (N, K) values of the mesh's vertices at the N texels near it, and which these are.

        Parameters
        ----------
        values : (M, K) float64
            Of the mesh's vertices.
        """
        places = np.stack([self.uvs[:, 0], 1.0 - self.uvs[:, 1]], axis=1) * self.side
        corners = np.ascontiguousarray(places[self.triangles], np.float32)
        owner, weights = cover_texels(corners, self.side, _REACH_PX)
        there = owner >= 0
        rows = values[self.sources[self.triangles[owner[there]]]]
        return np.einsum("nk,nkj->nj", weights[there].astype(np.float64), rows), there


def layout_of(
    vertices: Doubles, triangles: Indices, side: int, low_m: float, apart: NDArray[np.bool_]
) -> Layout:
    """Return a layout of a mesh.

    Parameters
    ----------
    vertices : (M, 3) float64
    triangles : (T, 3) int64
        Some of its triangles.
    side : int
        Of the picture [px].
    low_m : float
        Height below which what faces up or down is seen apart [m].
    apart : (T,) bool
        Triangles that are seen apart from all others.
    """
    corners = vertices[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    axis = np.abs(normals).argmax(axis=1)
    faces = normals[np.arange(len(axis)), axis] > 0.0
    middle = corners.mean(axis=1)
    split = np.choose(axis, [middle[:, 0] > 0.0, middle[:, 1] > 0.0, middle[:, 2] > low_m])
    chart = 12 * apart + axis * 4 + faces * 2 + split
    sizes, pieces = [], []
    for number in np.unique(chart).tolist():
        chosen = np.flatnonzero(chart == number)
        used, local = np.unique(triangles[chosen], return_inverse=True)
        flat = vertices[used][:, _PLANES[number % 12 // 4]]
        flat = flat - flat.min(axis=0)
        sizes.append(flat.max(axis=0))
        pieces.append((used, local.reshape(-1, 3), flat))
    corner_px, scale = _packed(np.array(sizes), side)
    sources, made, uvs, count = [], [], [], 0
    for (used, local, flat), at in zip(pieces, corner_px, strict=True):
        sources.append(used)
        made.append(local + count)
        uvs.append((at + flat * scale) / side)
        count += len(used)
    return Layout(np.concatenate(sources), np.concatenate(made), np.concatenate(uvs), side)


def _packed(sizes: Doubles, side: int) -> tuple[Doubles, float]:
    """Return the corners of charts in the picture [px], and the largest scale that fits [px/m]."""
    low, high = 0.0, side / float(sizes.max())
    best = np.zeros_like(sizes)
    for _ in range(24):
        scale = 0.5 * (low + high)
        placed = _shelves(sizes * scale + _GAP_PX, side)
        if placed is None:
            high = scale
        else:
            low, best = scale, placed
    return best, low


def _shelves(sizes: Doubles, side: int) -> Doubles | None:
    """Return the corners of rectangles on shelves; None if there is no room."""
    found = np.zeros_like(sizes)
    x, y, height = float(_GAP_PX), float(_GAP_PX), 0.0
    for number in np.argsort(-sizes[:, 1], kind="stable").tolist():
        wide, high = sizes[number].tolist()
        if x + wide > side:
            x, y, height = float(_GAP_PX), y + height, 0.0
        if x + wide > side or y + high > side:
            return None
        found[number] = x, y
        x, height = x + wide, max(height, high)
    return found
