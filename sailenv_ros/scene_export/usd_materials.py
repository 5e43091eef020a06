"""Materials as UsdPreviewSurface, with the pictures that they name.

Pixar, "UsdPreviewSurface Specification" 2.6.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias

from sailenv_ros.scene_export.contents import ExportedPiece
from sailenv_ros.scene_export.lit_picture import metalness, takes_light
from sailenv_ros.scene_export.names import FreeNames
from sailenv_ros.scene_export.textures import Textures, texture_slots
from sailenv_ros.scene_export.usd_text import UsdText, number, quoted, vector
from sailenv_ros.types.model import Material, Texture

__all__ = ["UsdMaterials", "is_lit"]

Maps: TypeAlias = Mapping[str, tuple[Texture, bool]]
"""Textures by their slots, and whether their alpha is seen."""


def is_lit(piece: ExportedPiece, material: Material) -> bool:
    """Return whether a surface of a piece is drawn by baked light."""
    return bool(piece.light_places) and takes_light(material)


class UsdMaterials:
    """The materials of a file.

    Parameters
    ----------
    text : UsdText
    path : str
        Of the scope that holds them.
    folder : str
        Of the pictures, relative to the file.
    light : (H, W, 4) uint8 or None
        What surfaces radiate by baked light, at the coordinates ``st1``.
    white : float
        Radiance where that is white [W/(m² sr)].
    """

    def __init__(
        self, text: UsdText, path: str, folder: str, light: Texture | None, white: float
    ) -> None:
        self._text = text
        self._path = path
        self._folder = folder
        self._light, self._white = light, white
        self._names = FreeNames()
        self._of: dict[tuple[int, bool], str] = {}
        self.textures = Textures()

    def path(self, material: Material, *, lit: bool = False) -> str:
        """Return the path of a material that was written; `lit` is the one by baked light."""
        return self._of[id(material), lit]

    def write(
        self, pieces: Sequence[ExportedPiece], surfaces: Sequence[tuple[float, float]]
    ) -> None:
        """Write the materials of pieces, and one for each friction and restitution of shapes."""
        text = self._text
        with text.prim("Scope", self._path.rpartition("/")[2]):
            for piece in pieces:
                for part in piece.parts:
                    lit = is_lit(piece, part.material)
                    if (id(part.material), lit) not in self._of:
                        self._write(part.material, lit=lit)
            for friction, restitution in surfaces:
                name = _surface_name(friction, restitution)
                with text.prim("Material", name, schemas=["PhysicsMaterialAPI"]):
                    for key in ("dynamicFriction", "staticFriction"):
                        # Here two bodies have the product of theirs, in USD the mean.
                        text.attribute("float", f"physics:{key}", number(friction**2))
                    text.attribute("float", "physics:restitution", number(restitution))

    def physics(self, friction: float, restitution: float) -> str:
        """Return the path of the material of a friction and a restitution."""
        return f"{self._path}/{_surface_name(friction, restitution)}"

    def _write(self, material: Material, *, lit: bool) -> None:
        text = self._text
        name = self._names.take(material.name or "material")
        path = f"{self._path}/{name}"
        self._of[id(material), lit] = path
        maps = {slot: (texture, alpha) for slot, texture, alpha in texture_slots(material)}
        with text.prim("Material", name):
            text.connect("token", "outputs:surface", f"{path}/surface.outputs:surface")
            with text.prim("Shader", "surface"):
                text.attribute("uniform token", "info:id", quoted("UsdPreviewSurface"))
                if lit:
                    self._write_glow(material, path, maps)
                else:
                    self._write_colour(material, path, maps)
                self._write_inputs(material, path, maps)
                text.attribute("token", "outputs:surface")
            if lit:
                assert self._light is not None
                self._write_reader("st1")
                file = self.textures.of(self._light, alpha=False).name
                self._write_picture(path, "light", file, (*[self._white] * 3, 1.0), of="st1")
            if maps:
                self._write_reader("st")
            for slot, (texture, alpha) in maps.items():
                file = self.textures.of(texture, alpha=alpha).name
                if slot == "base_colour":
                    # Blender multiplies alpha by the scale of red: it stays 1 where alpha is all.
                    colour = material.base_colour[:3] if _has_colour(material, lit) else (1.0,) * 3
                    self._write_picture(path, slot, file, (*colour, material.base_colour[3]))
                    if any(material.emission):
                        self._write_picture(path, "emission", file, (*material.emission, 1.0))
                elif slot == "normal":
                    bias = (-1.0, -1.0, -1.0, 0.0)
                    self._write_picture(path, slot, file, (2.0, 2.0, 2.0, 1.0), bias=bias)
                else:
                    scale = (1.0, material.roughness, material.metallic, 1.0)
                    self._write_picture(path, slot, file, scale, bias=(0.0, 0.0, 0.0, 0.0))

    def _write_colour(self, material: Material, path: str, maps: Maps) -> None:
        """Write what of light is sent back, and what is emitted."""
        text = self._text
        textured, colour = "base_colour" in maps, material.base_colour[:3]
        if textured and _has_colour(material, lit=False):
            text.connect("color3f", "inputs:diffuseColor", f"{path}/base_colour.outputs:rgb")
        else:
            text.attribute("color3f", "inputs:diffuseColor", vector(colour))
        if any(material.emission) and textured:
            text.connect("color3f", "inputs:emissiveColor", f"{path}/emission.outputs:rgb")
        elif any(material.emission):
            text.attribute("color3f", "inputs:emissiveColor", vector(material.emission))

    def _write_glow(self, material: Material, path: str, maps: Maps) -> None:
        """Write baked light as emission; other light is mirrored alone."""
        if _has_colour(material, lit=True):
            self._write_colour(material, path, maps)
        else:
            self._text.attribute("color3f", "inputs:diffuseColor", vector((0.0, 0.0, 0.0)))
        self._text.connect("color3f", "inputs:emissiveColor", f"{path}/light.outputs:rgb")

    def _write_inputs(self, material: Material, path: str, maps: Maps) -> None:
        text = self._text
        textured, alpha = "base_colour" in maps, material.base_colour[3]
        if "metallic_roughness" in maps:
            text.connect("float", "inputs:metallic", f"{path}/metallic_roughness.outputs:b")
            text.connect("float", "inputs:roughness", f"{path}/metallic_roughness.outputs:g")
        else:
            text.attribute("float", "inputs:metallic", number(material.metallic))
            text.attribute("float", "inputs:roughness", number(material.roughness))
        if "normal" in maps:
            text.connect("normal3f", "inputs:normal", f"{path}/normal.outputs:rgb")
        if material.alpha != "opaque":
            if textured:
                text.connect("float", "inputs:opacity", f"{path}/base_colour.outputs:a")
            else:
                text.attribute("float", "inputs:opacity", number(alpha))
        if material.alpha == "mask":
            text.attribute("float", "inputs:opacityThreshold", number(material.alpha_cutoff))

    def _write_reader(self, name: str) -> None:
        """Write the reader of texture coordinates."""
        with self._text.prim("Shader", name):
            self._text.attribute("uniform token", "info:id", quoted("UsdPrimvarReader_float2"))
            self._text.attribute("string", "inputs:varname", quoted(name))
            self._text.attribute("float2", "outputs:result")

    def _write_picture(
        self,
        path: str,
        name: str,
        file: str,
        scale: Sequence[float],
        bias: Sequence[float] | None = None,
        of: str = "st",
    ) -> None:
        """Write the reader of a picture; colours are sRGB, what has a bias is not."""
        text = self._text
        with text.prim("Shader", name):
            text.attribute("uniform token", "info:id", quoted("UsdUVTexture"))
            text.attribute("asset", "inputs:file", f"@./{self._folder}/{file}@")
            text.connect("float2", "inputs:st", f"{path}/{of}.outputs:result")
            text.attribute("token", "inputs:wrapS", quoted("repeat"))
            text.attribute("token", "inputs:wrapT", quoted("repeat"))
            space = "sRGB" if bias is None else "raw"
            text.attribute("token", "inputs:sourceColorSpace", quoted(space))
            text.attribute("float4", "inputs:scale", vector(scale))
            if bias is not None and any(bias):
                text.attribute("float4", "inputs:bias", vector(bias))
            text.attribute("float3", "outputs:rgb")
            for channel in "gba":
                text.attribute("float", f"outputs:{channel}")


def _has_colour(material: Material, lit: bool) -> bool:
    """Return whether a surface sends light back: not one by baked light, unless it is metal."""
    return any(material.base_colour[:3]) and (not lit or metalness(material) > 0.5)


def _surface_name(friction: float, restitution: float) -> str:
    return f"friction_{round(1000.0 * friction)}_restitution_{round(1000.0 * restitution)}"
