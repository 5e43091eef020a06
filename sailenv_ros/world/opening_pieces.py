"""Opening parts of a piece of furniture → objects on joints, each as a scene file has it.

The entry of a piece and its asset in, further entries out. A piece that stands still carries its
doors and drawers on joints; one that moves freely, or comes and goes, keeps them shut.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Any

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.scene.spec import JointSpec, ObjectSpec
from sailenv_ros.scene.spec_materials import ALL_PARTS
from sailenv_ros.types.model import Asset, MovingPart

__all__ = ["as_placed", "moving_entries", "moving_name", "opens"]

MAX_NAME = 63
"""Most characters of an object's name."""

_LOOKS = ("scale", "colour", "metallic", "roughness")


def moving_name(piece: str, part: str) -> str:
    """Return the name of the object that is a door or drawer of a piece."""
    return f"{piece} {part}"


def opens(entry: ObjectSpec, asset: Asset, visitors: Collection[str] = ()) -> bool:
    """Return whether what opens of a piece is on joints, and not a part of its body.

    Parameters
    ----------
    entry : ObjectSpec
    asset : Asset
    visitors : collection of str
        Names of objects that lessons let come and go.
    """
    stays = entry.static or entry.joint is not None
    comes = bool(entry.appear) or entry.leave is not None or entry.name in visitors
    return bool(asset.moving) and stays and not comes


def as_placed(entry: ObjectSpec, asset: Asset, visitors: Collection[str] = ()) -> Asset:
    """Return what the body of an entry is made of: a piece without what opens of it."""
    if not opens(entry, asset, visitors):
        return asset
    assert asset.still is not None
    return asset.still


def moving_entries(
    entries: Sequence[ObjectSpec], assets: Mapping[str, Asset], visitors: Collection[str] = ()
) -> Iterator[ObjectSpec]:
    """Yield the entries of all that opens and has none in the scene yet.

    Parameters
    ----------
    entries : sequence of ObjectSpec
    assets : mapping of str to Asset
        By the objects' names.
    visitors : collection of str
        As of `opens`.

    Raises
    ------
    InvalidRequest
        If the name of a part would be too long.
    """
    described = {(entry.joint.parent, entry.asset) for entry in entries if entry.joint is not None}
    for entry in entries:
        asset = assets[entry.name]
        if opens(entry, asset, visitors):
            for part in asset.moving:
                if (entry.name, part.asset.name) not in described:
                    yield _entry(entry, part)


def _entry(piece: ObjectSpec, part: MovingPart) -> ObjectSpec:
    name = moving_name(piece.name, part.name)
    if len(name) > MAX_NAME:
        raise InvalidRequest(
            f"name of {part.name!r} of {piece.name!r}", name, f"at most {MAX_NAME} characters"
        )
    (x, y, z), (sx, sy, sz) = part.origin_m, piece.scale
    factor, (low, high) = _lengthened(part, piece.scale), part.limits
    joint = JointSpec(
        type=part.type,
        parent=piece.name,
        axis=part.axis,
        origin=(x * sx, y * sy, z * sz),
        limits=(low * factor, high * factor),
        friction=part.friction,
        damping=part.damping,
        effort=part.effort,
        **_laws(part, factor),
    )
    fields: dict[str, Any] = {
        key: getattr(piece, key) for key in _LOOKS if key in piece.model_fields_set
    }
    own = {drawn.material.name for drawn in part.asset.model.parts}
    materials = tuple(one for one in piece.materials if one.part == ALL_PARTS or one.part in own)
    if materials:
        fields["materials"] = materials
    return ObjectSpec(name=name, asset=part.asset.name, joint=joint, **fields)


def _lengthened(part: MovingPart, scale: Sequence[float]) -> float:
    """Return by what factor its way is longer at a scale: what slides goes farther."""
    if part.type == "hinge":
        return 1.0
    return sum(abs(a) * s for a, s in zip(part.axis, scale, strict=True))


def _laws(part: MovingPart, factor: float) -> dict[str, Any]:
    """Return what else its joint has, as an entry has it."""
    found: dict[str, Any] = {}
    if part.soft_close is not None:
        found["soft_close"] = asdict(part.soft_close.scaled(factor))
    if part.detents is not None:
        clicks = asdict(part.detents.scaled(factor)).items()
        found["detents"] = {key: value for key, value in clicks if value not in (None, ())}
    return found
