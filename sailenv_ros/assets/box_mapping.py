"""Texture coordinates from six sides: a picture lies on a mesh at its real size.

A mesh in, the same triangles in the same order out, with vertices of their own where two sides
meet. Knows no material.
"""

from __future__ import annotations

import weakref

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.model import Mesh

__all__ = ["box_mapped"]

Vector2 = tuple[float, float]
Vector3 = tuple[float, float, float]

_made: weakref.WeakKeyDictionary[Mesh, weakref.WeakValueDictionary[object, Mesh]] = (
    weakref.WeakKeyDictionary()
)


def box_mapped(mesh: Mesh, tile_m: Vector2, *, turn_deg: float, scale: Vector3) -> Mesh:
    """Return a mesh whose texture coordinates are places on the side that each triangle faces.

    Parameters
    ----------
    mesh : Mesh
    tile_m : (2,) tuple of float
        Width and height of what the texture shows [m].
    turn_deg : float
        By which it is laid, counter-clockwise as seen from outside [deg].
    scale : (3,) tuple of float
        That the mesh is drawn at: the texture keeps its size.

    Returns
    -------
    mesh : Mesh
        The same object for the same arguments while it is used.
    """
    key = tile_m, turn_deg, scale
    kept = _made.setdefault(mesh, weakref.WeakValueDictionary())
    found = kept.get(key)
    if found is None:
        found = kept[key] = _mapped(mesh, tile_m, turn_deg, scale)
    return found


def _mapped(mesh: Mesh, tile_m: Vector2, turn_deg: float, scale: Vector3) -> Mesh:
    positions = mesh.positions.astype(np.float64) * scale
    corners = positions[mesh.triangles]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    axis = np.argmax(np.abs(faces), axis=1)
    side = 2 * axis + (faces[np.arange(len(faces)), axis] < 0.0)
    # A vertex on several sides becomes one for each of them.
    keys = mesh.triangles.astype(np.int64) * 6 + side[:, None]
    used, triangles = np.unique(keys, return_inverse=True)
    vertices, facing = used // 6, used % 6
    places = _places(positions[vertices], facing)
    angle = np.radians(turn_deg)
    cosine, sine = np.cos(angle), np.sin(angle)
    uvs = places @ np.array([[cosine, -sine], [sine, cosine]]) / tile_m
    return Mesh(
        positions=mesh.positions[vertices],
        normals=mesh.normals[vertices],
        uvs=uvs.astype(np.float32),
        triangles=triangles.reshape(-1, 3).astype(np.uint32),
    )


def _places(points: NDArray[np.float64], side: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return (N, 2) float64: how far to the right and up, as one sees who looks at the side [m]."""
    x, y, z = points.T
    seen = np.array([[y, z], [-y, z], [-x, z], [x, z], [x, y], [x, -y]])
    chosen: NDArray[np.float64] = seen[side, :, np.arange(len(points))]
    return chosen
