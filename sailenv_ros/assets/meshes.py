"""Work on triangle meshes as plain arrays: welding, smooth normals, fewer triangles, foliage.

`RawMesh` in, `RawMesh` or `Mesh` out. Knows no file format and no material.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.simplification import fewer_triangles
from sailenv_ros.types.model import Mesh

__all__ = [
    "RawMesh",
    "box_uvs",
    "components",
    "is_open",
    "outward",
    "packed",
    "simplified",
    "smooth_mesh",
    "thinned_out",
    "welded",
]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

CREASE_DEG = 40.0
"""Faces that meet at a smaller angle are shaded as one smooth surface."""


MANY_TRIANGLES_A_LEAF = 12
"""Foliage with more than this loses triangles before it loses leaves."""


@dataclass(frozen=True, eq=False, kw_only=True)
class RawMesh:
    """Triangles before they are fit to be drawn.

    Attributes
    ----------
    positions : (N, 3) float64
    uvs : (N, 2) float64
        v from the texture's bottom row up.
    triangles : (M, 3) int64
    normals : (N, 3) float64 or None
        The author's own; None where they are to be found.
    """

    positions: Floats
    uvs: Floats
    triangles: Indices
    normals: Floats | None = None


def packed(positions: Floats, normals: Floats, uvs: Floats, triangles: Indices) -> Mesh:
    """Return a mesh of arrays of any precision."""
    return Mesh(
        positions=positions.astype(np.float32),
        normals=normals.astype(np.float32),
        uvs=uvs.astype(np.float32),
        triangles=triangles.astype(np.uint32),
    )


def smooth_mesh(raw: RawMesh, crease_deg: float = CREASE_DEG) -> Mesh:
    """Return a mesh to draw: the author's normals, or smooth ones with creases.

    Each corner's normal is the mean of those faces around its point that meet its own face at
    less than the crease angle, weighted by area. Triangles without area are dropped.
    """
    raw = _facing_normals(_without_slivers(raw))
    if raw.normals is not None:
        lengths = np.linalg.norm(raw.normals, axis=1)
        if (lengths > 1e-6).all():
            return Mesh(
                positions=raw.positions.astype(np.float32),
                normals=(raw.normals / lengths[:, None]).astype(np.float32),
                uvs=raw.uvs.astype(np.float32),
                triangles=raw.triangles.astype(np.uint32),
            )
    corners = raw.triangles.reshape(-1)
    normals = _corner_normals(raw, crease_deg)
    # One vertex for each point that looks the same from all its corners.
    rows = np.hstack([raw.positions[corners], raw.uvs[corners], normals]).round(6)
    unique, place = np.unique(rows, axis=0, return_inverse=True)
    return Mesh(
        positions=unique[:, :3].astype(np.float32),
        normals=_unit(unique[:, 5:]).astype(np.float32),
        uvs=unique[:, 3:5].astype(np.float32),
        triangles=place.reshape(-1, 3).astype(np.uint32),
    )


def simplified(raw: RawMesh, target: int, *, max_error: float = 0.004) -> RawMesh:
    """Return a mesh of at most about so many triangles, its seams of texture kept.

    Parameters
    ----------
    target : int
        Triangles that are wanted.
    max_error : float
        Distance that the surface may move, as a share of the mesh's size.

    Returns
    -------
    raw : RawMesh
        Without normals: they are computed again. The same mesh where it is small enough.

    See Also
    --------
    sailenv_ros.assets.simplification : how.
    """
    if len(raw.triangles) <= target:
        return raw
    raw = welded(raw)
    triangles = fewer_triangles(raw.positions, raw.triangles, target, max_error=max_error)
    return _used_only(replace(raw, triangles=triangles, normals=None))


def thinned_out(raw: RawMesh, target: int, *, seed: int) -> RawMesh:
    """Return foliage with fewer leaves, each so much larger that the plant stays as dense.

    Notes
    -----
    What simplifying takes from the tips of leaves is made good by stretching the plant.

    Stochastic pruning after Cook, Halstead, Planck and Ryu (SIGGRAPH 2007): of n leaves k are
    kept, grown by the root of n/k about their middles.
    """
    if len(raw.triangles) <= target:
        return raw
    if len(raw.triangles) > MANY_TRIANGLES_A_LEAF * (int(components(raw).max()) + 1):
        raw = _as_large(simplified(raw, target), raw)
        if len(raw.triangles) <= target:
            return raw
    of_triangle = components(raw)
    sizes = np.bincount(of_triangle)
    order = np.random.default_rng(seed).permutation(len(sizes))
    # The leaves that reach farthest stay: the plant keeps its size.
    outer = np.unique(of_triangle[_outermost(raw)])
    order = np.concatenate([outer, order[~np.isin(order, outer)]])
    kept = order[np.cumsum(sizes[order]) <= target]
    if not len(kept):
        return simplified(raw, target, max_error=0.2)
    chosen = np.isin(of_triangle, kept)
    growth = np.sqrt(len(raw.triangles) / max(1, int(chosen.sum())))
    thin = _used_only(replace(raw, triangles=raw.triangles[chosen]))
    return replace(thin, positions=_grown(thin, float(growth)))


def _as_large(raw: RawMesh, whole: RawMesh) -> RawMesh:
    """Stretch a mesh along the axes until it is as large as another one, and lies where it does."""
    low, high = raw.positions.min(axis=0), raw.positions.max(axis=0)
    first, last = whole.positions.min(axis=0), whole.positions.max(axis=0)
    stretch = np.divide(last - first, high - low, out=np.ones(3), where=high - low > 1e-9)
    return replace(raw, positions=first + (raw.positions - low) * stretch)


def components(raw: RawMesh) -> Indices:
    """Return (M,) int64: for each triangle the number of the connected piece that it belongs to."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    _, points = np.unique(raw.positions.round(6), axis=0, return_inverse=True)
    corners = points.reshape(-1)[raw.triangles]
    rows = np.concatenate([corners[:, 0], corners[:, 1]])
    columns = np.concatenate([corners[:, 1], corners[:, 2]])
    count = int(points.max()) + 1 if points.size else 0
    graph = coo_matrix((np.ones(len(rows), np.int8), (rows, columns)), shape=(count, count))
    _, of_point = connected_components(graph, directed=False)
    _, of_triangle = np.unique(of_point[corners[:, 0]], return_inverse=True)
    return np.asarray(of_triangle.reshape(-1), dtype=np.int64)


def is_open(raw: RawMesh, share: float = 0.02) -> bool:
    """Return whether over a share of the edges belong to one triangle alone, as a sheet's do."""
    edges, _ = _edges(raw, np.zeros(len(raw.triangles), dtype=np.int64))
    _, counts = np.unique(edges, axis=0, return_counts=True)
    return bool((counts == 1).mean() > share) if counts.size else False


def outward(raw: RawMesh) -> RawMesh:
    """Turn closed pieces whose triangles face inwards; open ones stay as they are."""
    a, b, c = (raw.positions[raw.triangles[:, k]] for k in range(3))
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
    of_triangle = components(raw)
    inward = np.bincount(of_triangle, weights=volumes) < 0.0
    edges, of_edge = _edges(raw, of_triangle)
    _, first, counts = np.unique(edges, axis=0, return_index=True, return_counts=True)
    open_pieces = of_edge[first[counts == 1]]
    inward[open_pieces] = False
    turned = inward[of_triangle]
    if not turned.any():
        return raw
    triangles = raw.triangles.copy()
    triangles[turned] = triangles[turned][:, ::-1]
    return replace(raw, triangles=triangles, normals=None)


def box_uvs(raw: RawMesh, tile_m: float) -> RawMesh:
    """Return texture coordinates by projection along the axis that each face looks to most.

    Of the two axes that are left, u follows the one in which the face's connected piece is
    longer: as the grain of a board does.

    Parameters
    ----------
    tile_m : float
        Edge of the square that the texture covers, in the mesh's unit.
    """
    points = raw.positions[raw.triangles]
    facing = np.abs(np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])).argmax(1)
    planes = np.array([[1, 2], [0, 2], [0, 1]])[facing]
    size = _piece_sizes(points, components(raw))
    turned = np.take_along_axis(size, planes, axis=1)
    planes[turned[:, 0] < turned[:, 1]] = planes[turned[:, 0] < turned[:, 1]][:, ::-1]
    uvs = np.take_along_axis(points, planes[:, None, :].repeat(3, axis=1), axis=2) / tile_m
    corners = raw.triangles.reshape(-1)
    return RawMesh(
        positions=raw.positions[corners],
        uvs=uvs.reshape(-1, 2),
        triangles=np.arange(len(corners)).reshape(-1, 3),
        normals=None if raw.normals is None else raw.normals[corners],
    )


def _outermost(raw: RawMesh) -> Indices:
    """Return the triangles with the lowest and highest corner along each axis."""
    points = raw.positions[raw.triangles]
    lowest, highest = points.min(axis=1).argmin(axis=0), points.max(axis=1).argmax(axis=0)
    return np.concatenate([lowest, highest])


def _piece_sizes(points: Floats, of_triangle: Indices) -> Floats:
    """Return (M, 3): for each triangle the size of the connected piece that it belongs to."""
    pieces = int(of_triangle.max()) + 1
    low, high = np.full((pieces, 3), np.inf), np.full((pieces, 3), -np.inf)
    np.minimum.at(low, of_triangle, points.min(axis=1))
    np.maximum.at(high, of_triangle, points.max(axis=1))
    return np.asarray((high - low)[of_triangle])


def _edges(raw: RawMesh, of_triangle: Indices) -> tuple[Indices, Indices]:
    """Return the points of each triangle's edges (3 M, 2), and the mark of their triangle."""
    _, points = np.unique(raw.positions.round(6), axis=0, return_inverse=True)
    corners = points.reshape(-1)[raw.triangles]
    edges = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
    return np.sort(edges, axis=1), np.tile(of_triangle, 3)


def _without_slivers(raw: RawMesh) -> RawMesh:
    points = raw.positions[raw.triangles]
    areas = np.linalg.norm(
        np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]), axis=1
    )
    return raw if (areas > 0.0).all() else replace(raw, triangles=raw.triangles[areas > 0.0])


def _facing_normals(raw: RawMesh) -> RawMesh:
    """Turn triangles that run against the author's normals: those tell which side is out."""
    if raw.normals is None or not len(raw.triangles):
        return raw
    points = raw.positions[raw.triangles]
    faces = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    against = np.einsum("ij,ij->i", faces, raw.normals[raw.triangles].sum(axis=1)) < 0.0
    if not against.any():
        return raw
    triangles = raw.triangles.copy()
    triangles[against] = triangles[against][:, ::-1]
    return replace(raw, triangles=triangles)


def _corner_normals(raw: RawMesh, crease_deg: float) -> Floats:
    """Return (3 M, 3): the normal of each corner."""
    points = raw.positions[raw.triangles]
    weighted = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    units = _unit(weighted)
    _, at = np.unique(raw.positions.round(6), axis=0, return_inverse=True)
    place = at.reshape(-1)[raw.triangles.reshape(-1)]
    face = np.repeat(np.arange(len(raw.triangles)), 3)
    order = np.argsort(place, kind="stable")
    counts = np.bincount(place)[place[order]]
    # Every pair of corners at one point, as two long lists.
    first = np.repeat(np.arange(len(order)), counts)
    start = np.concatenate([[0], np.cumsum(np.bincount(place))])[place[order]]
    second = np.arange(len(first)) - np.repeat(np.cumsum(counts) - counts, counts)
    second += np.repeat(start, counts)
    own, other = face[order[first]], face[order[second]]
    smooth = np.einsum("ij,ij->i", units[own], units[other]) >= np.cos(np.radians(crease_deg))
    sums = np.zeros((len(order), 3))
    np.add.at(sums, order[first[smooth]], weighted[other[smooth]])
    return _unit(sums)


def welded(raw: RawMesh) -> RawMesh:
    """Return a mesh whose corners of one place and texture coordinate are one; without normals."""
    rows = np.hstack([raw.positions, raw.uvs]).round(6)
    unique, place = np.unique(rows, axis=0, return_inverse=True)
    triangles = place.reshape(-1)[raw.triangles]
    flat = (triangles == np.roll(triangles, 1, axis=1)).any(axis=1)
    return RawMesh(
        positions=unique[:, :3], uvs=unique[:, 3:5], triangles=triangles[~flat], normals=None
    )


def _used_only(raw: RawMesh) -> RawMesh:
    used, place = np.unique(raw.triangles, return_inverse=True)
    return RawMesh(
        positions=raw.positions[used],
        uvs=raw.uvs[used],
        triangles=place.reshape(-1, 3),
        normals=None if raw.normals is None else raw.normals[used],
    )


def _grown(raw: RawMesh, factor: float) -> Floats:
    of_vertex = np.zeros(len(raw.positions), dtype=np.int64)
    of_vertex[raw.triangles.reshape(-1)] = np.repeat(components(raw), 3)
    counts = np.bincount(of_vertex)[:, None]
    middles = np.stack(
        [np.bincount(of_vertex, weights=raw.positions[:, k]) for k in range(3)], axis=1
    )
    middle = (middles / counts)[of_vertex]
    return middle + factor * (raw.positions - middle)


def _unit(vectors: Floats) -> Floats:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    up = np.array([0.0, 0.0, 1.0])
    return np.where(lengths > 1e-30, vectors / np.maximum(lengths, 1e-30), up)
