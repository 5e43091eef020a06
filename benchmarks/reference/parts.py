"""Files that a traced scene is made of: textures and meshes, each named by what it holds.

Arrays and triangles in, names of files out. Equal content has one name, so the text of a scene
that names its files says all that its light depends on.
"""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Parts", "ply_bytes"]

_VERTEX = np.dtype([("at", "<f4", 3), ("facing", "<f4", 3), ("place", "<f4", 2)])
_FACE = np.dtype([("corners", "u1"), ("vertices", "<i4", 3)])
_HEADER = """ply
format binary_little_endian 1.0
element vertex {vertices}
property float x
property float y
property float z
property float nx
property float ny
property float nz
property float u
property float v
element face {faces}
property list uchar int vertex_indices
end_header
"""


class Parts:
    """A folder of such files."""

    def __init__(self, folder: Path) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.folder = folder
        # An object's number is its own only while it lives: the arrays are kept.
        self._known: dict[int, tuple[NDArray[Any], str]] = {}

    def array(self, array: NDArray[Any]) -> str:
        """Store an array; return the name of its file."""
        if id(array) not in self._known:
            head = f"{array.dtype.str}{array.shape}".encode()
            name = _named(head + np.ascontiguousarray(array).tobytes(), ".npy")
            if not (self.folder / name).exists():
                with (self.folder / f"{name}.part").open("wb") as file:
                    np.save(file, array)
                (self.folder / f"{name}.part").rename(self.folder / name)
            self._known[id(array)] = (array, name)
        return self._known[id(array)][1]

    def mesh(self, content: bytes) -> str:
        """Store what `ply_bytes` made; return the name of its file."""
        name = _named(content, ".ply")
        if not (self.folder / name).exists():
            (self.folder / f"{name}.part").write_bytes(content)
            (self.folder / f"{name}.part").rename(self.folder / name)
        return name


def ply_bytes(
    positions: NDArray[Any], normals: NDArray[Any], uvs: NDArray[Any], triangles: NDArray[Any]
) -> bytes:
    """Return a binary PLY file's content.

    Parameters
    ----------
    positions, normals : (N, 3) float
    uvs : (N, 2) float
        As they are written.
    triangles : (M, 3) int
    """
    vertices = np.zeros(len(positions), _VERTEX)
    vertices["at"], vertices["facing"], vertices["place"] = positions, normals, uvs
    faces = np.zeros(len(triangles), _FACE)
    faces["corners"], faces["vertices"] = 3, triangles
    head = _HEADER.format(vertices=len(vertices), faces=len(faces))
    return head.encode() + vertices.tobytes() + faces.tobytes()


def _named(content: bytes, suffix: str) -> str:
    return hashlib.sha256(content).hexdigest()[:24] + suffix
