"""Pieces of a person: triangles of MakeHuman's mesh, cut along lines, moved off the skin.

A piece's vertex lies between two vertices of the mesh, from which it takes place, normal and
weights; so pieces fit every figure.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Cut", "clipped", "smoothed", "vertex_normals"]

Doubles = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False, slots=True)
class Cut:
    """Triangles between vertices of the mesh.

    Attributes
    ----------
    first, second : (N,) int64
        Vertices of the mesh.
    share : (N,) float64
        Of the second one.
    first_uv, second_uv : (N,) int64
        Texture coordinates.
    triangles : (T, 3) int64
        Of these N.
    """

    first: Indices
    second: Indices
    share: Doubles
    first_uv: Indices
    second_uv: Indices
    triangles: Indices

    def mixed(self, values: Doubles) -> Doubles:
        """Return (N, ...): values of the mesh's vertices at those of the cut."""
        return _mixed(values, self.first, self.second, self.share)

    def mixed_uvs(self, uvs: Doubles) -> Doubles:
        """Return (N, 2): texture coordinates."""
        return _mixed(uvs, self.first_uv, self.second_uv, self.share)


def _mixed(values: Doubles, first: Indices, second: Indices, share: Doubles) -> Doubles:
    weight = share.reshape(-1, *[1] * (values.ndim - 1))
    found: Doubles = (1.0 - weight) * values[first] + weight * values[second]
    return found


def clipped(triangles: Indices, uv_triangles: Indices, field: Doubles) -> Cut:
    """Keep of triangles what lies where a field of the vertices is below 0.

    Parameters
    ----------
    triangles, uv_triangles : (T, 3) int64
    field : (V,) float64
    """
    known: dict[tuple[int, int, int, int], int] = {}
    vertices: list[tuple[int, int, float, int, int]] = []

    def corner(a: int, ua: int, b: int, ub: int) -> int:
        if (b, ub) < (a, ua):
            a, ua, b, ub = b, ub, a, ua
        key = a, ua, b, ub
        if key not in known:
            share = 0.0 if a == b else float(field[a] / (field[a] - field[b]))
            known[key] = len(vertices)
            vertices.append((a, b, share, ua, ub))
        return known[key]

    made: list[tuple[int, int, int]] = []
    inside = field[triangles] < 0.0
    for corners, uvs, within in zip(
        triangles.tolist(), uv_triangles.tolist(), inside.tolist(), strict=True
    ):
        if not any(within):
            continue
        ring: list[int] = []
        for k in range(3):
            j = (k + 1) % 3
            if within[k]:
                ring.append(corner(corners[k], uvs[k], corners[k], uvs[k]))
            if within[k] != within[j]:
                ring.append(corner(corners[k], uvs[k], corners[j], uvs[j]))
        made += [(ring[0], ring[k], ring[k + 1]) for k in range(1, len(ring) - 1)]
    columns = list(zip(*vertices, strict=True)) or [(), (), (), (), ()]
    first, second, share, first_uv, second_uv = columns
    return Cut(
        np.array(first, np.int64),
        np.array(second, np.int64),
        np.array(share, np.float64),
        np.array(first_uv, np.int64),
        np.array(second_uv, np.int64),
        np.array(made, np.int64).reshape(-1, 3),
    )


def vertex_normals(vertices: Doubles, triangles: Indices) -> Doubles:
    """Return (V, 3) unit normals, weighted by areas; 0 for vertices without triangles."""
    corners = vertices[triangles]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros_like(vertices)
    for k in range(3):
        np.add.at(normals, triangles[:, k], areas)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.asarray(
        np.divide(normals, length, out=np.zeros_like(normals), where=length > 0.0), np.float64
    )


def smoothed(vertices: Doubles, triangles: Indices, rounds: int) -> Doubles:
    """Return vertices that were moved to the middle of their neighbours so many times."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    ends = np.concatenate([edges, edges[:, ::-1]])
    count = np.bincount(ends[:, 0], minlength=len(vertices)).astype(np.float64)
    result = vertices.copy()
    for _ in range(rounds):
        total = np.zeros_like(result)
        np.add.at(total, ends[:, 0], result[ends[:, 1]])
        some = count > 0
        result[some] = 0.5 * result[some] + 0.5 * total[some] / count[some, None]
    return result
