"""Visibility of static geometry from the air. From `StaticGeometry` and rays to booleans.

Walls have backs and beds have insides: texels there would be lost. Knows no light.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from sailenv_ros.light.bake.back_to_back import back_to_back_faces
from sailenv_ros.light.bake.settings import INSIDE_SHARE
from sailenv_ros.light.bake.worker_pool import in_chunks
from sailenv_ros.rays.light_rays import RayScene
from sailenv_ros.rays.ray_patterns import fibonacci_sphere
from sailenv_ros.rays.static_geometry import StaticGeometry

__all__ = ["ProbeVisibility", "visible_triangles", "probe_visibility"]

LEAST_VIEW_M = 0.5
"""A probe whose longest ray is shorter than this is inside a solid [m]."""

CHUNK_RAYS = 250_000

MOST_SKY = 0.5
"""A probe that sees more sky than this share is outside of a room, if others see little of it."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ProbeVisibility:
    """Result of looking around from points in and around a scene.

    Attributes
    ----------
    useful : (N,) bool
        False inside of things, and outside of a room.
    seen : (T,) bool
        Triangles that a useful point saw.
    """

    useful: NDArray[np.bool_]
    seen: NDArray[np.bool_]


def probe_visibility(
    geometry: StaticGeometry,
    scene: RayScene,
    positions: NDArray[np.float32],
    rays: int,
    workers: int = 1,
) -> ProbeVisibility:
    """Look around from points in the air.

    Parameters
    ----------
    positions : (N, 3) float32
    rays : int
        From each.
    """
    directions = fibonacci_sphere(rays)
    two_sided = geometry.two_sided | (back_to_back_faces(geometry).other >= 0)
    count = len(positions)
    inside, sky = np.zeros(count, bool), np.zeros(count)
    met = np.full((count, rays), -1, dtype=np.int32)

    def look(first: int, end: int) -> None:
        own, size = slice(first, end), end - first
        hits = scene.hits(np.repeat(positions[own], rays, axis=0), np.tile(directions, (size, 1)))
        triangle = hits.triangle.reshape(size, rays)
        met[own] = triangle
        facing = np.einsum("rx,nrx->nr", directions, geometry.faces[triangle])
        backs = (triangle >= 0) & (facing > 0.0) & ~two_sided[triangle]
        sky[own] = np.mean(triangle < 0, axis=1)
        farthest = hits.distance.reshape(size, rays).max(axis=1)
        inside[own] = (backs.mean(axis=1) > INSIDE_SHARE) | (farthest < LEAST_VIEW_M)
        met[own][backs] = -1

    in_chunks(look, count, max(CHUNK_RAYS // rays, 1), workers)
    closed = bool((sky[~inside] < MOST_SKY / 2).any())
    useful = ~inside & ~(closed & (sky > MOST_SKY))
    seen = np.zeros(geometry.triangle_count, dtype=bool)
    seen[np.unique(met[useful])] = True
    seen[-1:] &= bool((met[useful] == geometry.triangle_count - 1).any())
    return ProbeVisibility(useful=useful, seen=seen)


def visible_triangles(geometry: StaticGeometry, seen: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return (T,) bool: triangles of connected surfaces of which any triangle was seen."""
    result = np.zeros(geometry.triangle_count, dtype=bool)
    for instance in geometry.instances:
        first = instance.first_triangle
        for part in instance.model.parts:
            triangles = part.mesh.triangles
            own = slice(first, first + len(triangles))
            first += len(triangles)
            piece = _pieces(triangles.astype(np.int64), len(part.mesh.positions))
            result[own] = np.isin(piece, piece[seen[own]])
    return result


def _pieces(triangles: NDArray[np.int64], count: int) -> NDArray[np.int32]:
    """Return (M,) int32: the number of the connected surface to which each triangle belongs."""
    ends = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]]])
    links = coo_matrix((np.ones(len(ends), np.int8), (ends[:, 0], ends[:, 1])), (count, count))
    _, labels = connected_components(links, directed=False)
    pieces: NDArray[np.int32] = labels[triangles[:, 0]]
    return pieces
