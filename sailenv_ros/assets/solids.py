"""Triangles of plain solids: numbers in, `Mesh` out.

Every solid is in its body frame [m], triangles counter-clockwise seen from outside. Flat faces
have flat normals, round faces smooth ones; edges between them are sharp.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.meshes import packed
from sailenv_ros.types.model import Mesh

__all__ = ["box_mesh", "cone_mesh", "cylinder_mesh", "ground_mesh", "sphere_mesh"]

Floats = NDArray[np.float64]

SEGMENTS = 64
"""Sides of round solids: at 1 m diameter the outline is within 0.6 mm of the circle."""


def box_mesh(size_m: tuple[float, float, float]) -> Mesh:
    """Make a box around the origin; each face has the texture square once."""
    half = np.asarray(size_m, dtype=np.float64) / 2.0
    faces = []
    for axis in range(3):
        for sign in (1.0, -1.0):
            normal = np.zeros(3)
            normal[axis] = sign
            # `right` and `up` as one sees them who looks at the face; z is up on the four sides.
            up = np.array([0.0, 0.0, 1.0]) if axis < 2 else np.array([0.0, sign, 0.0])
            right = np.cross(up, normal)
            corners = [normal - right - up, normal + right - up, normal + right + up]
            corners.append(normal - right + up)
            faces.append(_quad(np.array(corners) * half, normal))
    return joined(faces)


def ground_mesh(size_m: float, *, metres_per_tile: float = 1.0) -> Mesh:
    """Make a square that faces up, in the plane z = 0, textured once per tile."""
    half = size_m / 2.0
    corners = np.array([[-half, -half, 0], [half, -half, 0], [half, half, 0], [-half, half, 0]])
    square = _quad(corners, np.array([0.0, 0.0, 1.0]))
    return Mesh(
        positions=square.positions,
        normals=square.normals,
        uvs=square.positions[:, :2] / metres_per_tile,
        triangles=square.triangles,
    )


def sphere_mesh(radius_m: float, segments: int = SEGMENTS) -> Mesh:
    """Make a sphere around the origin; u runs around z, v from the lower pole up."""
    rings = segments // 2
    turns = np.linspace(0.0, 1.0, segments + 1)
    heights = np.linspace(0.0, 1.0, rings + 1)
    longitude = 2.0 * np.pi * turns[np.newaxis, :]
    latitude = np.pi * (heights[:, np.newaxis] - 0.5)
    normals = np.stack(
        [
            np.cos(latitude) * np.cos(longitude),
            np.cos(latitude) * np.sin(longitude),
            np.broadcast_to(np.sin(latitude), (rings + 1, segments + 1)),
        ],
        axis=-1,
    )
    uvs = np.stack(np.broadcast_arrays(turns[np.newaxis, :], heights[:, np.newaxis]), axis=-1)
    flat = normals.reshape(-1, 3)
    triangles = _grid_triangles(rings, segments)
    # At the poles one triangle of each grid square has no area.
    triangles = triangles[_areas(flat, triangles) > 1e-9]
    return packed(flat * radius_m, flat, uvs.reshape(-1, 2), triangles)


def cylinder_mesh(radius_m: float, height_m: float, segments: int = SEGMENTS) -> Mesh:
    """Make a cylinder around the origin, along z, with both caps."""
    half = height_m / 2.0
    side = _mantle(radius_m, radius_m, -half, half, segments)
    return joined(
        [side, _cap(radius_m, half, 1.0, segments), _cap(radius_m, -half, -1.0, segments)]
    )


def cone_mesh(radius_m: float, base_z_m: float, tip_z_m: float, segments: int = SEGMENTS) -> Mesh:
    """Make a cone that points up along z, with its base cap."""
    side = _mantle(radius_m, 0.0, base_z_m, tip_z_m, segments)
    return joined([side, _cap(radius_m, base_z_m, -1.0, segments)])


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """Put meshes together, without merging vertices."""
    starts = np.cumsum([0, *(len(mesh.positions) for mesh in meshes)])
    return Mesh(
        positions=np.concatenate([mesh.positions for mesh in meshes]),
        normals=np.concatenate([mesh.normals for mesh in meshes]),
        uvs=np.concatenate([mesh.uvs for mesh in meshes]),
        triangles=np.concatenate(
            [mesh.triangles + start for mesh, start in zip(meshes, starts, strict=False)]
        ).astype(np.uint32),
    )


def _quad(corners: Floats, normal: Floats) -> Mesh:
    """Make a flat square of four corners, counter-clockwise from the lower left."""
    uvs = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    return packed(corners, np.tile(normal, (4, 1)), uvs, triangles)


def _mantle(low_m: float, high_m: float, low_z: float, high_z: float, segments: int) -> Mesh:
    """Make the round side of a truncated cone of two radii; smooth normals."""
    turns = np.linspace(0.0, 1.0, segments + 1)
    around = _circle(turns)
    slope = np.hypot(high_z - low_z, low_m - high_m)
    outward, upward = (high_z - low_z) / slope, (low_m - high_m) / slope
    heights = np.full(segments + 1, upward)
    low_normals = np.column_stack([around * outward, heights])
    # A tip has no normal of its own: each of its triangles takes that of its middle.
    shift = 0.5 / segments if high_m == 0.0 else 0.0
    high_normals = np.column_stack([_circle(turns + shift) * outward, heights])
    low = np.column_stack([around * low_m, np.full(segments + 1, low_z)])
    high = np.column_stack([around * high_m, np.full(segments + 1, high_z)])
    uvs = np.concatenate(
        [
            np.column_stack([turns, np.zeros_like(turns)]),
            np.column_stack([turns, np.ones_like(turns)]),
        ]
    )
    positions = np.concatenate([low, high])
    triangles = _grid_triangles(1, segments)
    triangles = triangles[_areas(positions, triangles) > 1e-12]
    return packed(positions, np.concatenate([low_normals, high_normals]), uvs, triangles)


def _cap(radius_m: float, z_m: float, facing: float, segments: int) -> Mesh:
    """Make a flat disc that faces up (1) or down (-1)."""
    around = _circle(np.arange(segments) / segments)
    rim = np.column_stack([around * radius_m, np.full(segments, z_m)])
    positions = np.concatenate([[[0.0, 0.0, z_m]], rim])
    uvs = np.concatenate([[[0.5, 0.5]], 0.5 + 0.5 * around * [1.0, facing]])
    normals = np.tile([0.0, 0.0, facing], (segments + 1, 1))
    first = np.arange(segments) + 1
    second = np.roll(first, -1)
    ends = (first, second) if facing > 0 else (second, first)
    return packed(positions, normals, uvs, np.column_stack([np.zeros_like(first), *ends]))


def _circle(turns: Floats) -> Floats:
    """(N, 2) points of the unit circle; whole turns land on the same point exactly."""
    angles = 2.0 * np.pi * (turns % 1.0)
    return np.column_stack([np.cos(angles), np.sin(angles)])


def _grid_triangles(rows: int, columns: int) -> NDArray[np.int64]:
    """Split the squares between rows + 1 rows of columns + 1 vertices, upwards, into triangles."""
    row, column = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    low_left = (row * (columns + 1) + column).reshape(-1)
    low_right, high_left = low_left + 1, low_left + columns + 1
    high_right = high_left + 1
    lower = np.column_stack([low_left, low_right, high_right])
    upper = np.column_stack([low_left, high_right, high_left])
    return np.stack([lower, upper], axis=1).reshape(-1, 3)


def _areas(positions: Floats, triangles: NDArray[np.int64]) -> Floats:
    a, b, c = (positions[triangles[:, corner]] for corner in range(3))
    areas: Floats = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return areas
