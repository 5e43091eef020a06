"""Meshes and convex hulls as Wavefront files, each once: for formats whose geometry lies beside.

Wavefront, "Object Files (.obj)", appendix B1 of the Advanced Visualizer's manual (1995).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.scene_export.names import FreeNames
from sailenv_ros.types.model import ConvexShape, Mesh

__all__ = ["MeshFiles", "hull_bytes", "hull_corners", "hull_triangles", "obj_bytes"]

LEAST_THICKNESS_M = 2e-4
"""Hulls are made at least as thick, since programs refuse hulls without a volume [m]."""


class MeshFiles:
    """Files of meshes by the meshes; the same mesh has the same file."""

    def __init__(self) -> None:
        self.files: dict[str, bytes] = {}
        self._names = FreeNames()
        self._of: dict[int, str] = {}

    def of(self, mesh: Mesh, wanted: str, *, textured: bool = True) -> str:
        """Return the name of a mesh's file; `wanted` is what it is called the first time."""
        if id(mesh) not in self._of:
            self._of[id(mesh)] = self.add(wanted, obj_bytes(mesh, textured=textured))
        return self._of[id(mesh)]

    def add(self, wanted: str, data: bytes) -> str:
        """Add a file; return its name."""
        name = f"{self._names.take(wanted)}.obj"
        self.files[name] = data
        return name


def obj_bytes(mesh: Mesh, *, textured: bool) -> bytes:
    """Return a mesh as a Wavefront file, with texture coordinates where they are wanted."""
    lines = [_rows("v", mesh.positions)]
    if textured:
        lines.append(_rows("vt", mesh.uvs))
    lines.append(_rows("vn", mesh.normals))
    corner = "%d/%d/%d" if textured else "%d//%d"
    numbers = np.repeat(mesh.triangles.reshape(-1).astype(np.int64) + 1, 3 if textured else 2)
    face = f"f {corner} {corner} {corner}\n"
    lines.append((face * len(mesh.triangles)) % tuple(numbers.tolist()))
    return "".join(lines).encode("ascii")


def hull_corners(shape: ConvexShape) -> NDArray[np.float64]:
    """Return (N, 3): the corners of a hull, one without a volume made a little thicker [m]."""
    from scipy.spatial import ConvexHull

    points = np.asarray(shape.points, np.float64)
    spread = points - points.mean(axis=0)
    axes = np.linalg.eigh(spread.T @ spread)[1].T
    thin = [axis for axis in axes if np.ptp(spread @ axis) < LEAST_THICKNESS_M]
    for axis in thin:
        step = 0.5 * LEAST_THICKNESS_M * axis
        points = np.concatenate([points - step, points + step])
    return np.asarray(points[ConvexHull(points).vertices])


def hull_triangles(shape: ConvexShape) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Return corners (N, 3) [m] and triangles (M, 3) of a hull, which face outwards."""
    from scipy.spatial import ConvexHull

    corners = hull_corners(shape)
    hull = ConvexHull(corners)
    triangles = hull.simplices.copy()
    a, b, c = (corners[triangles[:, k]] for k in range(3))
    inwards = np.einsum("ni,ni->n", np.cross(b - a, c - a), hull.equations[:, :3]) < 0.0
    triangles[inwards] = triangles[inwards][:, ::-1]
    return corners, triangles


def hull_bytes(shape: ConvexShape) -> bytes:
    """Return a convex hull as a Wavefront file."""
    corners, triangles = hull_triangles(shape)
    faces = ("f %d %d %d\n" * len(triangles)) % tuple((triangles.reshape(-1) + 1).tolist())
    return (_rows("v", corners) + faces).encode("ascii")


def _rows(word: str, values: NDArray[np.floating]) -> str:
    row = f"{word}{' %.7g' * values.shape[1]}\n"
    return (row * len(values)) % tuple(values.reshape(-1).tolist())
