"""Meshes on the GPU: one vertex buffer and one index buffer for everything that was ever drawn.

Models come in, slices of the two buffers go out. A model is uploaded once, whenever it is first
seen; the buffers grow by doubling.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import moderngl
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.model import Mesh, Model

__all__ = ["GeometryBuffers", "MeshSlice"]

VERTEX = np.dtype([("position", "<f4", 3), ("normal", "<f4", 3), ("uv", "<f4", 2)])


@dataclass(frozen=True, slots=True)
class MeshSlice:
    """Where a mesh lies in the buffers, in indices and vertices."""

    first_index: int
    index_count: int
    first_vertex: int


class GeometryBuffers:
    """All meshes of one context."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._vertices = np.zeros(0, VERTEX)
        self._indices = np.zeros(0, np.uint32)
        self._slices: dict[int, MeshSlice] = {}
        self._kept: list[Mesh] = []
        self.vertex_buffer: moderngl.Buffer | None = None
        self.index_buffer: moderngl.Buffer | None = None

    def upload(self, models: Iterable[Model]) -> bool:
        """Make sure that all meshes are there; True if the buffers are new ones."""
        new = [
            part.mesh
            for model in {id(m): m for m in models}.values()
            for part in model.parts
            if id(part.mesh) not in self._slices
        ]
        unique = list({id(mesh): mesh for mesh in new}.values())
        if not unique and self.vertex_buffer is not None:
            return False
        vertices, indices = [self._vertices], [self._indices]
        vertex_count, index_count = len(self._vertices), len(self._indices)
        for mesh in unique:
            self._slices[id(mesh)] = MeshSlice(index_count, mesh.triangles.size, vertex_count)
            # The number of an object is unique only while the object lives.
            self._kept.append(mesh)
            vertices.append(_interleaved(mesh))
            indices.append(mesh.triangles.reshape(-1))
            vertex_count += len(mesh.positions)
            index_count += mesh.triangles.size
        self._vertices = np.concatenate(vertices)
        self._indices = np.concatenate(indices)
        self.close()
        self.vertex_buffer = self._context.buffer(_or_one(self._vertices).tobytes())
        self.index_buffer = self._context.buffer(_or_one(self._indices).tobytes())
        return True

    def slice(self, mesh: Mesh) -> MeshSlice:
        """Say where an uploaded mesh lies."""
        return self._slices[id(mesh)]

    def close(self) -> None:
        """Free the buffers; what was uploaded is kept in memory."""
        for buffer in (self.vertex_buffer, self.index_buffer):
            if buffer is not None:
                buffer.release()
        self.vertex_buffer = self.index_buffer = None


def _interleaved(mesh: Mesh) -> NDArray[np.void]:
    result = np.zeros(len(mesh.positions), VERTEX)
    result["position"], result["normal"], result["uv"] = mesh.positions, mesh.normals, mesh.uvs
    return result


def _or_one(array: NDArray[np.void] | NDArray[np.uint32]) -> NDArray[np.generic]:
    """OpenGL has no empty buffers."""
    return array if array.size else np.zeros(1, array.dtype)
