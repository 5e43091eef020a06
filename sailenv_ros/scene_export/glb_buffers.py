"""Binary part of a glTF file: arrays and pictures → buffer views and accessors, each array once."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.scene_export.textures import Picture
from sailenv_ros.types.model import Mesh

__all__ = ["GlbBuffers"]

_FLOAT, _UINT16, _UINT32 = 5126, 5123, 5125
_ARRAY, _INDICES = 34962, 34963

_MOST_SHORT = 65535
"""Most vertices that 16 bits can number; the last number would mean a restart."""


class GlbBuffers:
    """Accessors, buffer views and bytes of one file, in the order in which they are asked for."""

    def __init__(self) -> None:
        self.accessors: list[dict[str, Any]] = []
        self._meshes: dict[int, tuple[dict[str, int], int]] = {}
        self._vectors, self._uvs, self._indices = io.BytesIO(), io.BytesIO(), io.BytesIO()
        self._pictures: list[bytes] = []
        self._samples, self._of_samples = io.BytesIO(), list[dict[str, Any]]()

    def mesh(self, mesh: Mesh) -> tuple[dict[str, int], int]:
        """Return the accessors of a mesh's attributes by their names, and that of its indices."""
        if id(mesh) not in self._meshes:
            # The file's x, y, z are the body's y, z, x.
            positions = mesh.positions[:, [1, 2, 0]]
            attributes = {
                "POSITION": self._vertices(self._vectors, positions, 0, bounds=True),
                "NORMAL": self._vertices(self._vectors, _unit(mesh.normals[:, [1, 2, 0]]), 0),
                # v of the file runs down.
                "TEXCOORD_0": self._vertices(self._uvs, mesh.uvs * (1, -1) + (0, 1), 1),
            }
            self._meshes[id(mesh)] = attributes, self._numbers(mesh)
        return self._meshes[id(mesh)]

    def places(self, uvs: NDArray[Any]) -> int:
        """Return the accessor of texture coordinates whose v runs down."""
        return self._vertices(self._uvs, uvs, 1)

    def moved(self, positions: NDArray[Any], by: NDArray[Any], *, bounds: bool) -> int:
        """Return the accessor of what vertices of the body's axes become, less what they are."""
        away = (by.astype(np.float64) - positions)[:, [1, 2, 0]]
        return self._vertices(self._vectors, away, 0, bounds=bounds)

    def samples(self, values: NDArray[Any], *, bounds: bool = False) -> int:
        """Return the accessor of numbers of an animation, (N,) or (N, K)."""
        stream, values = self._samples, np.ascontiguousarray(values, "<f4")
        accessor: dict[str, Any] = {
            "byteOffset": stream.tell(),
            "componentType": _FLOAT,
            "count": len(values),
            "type": "SCALAR" if values.ndim == 1 else f"VEC{values.shape[1]}",
        }
        if bounds:
            accessor["min"] = [float(values.min())]
            accessor["max"] = [float(values.max())]
        stream.write(values.tobytes())
        self.accessors.append(accessor)
        self._of_samples.append(accessor)
        return len(self.accessors) - 1

    def picture(self, picture: Picture) -> int:
        """Return the number of the buffer view of a picture file; call it once for each."""
        self._pictures.append(picture.data)
        return 2 + len(self._pictures)

    def finished(self) -> tuple[list[dict[str, Any]], bytes]:
        """Return all buffer views, and the bytes that they are of."""
        blocks = [s.getvalue() for s in (self._vectors, self._uvs, self._indices)]
        views: list[dict[str, Any]] = []
        data = bytearray()
        for number, block in enumerate((*blocks, *self._pictures)):
            data += bytes(-len(data) % 4)
            view: dict[str, Any] = {"buffer": 0, "byteOffset": len(data), "byteLength": len(block)}
            if number < len(blocks):
                view["target"] = _INDICES if number == 2 else _ARRAY
            if number < 2:
                view["byteStride"] = 12 if number == 0 else 8
            views.append(view)
            data += block
        if self._of_samples:
            for accessor in self._of_samples:
                accessor["bufferView"] = len(views)
            data += bytes(-len(data) % 4)
            block = self._samples.getvalue()
            views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(block)})
            data += block
        return views, bytes(data + bytes(-len(data) % 4))

    def _vertices(
        self, stream: io.BytesIO, values: NDArray[Any], view: int, *, bounds: bool = False
    ) -> int:
        values = np.ascontiguousarray(values, "<f4")
        accessor: dict[str, Any] = {
            "bufferView": view,
            "byteOffset": stream.tell(),
            "componentType": _FLOAT,
            "count": len(values),
            "type": f"VEC{values.shape[1]}",
        }
        if bounds:
            accessor["min"] = values.min(axis=0).astype(float).tolist()
            accessor["max"] = values.max(axis=0).astype(float).tolist()
        stream.write(values.tobytes())
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def _numbers(self, mesh: Mesh) -> int:
        is_short = len(mesh.positions) <= _MOST_SHORT
        stream = self._indices
        stream.write(bytes(-stream.tell() % 4))
        self.accessors.append(
            {
                "bufferView": 2,
                "byteOffset": stream.tell(),
                "componentType": _UINT16 if is_short else _UINT32,
                "count": mesh.triangles.size,
                "type": "SCALAR",
            }
        )
        stream.write(mesh.triangles.astype("<u2" if is_short else "<u4").tobytes())
        return len(self.accessors) - 1


def _unit(normals: NDArray[np.float32]) -> NDArray[np.float64]:
    """Return normals of length 1, as glTF demands; up where there is none."""
    wide = normals.astype(np.float64)
    lengths = np.linalg.norm(wide, axis=1, keepdims=True)
    return np.where(lengths > 1e-6, wide / np.maximum(lengths, 1e-6), (0.0, 1.0, 0.0))
