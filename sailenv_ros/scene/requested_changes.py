"""Requested changes of a running scene, by the keys of scene files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

from numpy.typing import ArrayLike
from typing_extensions import TypedDict

__all__ = ["EnvironmentChanges", "MaterialChanges", "ObjectChanges"]


class ObjectChanges(TypedDict, total=False):
    """Keys of an object that can be changed; None takes the asset's own. It is moved otherwise."""

    name: str
    category: str | None
    scale: ArrayLike
    static: bool
    mass: float | None
    gravity: bool
    friction: float
    restitution: float
    colour: ArrayLike | str | None
    metallic: float | None
    roughness: float | None
    materials: Sequence[Mapping[str, Any]] | None


class EnvironmentChanges(TypedDict, total=False):
    """Keys of the environment."""

    ambient: ArrayLike | str
    background: Literal["sky", "colour"]
    background_colour: ArrayLike | str
    sky_zenith: ArrayLike | str
    sky_horizon: ArrayLike | str
    sky_ground: ArrayLike | str
    sky_share: float
    sky_map: str
    sky_rotation: float
    sky_blend: bool
    outside_factor: float
    exposure: float
    meter_exposure: bool


class MaterialChanges(TypedDict, total=False):
    """Keys of a material, but for the part that it is of; None takes the asset's own."""

    material: str | None
    picture: str | None
    colour: ArrayLike | str | None
    tint: ArrayLike | str | None
    roughness: float | None
    metallic: float | None
    emission: ArrayLike | str | None
    tile: ArrayLike | None
    turn: float | None
    seed: int | None
    mapping: Literal["box", "own"] | None
