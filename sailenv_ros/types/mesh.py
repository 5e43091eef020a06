"""Triangles of one material."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import AssetError

__all__ = ["Mesh", "joined_vectors"]


@dataclass(frozen=True, eq=False, kw_only=True)
class Mesh:
    """Triangles of one material; arrays are read-only.

    Attributes
    ----------
    positions : (N, 3) float32
        Vertices in the body frame (x forward, y left, z up) [m].
    normals : (N, 3) float32
        Unit normals of the vertices.
    uvs : (N, 2) float32
        Texture coordinates, v from the texture's bottom row up (glTF's v is flipped on import).
    triangles : (M, 3) uint32
        Vertex indices, counter-clockwise seen from outside.
    """

    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    uvs: NDArray[np.float32]
    triangles: NDArray[np.uint32]

    def __post_init__(self) -> None:
        count = len(self.positions)
        expected = {"positions": (count, 3), "normals": (count, 3), "uvs": (count, 2)}
        for name, shape in expected.items():
            array = np.ascontiguousarray(getattr(self, name), dtype=np.float32)
            if array.shape != shape or not np.isfinite(array).all():
                raise AssetError("mesh", f"{name} must be {shape} finite numbers")
            array.flags.writeable = False
            object.__setattr__(self, name, array)
        triangles = np.ascontiguousarray(self.triangles, dtype=np.uint32)
        if triangles.ndim != 2 or triangles.shape[1] != 3:
            raise AssetError("mesh", f"triangles must be (M, 3), got {triangles.shape}")
        if triangles.size and int(triangles.max()) >= count:
            raise AssetError("mesh", f"a triangle names vertex {triangles.max()} of {count}")
        triangles.flags.writeable = False
        object.__setattr__(self, "triangles", triangles)


def joined_vectors(meshes: Iterable[NDArray[np.float32]]) -> NDArray[np.float32]:
    """Return vectors of some meshes, one mesh after another, as one read-only array (V, 3)."""
    joined = np.concatenate([np.zeros((0, 3), np.float32), *meshes])
    joined.flags.writeable = False
    return joined
