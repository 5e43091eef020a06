"""Other materials on a model: a model and what a scene file says of its materials in, a model out.

The triangles stay the same in the same order. Models are compared by identity, so equal materials
on the same model give the same object while it is used.
"""

from __future__ import annotations

import weakref
from collections.abc import Sequence
from dataclasses import replace

from sailenv_ros.assets.box_mapping import box_mapped
from sailenv_ros.assets.material_library import LaidMaterial, MaterialLibrary, appearance_key
from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.scene.spec_materials import ALL_PARTS, MaterialSpec
from sailenv_ros.types.model import Model, ModelPart

__all__ = ["finished"]

Vector3 = tuple[float, float, float]

_made: weakref.WeakKeyDictionary[Model, weakref.WeakValueDictionary[object, Model]] = (
    weakref.WeakKeyDictionary()
)


def finished(
    model: Model, specs: Sequence[MaterialSpec], stock: MaterialLibrary, scale: Vector3
) -> Model:
    """Return a model with other materials.

    Parameters
    ----------
    model : Model
    specs : sequence of MaterialSpec
        Applied one after another.
    stock : MaterialLibrary
    scale : (3,) tuple of float
        That the model is drawn at: pictures keep their size.

    Raises
    ------
    UnknownName, InvalidRequest, AssetError
        If the model has no such material, or one cannot be given.
    """
    if not specs:
        return model
    parts = list(model.parts)
    for spec in specs:
        named = [n for n, part in enumerate(parts) if model.parts[n].material.name == spec.part]
        if spec.part == ALL_PARTS and not named:
            named = list(range(len(parts)))
        if not named:
            names = [part.material.name for part in model.parts]
            raise UnknownName(f"material of {model.name}", spec.part, [ALL_PARTS, *names])
        changed = [_part(parts[n], spec, stock, scale) for n in named]
        if spec.part != ALL_PARTS and any(part is None for part in changed):
            accepted = "left out for what is cut out or transparent: it takes colours and finishes"
            raise InvalidRequest(f"material or picture of {spec.part!r}", spec.part, accepted)
        for n, part in zip(named, changed, strict=True):
            parts[n] = parts[n] if part is None else part
    key = tuple((id(part.mesh), appearance_key(part.material)) for part in parts)
    kept = _made.setdefault(model, weakref.WeakValueDictionary())
    found = kept.get(key)
    if found is None:
        found = kept[key] = Model(name=model.name, parts=tuple(parts))
    return found


def _part(
    part: ModelPart, spec: MaterialSpec, stock: MaterialLibrary, scale: Vector3
) -> ModelPart | None:
    """Return a part with another look; None for one that cannot have it."""
    if part.material.alpha != "opaque" and (spec.material or spec.picture):
        return None
    finish: LaidMaterial = stock.finish(spec, part.material)
    mesh = part.mesh
    if finish.tile_m is not None and spec.mapping == "box":
        mesh = box_mapped(mesh, finish.tile_m, turn_deg=finish.turn_deg, scale=scale)
    return replace(part, mesh=mesh, material=finish.material)
