"""Equal meshes, materials and textures → the same objects, so that each is written once."""

from __future__ import annotations

import dataclasses
import hashlib
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.scene_export.textures import SLOTS
from sailenv_ros.types.model import Material, Mesh, ModelPart, Texture

__all__ = ["Sharing"]

T = TypeVar("T")


class Sharing:
    """Those of one scene."""

    def __init__(self) -> None:
        self._same: dict[int, Any] = {}
        self._kept: list[Any] = []
        self._by_content: dict[Any, Any] = {}

    def part(self, part: ModelPart) -> ModelPart:
        """Return a part whose mesh, material and textures are the first equal ones."""
        return dataclasses.replace(
            part, mesh=self._mesh(part.mesh), material=self._material(part.material)
        )

    def _mesh(self, mesh: Mesh) -> Mesh:
        if id(mesh) not in self._same:
            arrays = (mesh.positions, mesh.normals, mesh.uvs, mesh.triangles)
            self._put(mesh, mesh, ("mesh", _digest(*arrays)))
        return self._first(mesh)

    def _material(self, material: Material) -> Material:
        if id(material) not in self._same:
            textures: dict[str, Any] = {}
            for slot in SLOTS:
                key = f"{slot}_texture"
                texture = getattr(material, key)
                textures[key] = None if texture is None else self._texture(texture)
            shared = dataclasses.replace(material, **textures)
            values = (
                id(textures[field.name]) if field.name in textures else getattr(shared, field.name)
                for field in dataclasses.fields(shared)
            )
            self._put(material, shared, ("material", *values))
        return self._first(material)

    def _texture(self, texture: Texture) -> Texture:
        if id(texture) not in self._same:
            self._put(texture, texture, ("texture", texture.shape, _digest(texture)))
        return self._first(texture)

    def _put(self, one: object, shared: object, content: object) -> None:
        self._kept.append(one)  # so that no other one gets its id
        self._same[id(one)] = self._by_content.setdefault(content, shared)

    def _first(self, one: T) -> T:
        found: T = self._same[id(one)]
        return found


def _digest(*arrays: NDArray[Any]) -> bytes:
    digest = hashlib.blake2b(digest_size=16)
    for array in arrays:
        digest.update(str(array.shape).encode())
        digest.update(np.ascontiguousarray(array).data)
    return digest.digest()
