"""Meshes on the GPU: one vertex buffer and one index buffer for everything that is drawn.

Models come in, slices of the two buffers go out. The buffers are made anew when a mesh appears
that is not there, and then hold what the present scene shows and nothing else.
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
    """The meshes of the scene that is shown, in one context."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._slices: dict[int, MeshSlice] = {}
        self._kept: list[Mesh] = []
        self.vertex_buffer = context.buffer(np.zeros(1, VERTEX).tobytes())
        self.index_buffer = context.buffer(np.zeros(1, np.uint32).tobytes())

    def show(self, models: Iterable[Model]) -> None:
        """Make sure that the meshes of these models are there; others may be gone afterwards."""
        wanted = list({id(part.mesh): part.mesh for m in models for part in m.parts}.values())
        held = sum(len(mesh.positions) for mesh in self._kept)
        needed = sum(len(mesh.positions) for mesh in wanted)
        if all(id(mesh) in self._slices for mesh in wanted) and held <= 2 * needed:
            return
        self._slices = {}
        # The number of an object is unique only while the object lives: it is kept.
        self._kept = wanted
        first_index = first_vertex = 0
        for mesh in wanted:
            self._slices[id(mesh)] = MeshSlice(first_index, mesh.triangles.size, first_vertex)
            first_vertex += len(mesh.positions)
            first_index += mesh.triangles.size
        vertices = [np.zeros(0, VERTEX), *(_interleaved(mesh) for mesh in wanted)]
        indices = [np.zeros(0, np.uint32), *(mesh.triangles.reshape(-1) for mesh in wanted)]
        self.close()
        self.vertex_buffer = self._context.buffer(_or_one(np.concatenate(vertices)).tobytes())
        self.index_buffer = self._context.buffer(_or_one(np.concatenate(indices)).tobytes())

    def slice(self, mesh: Mesh) -> MeshSlice:
        """Say where a mesh that is shown lies."""
        return self._slices[id(mesh)]

    def close(self) -> None:
        """Free the buffers."""
        self.vertex_buffer.release()
        self.index_buffer.release()


def _interleaved(mesh: Mesh) -> NDArray[np.void]:
    result = np.zeros(len(mesh.positions), VERTEX)
    result["position"], result["normal"], result["uv"] = mesh.positions, mesh.normals, mesh.uvs
    return result


def _or_one(array: NDArray[np.void] | NDArray[np.uint32]) -> NDArray[np.generic]:
    """OpenGL has no empty buffers."""
    return array if array.size else np.zeros(1, array.dtype)
