"""Meshes on the zero of a field: one vertex in each cell that the surface passes through.

Naive surface nets, see S. F. Frisken, *Constrained Elastic Surface Nets* (1998); each vertex is
moved onto the surface afterwards, along the gradient. The mesh is closed.
"""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from sailenv_content.animals.solids import Body

__all__ = ["surface_of"]

Doubles = NDArray[np.float64]
Indices = NDArray[np.int64]

_ROUNDS = 2
"""Times that vertices are evened out and moved onto the surface."""


def surface_of(
    body: Body, grid: tuple[Doubles, Doubles, Doubles], step_m: float
) -> tuple[Doubles, Doubles, Indices]:
    """Return the surface of a body on a floor, z = 0, above which it ends.

    Parameters
    ----------
    body : Body
        The same on both sides of y = 0.
    grid : tuple of (N,) float64
        Places along x, y and z, ascending; all of the body lies within [m]. Those along y are the
        same on both sides, none at 0.
    step_m : float
        Of differences of the field [m].

    Returns
    -------
    vertices, normals : (V, 3) float64
    triangles : (T, 3) int64
        Counter-clockwise seen from outside.
    """
    values = body.on_grid(grid)
    # The order of solids leaves traces where both sides are near: those of one side count.
    count = len(grid[1]) // 2
    values[:, :count] = values[:, : count - 1 : -1]
    inside = values < 0.0
    counts = np.zeros(np.array(inside.shape) - 1, np.int8)
    for corner in itertools.product((0, 1), repeat=3):
        counts += inside[_shifted(inside.shape, corner)]
    cells = np.argwhere((counts > 0) & (counts < 8))
    number = np.full(counts.shape, -1, np.int64)
    number[tuple(cells.T)] = np.arange(len(cells))
    vertices = _crossings(values, grid, cells)
    quads = np.concatenate([_quads(inside, number, axis) for axis in range(3)])
    pairs = np.sort(np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    pairs = np.unique(pairs, axis=0)
    # One half is looked at, the other one is its mirror image.
    middle = (counts.shape[1] - 1) // 2
    half = np.flatnonzero(cells[:, 1] >= middle)
    mirrored = number[cells[half, 0], 2 * middle - cells[half, 1], cells[half, 2]]
    near = body.near(vertices[half])
    for _ in range(_ROUNDS):
        vertices = _evened(vertices, pairs)
        own = vertices[half]
        values, slope = body.slope_at(own, near, step_m)
        length = np.einsum("nk,nk->n", slope, slope)
        move = values / np.maximum(length, 0.05)
        own = own - np.clip(move, -4.0 * step_m, 4.0 * step_m)[:, None] * slope
        vertices = _mirrored(own, half, mirrored)
    # What stands, stands flat.
    vertices[:, 2] = np.maximum(vertices[:, 2], 0.0)
    _, slope = body.slope_at(vertices[half], near, step_m)
    normals = _mirrored(slope, half, mirrored)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-9)
    return vertices, normals, _split(vertices, quads)


def _mirrored(own: Doubles, half: Indices, partners: Indices) -> Doubles:
    """Return (V, 3) for all vertices, by those of one half; in the middle y is 0."""
    found = np.empty((int(max(half.max(), partners.max())) + 1, 3))
    found[half] = own
    found[half[half == partners], 1] = 0.0
    found[partners] = found[half] * [1.0, -1.0, 1.0]
    return found


def _shifted(shape: tuple[int, ...], corner: tuple[int, ...]) -> tuple[slice, ...]:
    return tuple(slice(k, n - 1 + k) for k, n in zip(corner, shape, strict=True))


def _crossings(values: Doubles, grid: tuple[Doubles, Doubles, Doubles], cells: Indices) -> Doubles:
    """Return (C, 3): the mean of where the surface crosses the edges of cells."""
    total, count = np.zeros((len(cells), 3)), np.zeros(len(cells))
    corners = {
        corner: values[tuple((cells + corner).T)] for corner in itertools.product((0, 1), repeat=3)
    }
    for axis in range(3):
        for corner, first in corners.items():
            if corner[axis]:
                continue
            other = tuple(1 if k == axis else c for k, c in enumerate(corner))
            second = corners[other]
            crosses = (first < 0.0) != (second < 0.0)
            share = np.where(crosses, first / np.where(crosses, first - second, 1.0), 0.0)
            begin = np.column_stack([grid[k][cells[:, k] + corner[k]] for k in range(3)])
            end = np.column_stack([grid[k][cells[:, k] + other[k]] for k in range(3)])
            total += crosses[:, None] * (begin + share[:, None] * (end - begin))
            count += crosses
    return np.asarray(total / count[:, None], np.float64)


def _quads(inside: NDArray[np.bool_], number: Indices, axis: int) -> Indices:
    """Return (Q, 4): the cells around each edge along an axis that the surface crosses."""
    ahead = np.roll(inside, -1, axis=axis)
    differs = inside != ahead
    differs[tuple(slice(-1, None) if k == axis else slice(None) for k in range(3))] = False
    edges = np.argwhere(differs)
    u, v = np.eye(3, dtype=np.int64)[[(axis + 1) % 3, (axis + 2) % 3]]
    around = [number[tuple((edges - by).T)] for by in (0 * u, u, u + v, v)]
    quads = np.stack(around, axis=1)
    begins_outside = ~inside[tuple(edges.T)]
    quads[begins_outside] = quads[begins_outside][:, ::-1]
    return quads


def _evened(vertices: Doubles, pairs: Indices) -> Doubles:
    """Return vertices half way to the mean of their neighbours."""
    total, count = np.zeros_like(vertices), np.bincount(pairs.reshape(-1), minlength=len(vertices))
    for axis in range(3):
        for first, second in ((0, 1), (1, 0)):
            total[:, axis] += np.bincount(
                pairs[:, first], weights=vertices[pairs[:, second], axis], minlength=len(vertices)
            )
    return np.asarray(0.5 * (vertices + total / np.maximum(count, 1)[:, None]), np.float64)


def _split(vertices: Doubles, quads: Indices) -> Indices:
    """Return triangles: each quadrangle is cut along its shorter diagonal."""
    a, b, c, d = (vertices[quads[:, k]] for k in range(4))
    first = np.linalg.norm(a - c, axis=1) <= np.linalg.norm(b - d, axis=1)
    cut = np.where(first[:, None], quads[:, [0, 1, 2, 0, 2, 3]], quads[:, [0, 1, 3, 1, 2, 3]])
    return np.asarray(cut.reshape(-1, 3), np.int64)
