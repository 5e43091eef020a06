"""Materials (UsdPreviewSurface) and lights (UsdLux) of USD → those of glTF."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from sailenv_content.scene_import.usd_tree import GltfTree
from sailenv_ros.types.lights import LUMENS_PER_WATT

__all__ = ["Looks"]

MOST_PICTURE_BYTES = 64_000_000

_KINDS = {b"\x89PNG": "image/png", b"\xff\xd8\xff": "image/jpeg"}


class Looks:
    """The materials of one file.

    Parameters
    ----------
    path : Path
        Of the USD file: pictures lie beside it or in it.
    tree : GltfTree

    Attributes
    ----------
    notes : list of str
        What was left out.
    """

    def __init__(self, path: Path, tree: GltfTree) -> None:
        self._path, self._tree = path, tree
        self._materials: dict[str, int] = {}
        self._pictures: dict[str, int | None] = {}
        self.notes: list[str] = []

    def of(self, material: Any, mesh: Any) -> int:
        """Return the number of a material; without one it has the mesh's own colour."""
        key = str(material.GetPath()) if material is not None else f"colour of {mesh.GetPath()}"
        double = bool(mesh.GetAttribute("doubleSided").Get())
        key += " from both sides" if double else ""
        if key not in self._materials:
            entry = self._plain(mesh) if material is None else self._entry(material)
            if double:
                entry["doubleSided"] = True
            self._materials[key] = self._tree.append("materials", entry)
        return self._materials[key]

    def light(self, prim: Any, lux: Any) -> dict[str, Any] | None:
        """Return a light of KHR_lights_punctual, whose extent it loses; None for other lights.

        A nit is one W/(m² sr) here, as exports have it.
        """
        api = lux.LightAPI(prim)
        colour = [float(v) for v in api.GetColorAttr().Get() or (1.0, 1.0, 1.0)]
        strength = float(api.GetIntensityAttr().Get() or 0.0)
        strength *= 2.0 ** float(api.GetExposureAttr().Get() or 0.0)
        kind, area = "point", 1.0
        if prim.IsA(lux.DistantLight):
            kind = "directional"
        elif prim.IsA(lux.SphereLight):
            area = math.pi * float(lux.SphereLight(prim).GetRadiusAttr().Get()) ** 2
        elif prim.IsA(lux.RectLight):
            rectangle = lux.RectLight(prim)
            kind = "spot"
            area = float(rectangle.GetWidthAttr().Get()) * float(rectangle.GetHeightAttr().Get())
        elif prim.IsA(lux.DiskLight):
            kind = "spot"
            area = math.pi * float(lux.DiskLight(prim).GetRadiusAttr().Get()) ** 2
        else:
            self.notes.append(f"the light {prim.GetName()!r} was left out")
            return None
        entry: dict[str, Any] = {"type": kind, "color": colour}
        entry["intensity"] = strength * area * LUMENS_PER_WATT
        angle = lux.ShapingAPI(prim).GetShapingConeAngleAttr().Get()
        if kind == "point" and angle is not None and float(angle) < 90.0:
            entry["type"] = kind = "spot"
        if kind == "spot":
            outer = math.radians(min(float(angle if angle is not None else 90.0), 90.0))
            soft = float(lux.ShapingAPI(prim).GetShapingConeSoftnessAttr().Get() or 0.0)
            entry["spot"] = {"innerConeAngle": outer * (1.0 - soft), "outerConeAngle": outer}
        return entry

    def _plain(self, mesh: Any) -> dict[str, Any]:
        colours = mesh.GetAttribute("primvars:displayColor").Get()
        colour = [float(v) for v in colours[0]] if colours else [0.8, 0.8, 0.8]
        return {"pbrMetallicRoughness": {"baseColorFactor": [*colour, 1.0], "metallicFactor": 0.0}}

    def _entry(self, material: Any) -> dict[str, Any]:
        surface = material.ComputeSurfaceSource()[0]
        entry: dict[str, Any] = {"name": material.GetPrim().GetName()}
        if not surface or surface.GetIdAttr().Get() != "UsdPreviewSurface":
            self.notes.append(f"the material {entry['name']!r} is no UsdPreviewSurface: it is grey")
            return entry
        colour, picture = self._colour(surface, "diffuseColor", (0.18, 0.18, 0.18))
        opacity = _number(surface, "opacity", 1.0)
        pbr: dict[str, Any] = {
            "baseColorFactor": [*colour, opacity],
            "metallicFactor": _number(surface, "metallic", 0.0),
            "roughnessFactor": _number(surface, "roughness", 0.5),
        }
        if picture is not None:
            pbr["baseColorTexture"] = {"index": picture}
        emission, _ = self._colour(surface, "emissiveColor", (0.0, 0.0, 0.0))
        if any(emission):
            peak = max(1.0, *emission)
            entry["emissiveFactor"] = [value / peak for value in emission]
            strength = {"emissiveStrength": peak}
            entry["extensions"] = {"KHR_materials_emissive_strength": strength}
        threshold = _number(surface, "opacityThreshold", 0.0)
        if threshold > 0.0:
            entry |= {"alphaMode": "MASK", "alphaCutoff": threshold}
        elif opacity < 1.0:
            entry["alphaMode"] = "BLEND"
        return {**entry, "pbrMetallicRoughness": pbr}

    def _colour(
        self, surface: Any, name: str, default: tuple[float, float, float]
    ) -> tuple[list[float], int | None]:
        """Return the factor of an input, and the number of its texture."""
        given = surface.GetInput(name)
        if not given:
            return list(default), None
        if not given.HasConnectedSource():
            value = given.Get()
            return [float(v) for v in (default if value is None else value)], None
        reader = given.GetConnectedSources()[0][0].source
        scale = reader.GetInput("scale").Get() if reader.GetInput("scale") else None
        factor = [float(v) for v in scale][:3] if scale is not None else [1.0, 1.0, 1.0]
        file = reader.GetInput("file").Get() if reader.GetInput("file") else None
        return factor, None if file is None else self._texture(str(file.resolvedPath or file.path))

    def _texture(self, named: str) -> int | None:
        if named not in self._pictures:
            self._pictures[named] = self._read(named)
        return self._pictures[named]

    def _read(self, named: str) -> int | None:
        from pxr import Ar

        home = self._path.parent
        file, bracket, within = named.partition("[")
        plain = (home / file).resolve()
        if not plain.is_relative_to(home):
            raise ValueError(f"it names {named[:80]!r}, which is not beside it")
        asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(f"{plain}{bracket}{within}"))
        data = bytes(asset.GetBuffer()) if asset and asset.GetSize() <= MOST_PICTURE_BYTES else b""
        kind = next((kind for magic, kind in _KINDS.items() if data.startswith(magic)), None)
        if kind is None:
            self.notes.append(f"the picture {Path(named).name!r} was left out: no PNG or JPEG")
            return None
        image = {"mimeType": kind, "bufferView": self._tree.bytes_of(data)}
        source = self._tree.append("images", image)
        return self._tree.append("textures", {"source": source})


def _number(surface: Any, name: str, default: float) -> float:
    given = surface.GetInput(name)
    value = given.Get() if given and not given.HasConnectedSource() else None
    return default if value is None else float(value)
