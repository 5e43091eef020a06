"""Fewer triangles that look the same, in NumPy alone. Arrays in, arrays out.

Edges are contracted in the order of their quadric error, many at a time: all that are the cheapest
in their own neighbourhood, so that none touches what another one changes. Of an edge one end is
moved onto the other, so corners keep their places and their texture coordinates.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["fewer_triangles"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]

BORDER_WEIGHT = 10.0
"""Weight of a border or a seam, relative to a surface as wide as it is long."""

LEAST_COSINE = 0.5
"""Cosine of the greatest angle by which a triangle may turn when an edge is contracted."""

LENGTH_WEIGHT = 1e-7
"""Share of an edge's squared length in its cost: of edges that cost nothing, the shortest."""

ROUNDING = 1e-15
"""Greatest rounding error of a mean squared distance of 0, for a mesh of extent 1."""

PASS_SHARE = 0.5
"""Share of the edges that a pass looks at, the cheapest: dearer ones wait for a later pass."""

LEAST_GAIN = 0.002
PATIENCE = 4
"""Number of passes in a row that may spare less than that share before simplification ends."""

FEWEST_EDGES = 256
"""A pass looks at no fewer edges, if there are so many."""


def fewer_triangles(
    positions: Floats, triangles: Indices, target: int, *, max_error: float
) -> Indices:
    """Contract edges until there are at most so many triangles, or no more can be spared.

    Parameters
    ----------
    positions : (N, 3) float64
        Of vertices. Vertices of one position are one corner with several texture coordinates; a
        seam between them is kept.
    triangles : (M, 3) int64
        Vertices of each triangle.
    target : int
    max_error : float
        Root of the mean squared distance to the planes of the surface that a corner stands for
        that a contraction may cause, as a share of the mesh's largest extent.

    Returns
    -------
    triangles : (K, 3) int64
        Of the same vertices.

    Notes
    -----
    Quadric errors: Garland and Heckbert, "Surface simplification using quadric error metrics",
    SIGGRAPH 1997. The result depends on the arguments alone.
    """
    points, place = np.unique(positions, axis=0, return_inverse=True)
    place = place.reshape(-1).astype(np.int64)
    extent = float((points.max(axis=0) - points.min(axis=0)).max())
    points = (points - points.min(axis=0)) / max(extent, 1e-12)
    triangles = _with_three_corners(triangles.astype(np.int64), place)
    quadrics = _quadrics(points, triangles, place)
    refused = np.zeros(0, dtype=np.int64)
    poor_passes = 0
    while len(triangles) > target:
        edges = _edges(triangles, place, len(points))
        candidates = np.flatnonzero(edges.contractible & ~_listed(refused, edges.keys))
        error, squared_length = _costs(points, quadrics, edges, candidates)
        cheap = error <= max_error**2 + ROUNDING
        cost = error[cheap] + LENGTH_WEIGHT * squared_length[cheap]
        order = candidates[cheap][np.argsort(cost, kind="stable")]
        chosen = _independent(edges, order, len(points))
        if not len(chosen):
            break
        bad = _spoiling(points, triangles, place, edges, chosen)
        refused = np.union1d(refused, edges.keys[chosen[bad]])
        chosen = chosen[~bad]
        before = len(triangles)
        spared = np.cumsum(edges.counts[chosen])
        chosen = chosen[: 1 + int(np.searchsorted(spared, len(triangles) - target))]
        starts, ends = edges.starts[chosen], edges.ends[chosen]
        np.add.at(quadrics, ends, quadrics[starts])
        triangles = _with_three_corners(edges.moved(chosen)[triangles], place)
        poor_passes = poor_passes + 1 if before - len(triangles) < LEAST_GAIN * before else 0
        if poor_passes > PATIENCE:
            break
    return triangles


@dataclass(frozen=True, eq=False, kw_only=True)
class _Edges:
    """Every edge twice, once for each end that may be moved onto the other.

    Attributes
    ----------
    keys : (E,) int64
        Ascending, unique.
    starts, ends : (E,) int64
        Corners; the start is what moves.
    counts : (E,) int64
        Triangles beside it.
    contractible : (E,) bool
        Whether the start may move along it as far as borders and seams go.
    onto : (3, R) int64
        Edge, a vertex of its start, and the vertex of its end that takes its place.
    vertices : int
    """

    keys: Indices
    starts: Indices
    ends: Indices
    counts: Indices
    contractible: Flags
    onto: Indices
    vertices: int

    def moved(self, chosen: Indices) -> Indices:
        """Return for each vertex the one that takes its place when edges are contracted."""
        result = np.arange(self.vertices)
        is_chosen = np.zeros(len(self.keys), dtype=bool)
        is_chosen[chosen] = True
        rows = is_chosen[self.onto[0]]
        result[self.onto[1, rows]] = self.onto[2, rows]
        return result


def _edges(triangles: Indices, place: Indices, corners: int) -> _Edges:
    first = triangles[:, [0, 1, 2, 1, 2, 0]].reshape(-1)
    second = triangles[:, [1, 2, 0, 0, 1, 2]].reshape(-1)
    start, end = place[first], place[second]
    keys, edge, counts = np.unique(start * corners + end, return_inverse=True, return_counts=True)
    edge = edge.reshape(-1)
    starts, ends = keys // corners, keys % corners
    vertices = len(place)
    used = np.unique(triangles)
    among = np.bincount(place[used], minlength=corners)
    only = np.zeros(corners, dtype=np.int64)
    only[place[used]] = used
    # Each vertex of the start has to have one vertex of the end to go to: clear where there is one.
    clear = (among[starts] == 1) & (among[ends] == 1)
    possible = clear.copy()
    onto = np.stack([np.flatnonzero(clear), only[starts[clear]], only[ends[clear]]])
    at_seam = ~clear[edge]
    if at_seam.any():
        sides, side = np.unique(edge[at_seam] * vertices + first[at_seam], return_inverse=True)
        pairs = np.unique(side.reshape(-1) * vertices + second[at_seam])
        of_side = sides[pairs // vertices]
        of_seam = np.stack([of_side // vertices, of_side % vertices, pairs % vertices])
        ways = np.bincount(sides // vertices, minlength=len(keys))
        certain = np.bincount(of_seam[0], minlength=len(keys)) == ways
        possible |= certain & (ways == among[starts]) & ~clear
        onto = np.concatenate([onto, of_seam], axis=1)
    # Inside a surface, single or double, all edges have as many triangles. Where surfaces end or
    # three meet, edges have an odd number, and a corner moves along those alone. Others stay.
    _, where = np.unique(starts, return_index=True)
    corner_of = np.repeat(np.arange(len(where)), np.diff([*where, len(starts)]))
    fewest, most = np.minimum.reduceat(counts, where), np.maximum.reduceat(counts, where)
    odd = counts % 2 == 1
    has_odd = np.logical_or.reduceat(odd, where)
    free = np.where(has_odd[corner_of], odd, (fewest == most)[corner_of])
    return _Edges(
        keys=keys,
        starts=starts,
        ends=ends,
        counts=counts,
        contractible=possible & free,
        onto=onto,
        vertices=vertices,
    )


def _quadrics(points: Floats, triangles: Indices, place: Indices) -> Floats:
    """Return (P, 5, 4): for each corner the sum of its planes' quadrics, and of their weights."""
    result = np.zeros((len(points), 5, 4))
    corners = place[triangles]
    a, b, c = (points[corners[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    areas = np.linalg.norm(normals, axis=1)
    normals = normals / np.maximum(areas, 1e-30)[:, None]
    for k in range(3):
        _add_planes(result, corners[:, k], normals, a, areas / 2.0)
    # Borders and seams: a plane upright on the triangle that ends there.
    for first, second in ((0, 1), (1, 2), (2, 0)):
        ends = _where_surfaces_end(triangles, first, second)
        start, end = corners[ends, first], corners[ends, second]
        along = points[end] - points[start]
        upright = np.cross(along, normals[ends])
        lengths = np.linalg.norm(upright, axis=1)
        upright = upright / np.maximum(lengths, 1e-30)[:, None]
        for corner in (start, end):
            _add_planes(result, corner, upright, points[start], BORDER_WEIGHT * lengths**2)
    return result


def _where_surfaces_end(triangles: Indices, first: int, second: int) -> Flags:
    """Return which triangles have no triangle with the same vertices beyond that edge."""
    limit = int(triangles.max()) + 1
    beyond = triangles[:, [1, 2, 0]] * limit + triangles[:, [0, 1, 2]]
    result: Flags = ~np.isin(triangles[:, first] * limit + triangles[:, second], beyond)
    return result


def _add_planes(
    quadrics: Floats, corners: Indices, normals: Floats, on: Floats, weights: Floats
) -> None:
    planes = np.concatenate([normals, -np.einsum("ij,ij->i", normals, on)[:, None]], axis=1)
    products = planes[:, :, None] * planes[:, None, :] * weights[:, None, None]
    for row in range(4):
        for column in range(4):
            quadrics[:, row, column] += np.bincount(
                corners, weights=products[:, row, column], minlength=len(quadrics)
            )
    quadrics[:, 4, 0] += np.bincount(corners, weights=weights, minlength=len(quadrics))


def _listed(sorted_keys: Indices, keys: Indices) -> Flags:
    """Return which keys are in an ascending list."""
    if not len(sorted_keys):
        return np.zeros(len(keys), dtype=bool)
    at = np.minimum(np.searchsorted(sorted_keys, keys), len(sorted_keys) - 1)
    return np.asarray(sorted_keys[at] == keys)


def _costs(
    points: Floats, quadrics: Floats, edges: _Edges, chosen: Indices
) -> tuple[Floats, Floats]:
    """Return the mean squared distance of edges' ends from their starts' planes, and lengths²."""
    there = points[edges.ends[chosen]]
    own = quadrics[edges.starts[chosen]]
    squared = (
        np.einsum("ni,nij,nj->n", there, own[:, :3, :3], there)
        + 2.0 * np.einsum("ni,ni->n", own[:, 3, :3], there)
        + own[:, 3, 3]
    )
    lengths = ((there - points[edges.starts[chosen]]) ** 2).sum(axis=1)
    mean = np.maximum(squared, 0.0) / np.maximum(own[:, 4, 0], 1e-30)
    return mean, lengths


def _independent(edges: _Edges, order: Indices, corners: int) -> Indices:
    """Return edges of which none touches a triangle around another one's start; cheapest first.

    `order` has those that may be contracted, the cheapest first.
    """
    order = order[: max(FEWEST_EDGES, int(PASS_SHARE * len(order)))]
    rank = np.arange(len(order))
    nobody = len(edges.keys)
    least = np.full(corners, nobody)
    # Backwards, so that of equal places the least rank is what is written last.
    for corner in (edges.starts[order], edges.ends[order]):
        lowest = np.full(corners, nobody)
        lowest[corner[::-1]] = rank[::-1]
        least = np.minimum(least, lowest)
    around = least.copy()
    present, where = np.unique(edges.starts, return_index=True)
    lowest = np.minimum.reduceat(least[edges.ends], where)
    around[present] = np.minimum(around[present], lowest)
    return np.asarray(order[rank == around[edges.starts[order]]])


def _spoiling(
    points: Floats, triangles: Indices, place: Indices, edges: _Edges, chosen: Indices
) -> Flags:
    """Return which contractions would turn a triangle over or join surfaces that do not meet."""
    corners = len(points)
    goal = np.arange(corners)
    goal[edges.starts[chosen]] = edges.ends[chosen]
    before = place[triangles]
    after = goal[before]
    changed = (before != after).any(axis=1)
    before, after = before[changed], after[changed]
    left = (
        (after[:, 0] != after[:, 1]) & (after[:, 1] != after[:, 2]) & (after[:, 2] != after[:, 0])
    )
    before, after = before[left], after[left]
    was, will = _normals(points, before), _normals(points, after)
    lengths = np.linalg.norm(was, axis=1) * np.linalg.norm(will, axis=1)
    turned = np.einsum("ij,ij->i", was, will) <= LEAST_COSINE * lengths
    spoilt = np.zeros(corners, dtype=bool)
    moving = before[turned][before[turned] != after[turned]]
    spoilt[moving] = True
    # Both ends may have no more neighbours in common than the edge has triangles.
    is_start = np.zeros(corners, dtype=bool)
    is_start[edges.starts[chosen]] = True
    of_start = is_start[edges.starts]
    starts, others = edges.starts[of_start], edges.ends[of_start]
    wanted = goal[starts] * corners + others
    common = np.bincount(starts, weights=_listed(edges.keys, wanted), minlength=corners)
    too_many = common[edges.starts[chosen]] > edges.counts[chosen]
    return np.asarray(spoilt[edges.starts[chosen]] | too_many)


def _normals(points: Floats, corners: Indices) -> Floats:
    a, b, c = (points[corners[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


def _with_three_corners(triangles: Indices, place: Indices) -> Indices:
    at = place[triangles]
    whole = (at[:, 0] != at[:, 1]) & (at[:, 1] != at[:, 2]) & (at[:, 2] != at[:, 0])
    return np.asarray(triangles[whole])
