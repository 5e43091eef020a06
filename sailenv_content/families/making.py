"""A family, a style and a seed → the piece: drawn, put together, checked, drawn again if unfit."""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from sailenv_content.families.builder import Component, PieceBuilder, Unfit
from sailenv_content.families.family import Family
from sailenv_content.families.hardware import Joint
from sailenv_content.families.names import PieceName
from sailenv_content.families.parameters import Values, drawn
from sailenv_ros.assets.solids import joined
from sailenv_ros.errors import AssetError
from sailenv_ros.types.labels import PART_MARK
from sailenv_ros.types.model import Asset, AssetPart, Material, Mesh, Model, ModelPart, MovingPart

__all__ = ["MAX_DRAWS", "Piece", "drawn_values", "make_piece"]

MAX_DRAWS = 16
"""Draws of one seed before the family is given up."""

LEAST_MASS_KG = 0.005


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Piece:
    """A piece that passed its checks.

    Attributes
    ----------
    asset : Asset
    values : Values
        What was drawn.
    draws : int
        How many it took: 1 if the first was sound.
    rejected : tuple of str
        Why the others were not.
    """

    asset: Asset
    values: Values
    draws: int
    rejected: tuple[str, ...]


def drawn_values(family: Family, name: PieceName, attempt: int = 0) -> Values:
    """Return the parameters of a piece by one of its draws; makes nothing.

    Raises
    ------
    AssetError
        If a parameter is impossible.
    """
    owner = f"{family.name}~{name.style}"
    rng = np.random.default_rng(_key(owner, name.seed, attempt))
    return drawn(owner, family.styles[name.style].parameters, rng)


def _key(owner: str, seed: int, attempt: int) -> list[int]:
    return [zlib.crc32(owner.encode()), seed, attempt]


def make_piece(family: Family, name: PieceName) -> Piece:
    """Make a piece; the same bytes for the same name.

    Raises
    ------
    AssetError
        If a parameter is impossible, or no draw is sound.
    """
    style = family.styles[name.style]
    owner = f"{family.name}~{name.style}"
    rejected: list[str] = []
    for attempt in range(MAX_DRAWS):
        values = drawn_values(family, name, attempt)
        key = [*_key(owner, name.seed, attempt), 1]
        builder = PieceBuilder(np.random.default_rng(key))
        try:
            style.make(builder, values)
            builder.set_down()
            asset = _asset(family, name, builder)
            _check(family, asset)
        except Unfit as problem:
            rejected.append(str(problem))
            continue
        return Piece(asset=asset, values=values, draws=attempt + 1, rejected=tuple(rejected))
    raise AssetError(
        name.whole, f"none of {MAX_DRAWS} draws makes a sound piece; the last: {rejected[-1]}"
    )


def _check(family: Family, asset: Asset) -> None:
    low, high = asset.model.bounds()
    size = high - low
    for axis, side, least, most in zip("xyz", size, family.least_m, family.most_m, strict=True):
        if not least <= side <= most:
            raise Unfit(f"{side:.3f} m along {axis}, and {least} to {most} m are accepted")
    for part in asset.moving:
        if not part.limits[0] < part.limits[1]:
            raise Unfit(f"the {part.name} cannot move")


def _asset(family: Family, name: PieceName, builder: PieceBuilder) -> Asset:
    components = [component for component in builder.components if component.meshes]
    category = family.styles[name.style].category or family.category
    movers = [component for component in components if component.joint is not None]
    groups = [[one for one in components if _belongs(one, mover)] for mover in movers]
    for group in groups:
        _weigh(group)
    title = _title(name)
    whole = _compound(category, name.whole, title, components, builder)
    if not movers:
        return whole[0]
    still = [one for one in components if not any(_belongs(one, mover) for mover in movers)]
    models = whole[1]
    body, _ = _compound(category, name.whole, title, still, builder, models)
    moving = tuple(
        _moving(mover, name, group, builder, models)
        for mover, group in zip(movers, groups, strict=True)
    )
    asset = whole[0]
    return Asset(
        name=asset.name,
        display_name=asset.display_name,
        category=asset.category,
        model=asset.model,
        collision=asset.collision,
        mass_kg=asset.mass_kg,
        centre_of_mass_m=asset.centre_of_mass_m,
        tags=asset.tags,
        keypoints=asset.keypoints,
        parts=asset.parts,
        moving=moving,
        still=body,
    )


def _belongs(component: Component, mover: Component) -> bool:
    return component.name == mover.name or component.name.startswith(mover.name + PART_MARK)


def _weigh(group: list[Component]) -> None:
    """Make what moves as heavy as physics needs; the whole is the sum of its bodies."""
    share = LEAST_MASS_KG / max(sum(component.mass_kg for component in group), 1e-9)
    for component in group if share > 1.0 else ():
        component.mass_kg *= share
        component.moment = component.moment * share


Drawn = dict[str, list[ModelPart]]
"""Meshes of each component, by its name."""


def _moving(
    component: Component,
    name: PieceName,
    components: list[Component],
    builder: PieceBuilder,
    models: Drawn,
) -> MovingPart:
    assert component.joint is not None
    joint: Joint = component.joint
    title = f"{_title(name)}, {component.name}"
    root = len(component.name) + 1
    asset, _ = _compound(
        component.category,
        name.of_part(component.name),
        title,
        components,
        builder,
        models,
        root=root,
    )
    return MovingPart(
        name=component.name,
        asset=asset,
        type=joint.type,
        axis=joint.axis,
        origin_m=joint.origin_m,
        limits=joint.limits,
        friction=joint.friction,
        effort=joint.effort,
        damping=joint.damping,
        soft_close=joint.soft_close,
        detents=joint.detents,
    )


def _compound(
    category: str,
    name: str,
    title: str,
    components: list[Component],
    builder: PieceBuilder,
    models: Drawn | None = None,
    *,
    root: int = 0,
) -> tuple[Asset, Drawn]:
    """Return one body of some components, the first of which is its own, the others its parts."""
    models = (
        {component.name: _drawn(component) for component in components}
        if models is None
        else models
    )
    own = components[0].name
    meshes: list[ModelPart] = []
    parts: list[AssetPart] = []
    for component in components:
        first = len(meshes)
        meshes += models[component.name]
        if component.name != own:
            places = tuple(range(first, len(meshes)))
            parts.append(
                AssetPart(name=component.name[root:], category=component.category, meshes=places)
            )
    mass = max(sum(component.mass_kg for component in components), LEAST_MASS_KG)
    x, y, z = (sum((component.moment for component in components), np.zeros(3)) / mass).tolist()
    asset = Asset(
        name=name,
        display_name=title,
        category=category,
        model=Model(name=name, parts=tuple(meshes)),
        collision=tuple(shape for component in components for shape in component.shapes),
        mass_kg=mass,
        centre_of_mass_m=(x, y, z),
        tags=("from a seed",),
        keypoints=() if root else tuple(builder.keypoints.items()),
        parts=tuple(parts),
        opens=bool(root),
    )
    return asset, models


def _drawn(component: Component) -> list[ModelPart]:
    """Return the meshes of a component, one for each material."""
    by_material: dict[int, tuple[Material, list[Mesh]]] = {}
    for material, mesh in component.meshes:
        by_material.setdefault(id(material.surface), (material.surface, []))[1].append(mesh)
    return [ModelPart(mesh=joined(all_), material=one) for one, all_ in by_material.values()]


@lru_cache(maxsize=1024)
def _title(name: PieceName) -> str:
    words = name.family.replace("_", " ")
    return f"{words.capitalize()}, {name.style.replace('_', ' ')} {name.seed}"
