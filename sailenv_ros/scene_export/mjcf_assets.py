"""Meshes, materials and textures of an MJCF file, each once."""

from __future__ import annotations

from collections.abc import Iterator
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.scene_export.contents import Vector3
from sailenv_ros.scene_export.losses import counted
from sailenv_ros.scene_export.names import FreeNames
from sailenv_ros.scene_export.textures import FilesBeside, halved
from sailenv_ros.scene_export.xml_text import numbers
from sailenv_ros.types.colour import srgb_from_linear
from sailenv_ros.types.model import Material, ModelPart, Texture

__all__ = ["MjcfAssets"]

LONGEST_SIDE_PX = 512
"""MuJoCo reads PNG alone, which is large; longer pictures are halved until they are as long."""


class MjcfAssets(FilesBeside):
    """The element `asset` of a file and the files that it names.

    Parameters
    ----------
    node : Element
        That element.
    """

    def __init__(self, node: Element) -> None:
        super().__init__(png=True)
        self._node = node
        self._names = FreeNames()
        self._scaled: dict[tuple[int, Vector3], str] = {}
        self._materials: dict[int, str] = {}
        self._smaller: dict[int, Texture] = {}
        self._texture_names: set[str] = set()
        self._maps = 0

    def losses(self) -> Iterator[str]:
        """Yield what materials have lost."""
        if self._smaller:
            yield f"textures in MJCF are at most {LONGEST_SIDE_PX} pixels long"
        if self._maps:
            yield f"{counted(self._maps, 'material')} lost maps of roughness or relief in MJCF"

    def mesh(self, part: ModelPart, wanted: str, scale: Vector3) -> str:
        """Return the name of a mesh at a scale."""
        key = id(part.mesh), scale
        if key not in self._scaled:
            textured = part.material.base_colour_texture is not None
            file = self._meshes.of(part.mesh, wanted, textured=textured)
            name = self._names.take(file.removesuffix(".obj"))
            # Shells need no volume; bodies have the moments that they have here.
            entry = {"name": name, "file": file, "inertia": "shell"}
            if scale != (1.0, 1.0, 1.0):
                entry["scale"] = numbers(scale)
            SubElement(self._node, "mesh", entry)
            self._scaled[key] = name
        return self._scaled[key]

    def hull(self, corners: NDArray[np.float64], wanted: str) -> str:
        """Return the name of the convex hull of points."""
        name = self._names.take(wanted)
        SubElement(self._node, "mesh", {"name": name, "vertex": numbers(corners.reshape(-1))})
        return name

    def material(self, material: Material) -> str:
        """Return the name of a material."""
        if id(material) not in self._materials:
            name = self._names.take(material.name or "material")
            red, green, blue = srgb_from_linear(material.base_colour[:3]).tolist()
            entry = {
                "name": name,
                "rgba": numbers((red, green, blue, material.base_colour[3])),
                "shininess": numbers((min(max((0.9 - material.roughness) / 0.7, 0.0), 1.0),)),
                "specular": "0.3",
                "metallic": numbers((material.metallic,)),
                "roughness": numbers((material.roughness,)),
            }
            if any(material.emission):
                entry["emission"] = numbers((min(max(material.emission), 1.0),))
            if material.base_colour_texture is not None:
                entry["texture"] = self._texture(material)
            maps = (material.normal_texture, material.metallic_roughness_texture)
            self._maps += any(texture is not None for texture in maps)
            SubElement(self._node, "material", entry)
            self._materials[id(material)] = name
        return self._materials[id(material)]

    def _texture(self, material: Material) -> str:
        texture = material.base_colour_texture
        assert texture is not None
        smaller = self._smaller.get(id(texture))
        if smaller is None and max(texture.shape[:2]) > LONGEST_SIDE_PX:
            smaller = self._smaller.setdefault(id(texture), _fitted(texture))
        seen = material.alpha != "opaque"
        picture = self._textures.of(texture if smaller is None else smaller, alpha=seen)
        if picture.name not in self._texture_names:
            self._texture_names.add(picture.name)
            entry = {"type": "2d", "name": picture.name, "file": picture.name}
            SubElement(self._node, "texture", entry)
        return picture.name


def _fitted(texture: Texture) -> Texture:
    """Return a texture halved until no side is longer than is wanted."""
    while max(texture.shape[:2]) > LONGEST_SIDE_PX:
        texture = halved(texture)
    return texture
