"""Meshes on the GPU: one vertex buffer and one index buffer for everything that is drawn.

The parts of a scene come in, slices of the two buffers go out. The buffers are made anew when a
mesh appears that is not there, and then hold what the present scene shows and nothing else.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import moderngl
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.baked_light import Unwrapping
from sailenv_ros.model import Mesh
from sailenv_ros.render.clusters import CLUSTER, clusters_of
from sailenv_ros.snapshot import SceneContents

__all__ = ["DrawnMesh", "GeometryBuffers", "MeshSlice", "corners_of", "drawn_meshes"]

VERTEX = np.dtype(
    [("position", "<f4", 3), ("normal", "<f4", 3), ("uv", "<f4", 2), ("light_uv", "<f4", 2)]
)


@dataclass(frozen=True, eq=False, slots=True)
class DrawnMesh:
    """A mesh as it is drawn: with places in a light map if its model was unwrapped.

    Attributes
    ----------
    mesh : Mesh
    unwrapping : Unwrapping or None
    part : int
        Number of the mesh among its model's parts.
    """

    mesh: Mesh
    unwrapping: Unwrapping | None
    part: int

    @property
    def key(self) -> tuple[int, int]:
        """What tells drawn meshes apart while both objects live."""
        return id(self.mesh), id(self.unwrapping)

    @property
    def triangles(self) -> NDArray[np.uint32]:
        """(M, 3) uint32: indices into `vertices`."""
        return (
            self.mesh.triangles if self.unwrapping is None else self.unwrapping.triangles[self.part]
        )

    @property
    def vertex_count(self) -> int:
        """How many vertices are drawn."""
        return len(
            self.mesh.positions if self.unwrapping is None else self.unwrapping.vertices[self.part]
        )

    def interleaved(self) -> NDArray[np.void]:
        """Give the vertices as the buffer holds them."""
        mesh = self.mesh
        result = np.zeros(self.vertex_count, VERTEX)
        chosen: slice | NDArray[np.uint32] = slice(None)
        if self.unwrapping is not None:
            chosen = self.unwrapping.vertices[self.part]
            result["light_uv"] = self.unwrapping.uvs[self.part]
        result["position"] = mesh.positions[chosen]
        result["normal"] = mesh.normals[chosen]
        result["uv"] = mesh.uvs[chosen]
        return result


def drawn_meshes(contents: SceneContents) -> list[list[DrawnMesh]]:
    """Give the meshes of each instance's parts, in their order."""
    charts = contents.baked.charts if contents.baked is not None else {}
    result = []
    for drawn in contents.instances:
        chart = charts.get(drawn.instance.id)
        flat = chart.unwrapping if chart is not None else None
        result.append(
            [DrawnMesh(part.mesh, flat, place) for place, part in enumerate(drawn.model.parts)]
        )
    return result


@dataclass(frozen=True, slots=True)
class MeshSlice:
    """Where a mesh lies in the index buffer and among the clusters."""

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
        """Say where a mesh that is shown lies."""
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


def corners_of(
    positions: NDArray[np.float32], triangles: NDArray[np.uint32]
) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Give each place that triangles use a number, in the order in which they do.

    Parameters
    ----------
    positions : (V, 3) float32
    triangles : (M, 3) uint32

    Returns
    -------
    corners : (K, 3) float32
        Places, each once, bit for bit.
    triangles : (M, 3) uint32
        The same triangles of corners.
    """
    if not triangles.size:
        return np.zeros((0, 3), np.float32), triangles
    bits = np.ascontiguousarray(positions).view(np.uint32)
    order = np.lexsort(bits.T)
    differs = (np.diff(bits[order], axis=0) != 0).any(axis=1)
    place_of = np.empty(len(positions), np.int64)
    place_of[order] = np.concatenate([[0], np.cumsum(differs)])
    used, first, corner_of = np.unique(
        place_of[triangles.reshape(-1)], return_index=True, return_inverse=True
    )
    rank = np.empty(len(used), np.uint32)
    by_use = np.argsort(first)
    rank[by_use] = np.arange(len(used), dtype=np.uint32)
    corners = positions[triangles.reshape(-1)[first[by_use]]]
    return corners, rank[corner_of.reshape(-1)].reshape(-1, 3)


def _or_one(
    array: NDArray[np.void] | NDArray[np.uint32] | NDArray[np.float32],
) -> NDArray[np.generic]:
    """OpenGL has no empty buffers."""
    return array if array.size else np.zeros(1, array.dtype)
