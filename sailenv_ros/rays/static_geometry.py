"""Everything that stands still as one soup of triangles in the world frame.

From a `WorldSnapshot` to `StaticGeometry`. Knows neither rays nor light maps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.rays.model_triangles import ModelTriangles, joined, triangles_of
from sailenv_ros.types.model import Material, Model
from sailenv_ros.types.snapshot import WorldSnapshot

__all__ = ["PlacedModel", "StaticGeometry", "StaticInstance", "static_geometry_of"]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class PlacedModel:
    """A model where it stands.

    Attributes
    ----------
    id : int
        Of the instance.
    model : Model
    scale : (3,) tuple of float
    world_from_body : (4, 4) float64
    """

    id: int
    model: Model
    scale: tuple[float, float, float]
    world_from_body: NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class StaticInstance(PlacedModel):
    """One object that stands still.

    Attributes
    ----------
    first_triangle : int
        Place of its first triangle in the static geometry; its parts' follow in their order.
    """

    first_triangle: int


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class StaticGeometry:
    """Triangles of everything that stands still, in the world frame [m].

    Attributes
    ----------
    instances : tuple of StaticInstance
    materials : tuple of Material
    corners, normals : (T, 3, 3) float32
        Of each triangle its three corners, and the unit normals there.
    uvs : (T, 3, 2) float32
        Texture coordinates of the corners.
    faces : (T, 3) float32
        Unit normals of the triangles, 0 of those without area.
    owner : (T,) int32
        Place in `instances` of each triangle.
    material : (T,) int32
        Place in `materials` of each triangle.
    solid : (T,) bool
        False for what light passes: glass, and what a mask leaves mostly open.
    passes : (T,) float32
        Share of the light that is let through: 1 - alpha for glass.
    """

    instances: tuple[StaticInstance, ...]
    materials: tuple[Material, ...]
    corners: NDArray[np.float32]
    normals: NDArray[np.float32]
    uvs: NDArray[np.float32]
    faces: NDArray[np.float32]
    owner: NDArray[np.int32]
    material: NDArray[np.int32]
    solid: NDArray[np.bool_]
    passes: NDArray[np.float32]

    @property
    def two_sided(self) -> NDArray[np.bool_]:
        """(T,) bool: triangles whose back is drawn like their front."""
        table = np.array([material.double_sided for material in self.materials], dtype=bool)
        return table[self.material]

    @property
    def triangle_count(self) -> int:
        """Number of triangles."""
        return len(self.corners)

    def bounds(self) -> NDArray[np.float64]:
        """Return (2, 3) float64: lowest and highest corner [m]; zeros if there is nothing."""
        if not len(self.corners):
            return np.zeros((2, 3))
        points = self.corners.reshape(-1, 3).astype(np.float64)
        return np.stack([points.min(axis=0), points.max(axis=0)])


def static_geometry_of(snapshot: WorldSnapshot) -> StaticGeometry:
    """Gather what stands still in a snapshot."""
    gathered: dict[int, ModelTriangles] = {}
    instances: list[StaticInstance] = []
    pieces: list[ModelTriangles] = []
    corners, normals, material = [], [], []
    materials: list[Material] = []
    count = 0
    for drawn, pose in zip(snapshot.contents.instances, snapshot.world_from_body, strict=True):
        model = drawn.model
        if not drawn.is_baked or not model.triangle_count:
            continue
        if id(model) not in gathered:
            gathered[id(model)] = triangles_of(model)
        own = gathered[id(model)]
        scale, rotation = np.asarray(drawn.scale, np.float64), pose[:3, :3]
        corners.append((own.corners * scale) @ rotation.T + pose[:3, 3])
        turned = (own.normals / scale) @ rotation.T
        length = np.linalg.norm(turned, axis=2, keepdims=True)
        normals.append(turned / np.maximum(length, 1e-12))
        material.append(own.part + len(materials))
        materials += own.materials
        pieces.append(own)
        instances.append(
            StaticInstance(
                id=drawn.instance.id,
                model=model,
                scale=drawn.scale,
                world_from_body=pose,
                first_triangle=count,
            )
        )
        count += len(own.corners)
    world = joined(corners, (3, 3))
    faces = np.cross(world[:, 1] - world[:, 0], world[:, 2] - world[:, 0])
    faces /= np.maximum(np.linalg.norm(faces, axis=1, keepdims=True), 1e-20)
    passes = joined([piece.passes for piece in pieces], ())
    owner = np.repeat(np.arange(len(pieces)), [len(piece.corners) for piece in pieces])
    return StaticGeometry(
        instances=tuple(instances),
        materials=tuple(materials),
        corners=world,
        normals=joined(normals, (3, 3)),
        uvs=joined([piece.uvs for piece in pieces], (3, 2)),
        faces=faces.astype(np.float32),
        owner=owner.astype(np.int32),
        material=np.concatenate([np.zeros(0, np.int32), *material]).astype(np.int32),
        solid=passes == 0.0,
        passes=passes,
    )
