"""Entries of objects that come to a scene beside those of its file."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from sailenv_ros.scene.entries import checked_object, checked_objects, free_name
from sailenv_ros.scene.loader import SceneKnowledge
from sailenv_ros.scene.spec import ObjectSpec

__all__ = ["checked_alone", "named_entries"]


def named_entries(
    entries: Iterable[Mapping[str, Any]],
    taken: Iterable[str],
    canonical_asset: Callable[[str], str],
) -> list[Mapping[str, Any]]:
    """Return entries with a name for each of those that have none.

    Parameters
    ----------
    entries : iterable of mapping
        As requests give them; what is no mapping stays as it is.
    taken : iterable of str
        Names that are in use.
    canonical_asset : callable
        Returns the name of an asset that names begin with.
    """
    names = set(taken)
    named: list[Mapping[str, Any]] = []
    for entry in entries:
        if isinstance(entry, Mapping) and entry.get("name") is None:
            asset = canonical_asset(str(entry.get("asset")))
            entry = {**entry, "name": free_name(asset, names)}
        if isinstance(entry, Mapping):
            names.add(str(entry["name"]))
        named.append(entry)
    return named


def checked_alone(entry: Mapping[str, Any], known: SceneKnowledge) -> ObjectSpec:
    """Check an object beside which there are others: what its joint is on, the world knows."""
    joint = entry.get("joint") if isinstance(entry, Mapping) else None
    parent = joint.get("parent") if isinstance(joint, Mapping) else None
    if not isinstance(parent, str) or parent == entry.get("name"):
        return checked_object(entry, known)
    stands_in = {"name": parent, "asset": entry.get("asset"), "static": True}
    return checked_objects([entry, stands_in], known)[0]
