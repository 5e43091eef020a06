"""Materials by name: those made for rooms, those of the catalogue's models, users' pictures.

What a scene file says of a look in, a `LaidMaterial` out: with the size at which it is true.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.paint import painted_material
from sailenv_ros.assets.pictures import Pictures
from sailenv_ros.assets.surfaces import surface, surface_names
from sailenv_ros.errors import AssetError, UnknownName
from sailenv_ros.scene.messages import suggestion
from sailenv_ros.scene.spec_materials import LookSpec
from sailenv_ros.types.model import Asset, Material, ModelPart

__all__ = ["LaidMaterial", "MaterialLibrary", "appearance_key", "material_names"]

PICTURE_TILE_M = 1.0
"""Side of a picture that says nothing of its size [m]."""

_PLAIN = Material(name="plain")


@dataclass(frozen=True, slots=True)
class LaidMaterial:
    """A material, and how it is laid.

    Attributes
    ----------
    material : Material
    tile_m : (2,) tuple of float or None
        Width and height of what its textures show [m]; None if it keeps the places that the
        surface's own textures have.
    turn_deg : float
        By which it is laid, counter-clockwise [deg].
    """

    material: Material
    tile_m: tuple[float, float] | None = None
    turn_deg: float = 0.0


class MaterialLibrary:
    """The materials that one scene can name: built in, of packs, and of its own pictures.

    Parameters
    ----------
    assets : AssetLibrary
    pictures : Pictures
    folders : sequence of Path
        In which the scene's pictures lie.
    """

    def __init__(
        self,
        assets: AssetLibrary,
        pictures: Pictures | None = None,
        folders: Sequence[Path] = (),
    ) -> None:
        self._assets, self._pictures = assets, pictures or Pictures()
        self._folders = tuple(folders)

    def finish(self, look: LookSpec, own: Material = _PLAIN) -> LaidMaterial:
        """Return what a look makes of a material.

        Raises
        ------
        UnknownName, InvalidRequest, AssetError
            If there is no such material, or a picture cannot be used.
        """
        made = self._begun(look, own)
        material = made.material
        if look.tint is not None:
            red, green, blue = (
                a * b for a, b in zip(material.base_colour[:3], look.tint, strict=True)
            )
            material = replace(material, base_colour=(red, green, blue, material.base_colour[3]))
        material = painted_material(material, None, look.metallic, look.roughness)
        if look.emission is not None:
            # What has a light of its own no longer follows a lamp's.
            material = replace(material, emission=look.emission, glow=(0.0, 0.0, 0.0))
        tile = made.tile_m if made.tile_m is None or look.tile is None else look.tile
        return LaidMaterial(material, tile, made.turn_deg + look.turn)

    def fault(self, name: str) -> str:
        """Return why no model's material has this name, empty if one has."""
        try:
            self._of_model(name)
        except UnknownName as problem:
            return f"there is no {problem.kind} {problem.name!r}; {_near(problem)}"
        except AssetError as problem:
            return str(problem)
        return ""

    def picture_fault(self, name: str) -> str:
        """Return why a picture cannot be used, empty if it can."""
        return self._pictures.fault(name, self._folders)

    def _begun(self, look: LookSpec, own: Material) -> LaidMaterial:
        if look.picture is not None:
            texture = self._pictures.texture(look.picture, self._folders)
            red, green, blue = look.colour or (1.0, 1.0, 1.0)
            shown = replace(
                own,
                name=look.picture,
                base_colour=(red, green, blue, own.base_colour[3]),
                base_colour_texture=texture,
                metallic_roughness_texture=None,
                normal_texture=None,
            )
            return LaidMaterial(shown, (PICTURE_TILE_M, PICTURE_TILE_M))
        if look.material is None:
            return LaidMaterial(painted_material(own, look.colour, None, None))
        if look.material in surface_names():
            made = surface(look.material, colour=look.colour, seed=look.seed)
            return LaidMaterial(made.material, made.tile_m, made.turn_deg)
        part = self._of_model(look.material)
        return LaidMaterial(painted_material(part.material, look.colour, None, None), _size_m(part))

    def _of_model(self, name: str) -> ModelPart:
        """Return the part of a model that has a material of the name ``asset/material``."""
        asset_name, slash, material = name.partition("/")
        if not slash:
            raise UnknownName("material", name, surface_names())
        asset = self._assets.get(asset_name)
        for part in asset.model.parts:
            if part.material.name == material and part.material.alpha == "opaque":
                return part
        known = [one for one in material_names(asset)]
        raise UnknownName(f"material of {asset_name}", material, known)


def material_names(asset: Asset) -> tuple[str, ...]:
    """Return the names of a model's materials, each once, in their order."""
    return tuple(dict.fromkeys(part.material.name for part in asset.model.parts))


def _size_m(part: ModelPart) -> tuple[float, float]:
    """Return the size of a square of a part's textures, by the areas of its triangles [m]."""
    corners = part.mesh.positions.astype(np.float64)[part.mesh.triangles]
    places = part.mesh.uvs.astype(np.float64)[part.mesh.triangles]
    sides, flat = corners[:, 1:] - corners[:, :1], places[:, 1:] - places[:, :1]
    area = float(np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum())
    laid = np.abs(flat[:, 0, 0] * flat[:, 1, 1] - flat[:, 0, 1] * flat[:, 1, 0]).sum()
    side = float(np.sqrt(area / laid)) if laid > 1e-9 else PICTURE_TILE_M
    side = min(max(side, 0.01), 100.0)
    return side, side


def _near(problem: UnknownName) -> str:
    return suggestion(problem.name, problem.known)


def appearance_key(material: Material) -> tuple[object, ...]:
    """Return what tells materials apart in caches, while their textures live."""
    textures = (
        material.base_colour_texture,
        material.metallic_roughness_texture,
        material.normal_texture,
    )
    numbers = (
        *(material.base_colour, material.metallic, material.roughness),
        *(material.emission, material.glow),
    )
    return (material.name, *numbers, *(id(texture) for texture in textures))
