"""Whether an asset can be placed as an object's entry in a scene file says.

Plain data in, places and sentences out, so that a scene's errors are found before it is built.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, TypeAlias

from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.scene.messages import suggestion
from sailenv_ros.scene.spec_materials import ALL_PARTS
from sailenv_ros.types.model import Asset, CylinderShape, SphereShape, TriangleShape
from sailenv_ros.types.validation import is_finite_number

__all__ = ["ObjectFit"]

Diagnostics: TypeAlias = Iterator[tuple[tuple[str | int, ...], str]]


class ObjectFit:
    """Checks entries of objects against the assets of a library.

    Parameters
    ----------
    library : AssetLibrary
    """

    def __init__(self, library: AssetLibrary) -> None:
        self._library = library
        self._known = library.all_names

    def __call__(self, entry: Mapping[str, Any]) -> Diagnostics:
        """Yield what does not fit; keep silent about an asset that is unknown.

        Raises
        ------
        AssetError
            If the asset cannot be loaded.
        """
        name = entry.get("asset")
        if not isinstance(name, str) or name not in self._known:
            return
        asset = self._library.get(name)
        yield from _scale_errors(asset, entry.get("scale"))
        yield from _part_errors(asset, entry.get("materials"))
        if not entry.get("static", False) and _is_hollow(asset):
            yield (
                ("asset",),
                f"{name!r} collides as hollow geometry, which cannot move; add static: true",
            )


def _scale_errors(asset: Asset, scale: object) -> Diagnostics:
    if (
        not isinstance(scale, list | tuple)
        or len(scale) != 3
        or not all(map(is_finite_number, scale))
    ):
        return
    for shape in asset.collision:
        if isinstance(shape, SphereShape) and not _equal(scale):
            yield (("scale",), f"must be equal in x, y and z: {asset.name} collides as a ball")
            return
        if isinstance(shape, CylinderShape) and not _equal(scale[:2]):
            yield (("scale",), f"must be equal in x and y: {asset.name} collides as a cylinder")
            return


def _part_errors(asset: Asset, materials: object) -> Diagnostics:
    """Yield the materials that the asset does not have, or that cannot be exchanged."""
    if not isinstance(materials, list | tuple):
        return
    own: dict[str, bool] = {}
    for drawn in asset.model.parts:
        opaque = drawn.material.alpha == "opaque"
        own[drawn.material.name] = own.get(drawn.material.name, True) and opaque
    for index, entry in enumerate(materials):
        part = entry.get("part") if isinstance(entry, Mapping) else None
        if not isinstance(part, str) or part == ALL_PARTS:
            continue
        place = ("materials", index, "part")
        if part not in own:
            known = suggestion(part, [ALL_PARTS, *own], listing="its materials")
            yield place, f"{asset.name} has no material {part!r}; {known}"
        elif not own[part] and (entry.get("material") or entry.get("picture")):
            yield (
                place,
                f"{part!r} is cut out or transparent: it takes colours and finishes, but no other "
                "material and no picture",
            )


def _is_hollow(asset: Asset) -> bool:
    return any(isinstance(shape, TriangleShape) for shape in asset.collision)


def _equal(values: Any) -> bool:
    return bool(max(values) - min(values) <= 1e-9 * abs(max(values)))
