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

from sailenv_ros.render.scene.clusters import CLUSTER, clusters_of
from sailenv_ros.render.scene.drawn_meshes import VERTEX, DrawnMesh, corners_of

__all__ = ["GeometryBuffers", "MeshSlice"]


@dataclass(frozen=True, slots=True)
class MeshSlice:
    """Position of a mesh in the index buffer and among the clusters."""

    first_index: int
    index_count: int
    first_cluster: int
    cluster_count: int


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
        Groups of triangles that lie together in them; see `clusters`.
    """

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._slices: dict[tuple[int, int], MeshSlice] = {}
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
        self._slices = {}
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
                first_index, triangles.size, first_cluster, len(groups)
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
