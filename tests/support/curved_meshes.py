"""Meshes of rows and columns of points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.model import Mesh


def sheet(points: NDArray[np.float64], normals: NDArray[np.float64]) -> Mesh:
    """Make a mesh of rows and columns of points, (R, C, 3)."""
    rows, columns = points.shape[:2]
    at = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]
    triangles = np.concatenate(
        [np.stack(corners, axis=-1).reshape(-1, 3) for corners in ((a, b, c), (a, c, d))]
    )
    flat = points.reshape(-1, 3)[triangles]
    across = np.cross(flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0])
    away = (across * normals.reshape(-1, 3)[triangles[:, 0]]).sum(axis=1) < 0.0
    triangles[away] = triangles[away][:, ::-1]
    return Mesh(
        positions=points.reshape(-1, 3).astype(np.float32),
        normals=normals.reshape(-1, 3).astype(np.float32),
        uvs=np.zeros((rows * columns, 2), np.float32),
        triangles=triangles.astype(np.uint32),
    )


def bowl(around: int = 48) -> Mesh:
    """Make the inside of the lower half of a unit sphere."""
    down, turn = np.meshgrid(
        np.linspace(0.02, np.pi / 2, around // 3), np.linspace(0, 2 * np.pi, around), indexing="ij"
    )
    out = np.stack(
        [np.sin(down) * np.cos(turn), np.sin(down) * np.sin(turn), -np.cos(down)], axis=-1
    )
    return sheet(out, -out)
