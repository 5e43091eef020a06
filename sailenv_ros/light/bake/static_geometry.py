"""Everything that stands still as one soup of triangles in the world frame.

From a `WorldSnapshot` to `StaticGeometry`. Knows neither rays nor light maps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.masks import is_mostly_there
from sailenv_ros.types.model import Material, Mesh, Model
from sailenv_ros.types.snapshot import WorldSnapshot

__all__ = ["StaticGeometry", "StaticInstance", "static_geometry_of"]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class StaticInstance:
    """One object that stands still.

    Attributes
    ----------
    id : int
        Of the instance.
    model : Model
    scale : (3,) tuple of float
    world_from_body : (4, 4) float64
    first_triangle : int
        Place of its first triangle in the static geometry; its parts' follow in their order.
    """

    id: int
    model: Model
    scale: tuple[float, float, float]
    world_from_body: NDArray[np.float64]
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
    instances: list[StaticInstance] = []
    materials: list[Material] = []
    pieces: list[_Piece] = []
    count = 0
    for drawn, pose in zip(snapshot.contents.instances, snapshot.world_from_body, strict=True):
        if not drawn.is_baked or not drawn.model.triangle_count:
            continue
        instance = StaticInstance(
            id=drawn.instance.id,
            model=drawn.model,
            scale=drawn.scale,
            world_from_body=pose,
            first_triangle=count,
        )
        for part in drawn.model.parts:
            pieces.append(_Piece(instance, part.mesh, len(instances), len(materials)))
            materials.append(part.material)
            count += len(part.mesh.triangles)
        instances.append(instance)
    return _joined(tuple(instances), tuple(materials), pieces)


class _Piece:
    """One part of one instance in the world frame."""

    def __init__(self, instance: StaticInstance, mesh: Mesh, owner: int, material: int) -> None:
        scale = np.asarray(instance.scale, dtype=np.float64)
        rotation = instance.world_from_body[:3, :3]
        points = (mesh.positions * scale) @ rotation.T + instance.world_from_body[:3, 3]
        normals = (mesh.normals / scale) @ rotation.T
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        self.corners = points[mesh.triangles].astype(np.float32)
        self.normals = (normals / np.maximum(length, 1e-12))[mesh.triangles].astype(np.float32)
        self.uvs = mesh.uvs[mesh.triangles]
        self.owner, self.material = owner, material


def _joined(
    instances: tuple[StaticInstance, ...], materials: tuple[Material, ...], pieces: list[_Piece]
) -> StaticGeometry:
    def join(name: str, shape: tuple[int, ...]) -> NDArray[np.float32]:
        arrays = [getattr(piece, name) for piece in pieces]
        return np.concatenate([np.zeros((0, *shape), np.float32), *arrays]).astype(np.float32)

    corners = join("corners", (3, 3))
    counts = [len(piece.corners) for piece in pieces]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    faces /= np.maximum(np.linalg.norm(faces, axis=1, keepdims=True), 1e-20)
    material = np.repeat([piece.material for piece in pieces], counts).astype(np.int32)
    uvs = join("uvs", (3, 2))
    passes = np.zeros(len(corners), dtype=np.float32)
    for place, look in enumerate(materials):
        if look.alpha == "blend":
            passes[material == place] = 1.0 - look.base_colour[3]
        elif look.alpha == "mask":
            chosen = material == place
            passes[chosen] = ~is_mostly_there(look, uvs[chosen])
    return StaticGeometry(
        instances=instances,
        materials=materials,
        corners=corners,
        normals=join("normals", (3, 3)),
        uvs=uvs,
        faces=faces.astype(np.float32),
        owner=np.repeat([piece.owner for piece in pieces], counts).astype(np.int32),
        material=material,
        solid=passes == 0.0,
        passes=passes,
    )
