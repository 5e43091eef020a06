"""Meshes as the native kernels read them; each is made once and kept while it is shown."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.deformation_kernels import bounding_sphere, move_mesh
from sailenv_ros.native.mesh_kernels import clusters_of, corners_of
from sailenv_ros.render.scene.drawn_meshes import DrawnMesh, corner_sources
from sailenv_ros.types.deformation import MovedMesh

__all__ = ["MeshArrays", "MeshStore"]

_NO_SOURCES = np.zeros(0, np.uint32)

_PADDING = 8
"""Corners are read eight at a time."""


@dataclass(eq=False, slots=True)
class MeshArrays:
    """One mesh; written again only where its vertices move.

    Attributes
    ----------
    drawn : DrawnMesh
        Kept: its number is unique only while it lives.
    corners : (3, K + 8) float32
        Positions [m], each once, coordinate by coordinate.
    corner_count : int
    corner_indices, vertex_indices : (3 M,) uint32
        Triangles in the order of the clusters.
    vertices : (V, 8) float32
        Normal, uv, place in the light map, 0.
    clusters : (C,) CLUSTER
    sphere : (4,) float64
        Centre and radius of a sphere around everything [m].
    corner_sources : (K,) uint32
        A vertex of each corner.
    """

    drawn: DrawnMesh
    corners: NDArray[np.float32]
    corner_count: int
    corner_indices: NDArray[np.uint32]
    vertex_indices: NDArray[np.uint32]
    vertices: NDArray[np.float32]
    clusters: NDArray[np.void]
    sphere: NDArray[np.float64]
    corner_sources: NDArray[np.uint32]
    _moved: MovedMesh | None = field(default=None, init=False)

    def move(self, moved: MovedMesh) -> None:
        """Take the vertices of an instant."""
        if moved is self._moved:
            return
        self._moved = moved
        self.sphere = move_mesh(
            *moved,
            self.corner_sources,
            self.corner_indices,
            self.corners,
            self.vertices,
            self.clusters,
        )


class MeshStore:
    """The meshes of the scenes that were shown last."""

    def __init__(self) -> None:
        self._meshes: dict[tuple[int, int, int, int], MeshArrays] = {}

    def get(self, drawn: DrawnMesh) -> MeshArrays:
        """Return a mesh; it is made if it is not there."""
        found = self._meshes.get(drawn.key)
        if found is None:
            found = self._meshes[drawn.key] = _mesh_arrays(drawn)
        return found

    def trim(self, shown: Iterable[DrawnMesh]) -> None:
        """Forget what is not shown, if that is more than what is."""
        kept = {drawn.key for drawn in shown}
        sizes = {key: len(mesh.vertices) for key, mesh in self._meshes.items()}
        if sum(sizes.values()) > 2 * sum(sizes[key] for key in kept):
            self._meshes = {key: mesh for key, mesh in self._meshes.items() if key in kept}


def _mesh_arrays(drawn: DrawnMesh) -> MeshArrays:
    made = drawn.interleaved()
    triangles, clusters = clusters_of(made["position"], drawn.triangles)
    corners, numbers = corners_of(made["position"], triangles)
    columns = np.zeros((3, len(corners) + _PADDING), np.float32)
    columns[:, : len(corners)] = corners.T
    vertices = np.zeros((len(made), 8), np.float32)
    vertices[:, :3] = made["normal"]
    vertices[:, 3:5] = made["uv"]
    vertices[:, 5:7] = made["light_uv"]
    return MeshArrays(
        drawn=drawn,
        corners=columns,
        corner_count=len(corners),
        corner_indices=numbers.reshape(-1),
        vertex_indices=triangles.reshape(-1),
        vertices=vertices,
        clusters=clusters,
        sphere=bounding_sphere(columns, len(corners)),
        corner_sources=corner_sources(triangles, numbers) if drawn.owner else _NO_SOURCES,
    )
