"""Meshes on the GPU: one vertex buffer and one index buffer for everything that is drawn.

The parts of a scene come in, slices of the two buffers go out. The buffers are made again when a
mesh appears that is not there, and then hold what the present scene shows and nothing else.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import moderngl
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.deformation_kernels import move_clusters
from sailenv_ros.native.mesh_kernels import clusters_of, corners_of
from sailenv_ros.native.render_types import CLUSTER
from sailenv_ros.render.scene.drawn_meshes import (
    VERTEX,
    DrawnMesh,
    corner_sources,
)
from sailenv_ros.types.deformation import MovedMesh

__all__ = ["GeometryBuffers", "MeshSlice"]


@dataclass(frozen=True, slots=True)
class MeshSlice:
    """Position of a mesh in the index buffer and among the clusters."""

    first_index: int
    index_count: int
    first_cluster: int
    cluster_count: int
    first_vertex: int


@dataclass(eq=False, slots=True)
class _MovingMesh:
    """A mesh whose vertices move: what the buffers hold of it, and where.

    `clusters` count their indices from its own first one.
    """

    vertices: NDArray[np.void]
    first_vertex: int
    corner_sources: NDArray[np.uint32]
    corner_indices: NDArray[np.uint32]
    first_corner: int
    clusters: NDArray[np.void]
    first_cluster: int
    moved: MovedMesh | None = None


class GeometryBuffers:
    """The meshes of the scene that is shown, in one context.

    Attributes
    ----------
    vertex_buffer, index_buffer : Buffer
        Everything that is known of a vertex.
    corner_buffer, corner_index_buffer : Buffer
        The same triangles by position alone: where vertices differ in nothing else, there is one
        corner. Furniture has about half as many corners as vertices.
    indices, corner_indices : (I,) uint32
        What the index buffers hold.
    clusters : (C,) CLUSTER
        Groups of triangles that lie together in them; see `mesh_kernels`.
    """

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._slices: dict[tuple[int, int, int, int], MeshSlice] = {}
        self._moving: dict[tuple[int, int, int, int], _MovingMesh] = {}
        self._kept: list[DrawnMesh] = []
        self.vertex_buffer = context.buffer(np.zeros(1, VERTEX).tobytes())
        self.index_buffer = context.buffer(np.zeros(1, np.uint32).tobytes())
        self.corner_buffer = context.buffer(np.zeros(3, np.float32).tobytes())
        self.corner_index_buffer = context.buffer(np.zeros(1, np.uint32).tobytes())
        self.indices = self.corner_indices = np.zeros(0, np.uint32)
        self.clusters = np.zeros(0, CLUSTER)

    def show(self, meshes: Iterable[DrawnMesh]) -> None:
        """Make sure that these meshes are there; others may be gone afterwards."""
        wanted = list({mesh.key: mesh for mesh in meshes}.values())
        held = sum(mesh.vertex_count for mesh in self._kept)
        needed = sum(mesh.vertex_count for mesh in wanted)
        if all(mesh.key in self._slices for mesh in wanted) and held <= 2 * needed:
            return
        self._slices, self._moving = {}, {}
        # The number of an object is unique only while the object lives: it is kept.
        self._kept = wanted
        first_index = first_vertex = first_corner = first_cluster = 0
        vertices, indices = [np.zeros(0, VERTEX)], [np.zeros(0, np.uint32)]
        corners, corner_indices = [np.zeros((0, 3), np.float32)], [np.zeros(0, np.uint32)]
        clusters = [np.zeros(0, CLUSTER)]
        for mesh in wanted:
            made = mesh.interleaved()
            triangles, groups = clusters_of(made["position"], mesh.triangles)
            places, numbers = corners_of(made["position"], triangles)
            self._slices[mesh.key] = MeshSlice(
                first_index, triangles.size, first_cluster, len(groups), first_vertex
            )
            if mesh.owner:
                self._moving[mesh.key] = _MovingMesh(
                    vertices=made.copy(),
                    first_vertex=first_vertex,
                    corner_sources=corner_sources(triangles, numbers),
                    corner_indices=numbers.reshape(-1),
                    first_corner=first_corner,
                    clusters=groups.copy(),
                    first_cluster=first_cluster,
                )
            groups["first_index"] += first_index
            vertices.append(made)
            corners.append(places)
            indices.append(triangles.reshape(-1) + np.uint32(first_vertex))
            corner_indices.append(numbers.reshape(-1) + np.uint32(first_corner))
            clusters.append(groups)
            first_vertex += len(made)
            first_corner += len(places)
            first_index += triangles.size
            first_cluster += len(groups)
        self.close()
        self.indices, self.clusters = np.concatenate(indices), np.concatenate(clusters)
        self.vertex_buffer = self._context.buffer(_or_one(np.concatenate(vertices)).tobytes())
        self.index_buffer = self._context.buffer(_or_one(self.indices).tobytes())
        self.corner_indices = np.concatenate(corner_indices)
        self.corner_buffer = self._context.buffer(_or_one(np.concatenate(corners)).tobytes())
        self.corner_index_buffer = self._context.buffer(_or_one(self.corner_indices).tobytes())

    def slice(self, mesh: DrawnMesh) -> MeshSlice:
        """Return where a mesh that is shown lies."""
        return self._slices[mesh.key]

    def move(self, mesh: DrawnMesh, moved: MovedMesh) -> None:
        """Put the vertices of a mesh that is shown, and has an owner, to other places."""
        held = self._moving[mesh.key]
        if held.moved is moved:
            return
        held.moved = moved
        held.vertices["position"], held.vertices["normal"] = moved.positions, moved.normals
        corners = moved.positions[held.corner_sources]
        move_clusters(corners, held.corner_indices, held.clusters)
        shown = self.clusters[held.first_cluster : held.first_cluster + len(held.clusters)]
        for name in ("centre", "radius", "axis", "cosine"):
            shown[name] = held.clusters[name]
        if len(corners):
            at = held.first_vertex * VERTEX.itemsize
            self.vertex_buffer.write(held.vertices.tobytes(), offset=at)
            at = held.first_corner * 3 * corners.itemsize
            self.corner_buffer.write(corners.tobytes(), offset=at)

    def close(self) -> None:
        """Free the buffers."""
        for buffer in (
            self.vertex_buffer,
            self.index_buffer,
            self.corner_buffer,
            self.corner_index_buffer,
        ):
            buffer.release()


def _or_one(
    array: NDArray[np.void] | NDArray[np.uint32] | NDArray[np.float32],
) -> NDArray[np.generic]:
    """OpenGL has no empty buffers."""
    return array if array.size else np.zeros(1, array.dtype)
