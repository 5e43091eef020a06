"""Rules for the names that randomisation refers to: they must exist in the scene."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from sailenv_ros.scene.messages import suggestion
from sailenv_ros.scene.randomise.selectors import OfCategory, is_meant, selectors_in
from sailenv_ros.scene.room_rules import room_part_names
from sailenv_ros.scene.spec_outside import OUTSIDE

__all__ = [
    "box_in_order",
    "drawn_names",
    "random_categories_exist",
    "random_targets_exist",
    "selectable",
]

_PARTS = ("wall", "floor", "ceiling", "skirting", "window", "door", "curtain")

Entry = Mapping[str, Any]


def random_targets_exist(scene: Entry) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Refuse names and patterns that mean nothing in the scene."""
    for index, entry in _listed(scene):
        names = selectable(scene, entry.get("type"))
        if names is None:
            continue
        for pattern in selectors_in(entry.get("of")):
            if isinstance(pattern, OfCategory) or any(is_meant(pattern, name) for name in names):
                continue
            what = {"material": "object or part of the room", "light": "light"}.get(
                entry["type"], "object"
            )
            near = suggestion(pattern, names, listing="there are")
            yield ("randomise", index, "of"), f"the scene has no {what} {pattern!r}; {near}"


def random_categories_exist(
    scene: Entry, category_of: Callable[[str], str]
) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Refuse categories of which the scene has nothing; `category_of` is told an asset's name."""
    for index, entry in _listed(scene):
        categories = [one for one in selectors_in(entry.get("of")) if isinstance(one, OfCategory)]
        names = selectable(scene, entry.get("type"), category_of) if categories else None
        there = set(names.values()) - {""} if names is not None else set()
        for one in categories if names is not None else ():
            if one.category not in there:
                near = suggestion(one.category, sorted(there), listing="there are")
                told = f"the scene has nothing of the category {one.category!r}; {near}"
                yield ("randomise", index, "of"), told


def selectable(
    scene: Entry, kind: object, category_of: Callable[[str], str] = lambda asset: ""
) -> dict[str, str] | None:
    """Return what an entry of that type may be about: names with their categories.

    Parameters
    ----------
    scene : mapping
        Plain data of a scene, of which nothing is certain.
    kind : object
        The entry's `type`; None is returned for one that chooses nothing, or cameras.
    category_of : callable
        Returns the category of an asset; an empty text leaves it unknown.
    """
    if kind == "light":
        return dict.fromkeys(_names(scene, "lights"), "")
    if kind not in ("object", "material", "behaviour"):
        return None
    found: dict[str, str] = {}
    listed = scene.get("objects")
    for entry in listed if isinstance(listed, list | tuple) else ():
        name = entry.get("name") if isinstance(entry, Mapping) else None
        if isinstance(name, str):
            own, asset = entry.get("category"), entry.get("asset")
            known = own if isinstance(own, str) else ""
            found[name] = known or (category_of(asset) if isinstance(asset, str) else "")
    room = scene.get("room")
    if kind == "material" and isinstance(room, Mapping):
        parts = (name for name in room_part_names(room) if name != OUTSIDE)
        found |= {name: _part_category(name) for name in parts}
    return found


def box_in_order(entry: Entry) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Refuse a box whose highest corner is below its lowest."""
    within = entry.get("within")
    if not isinstance(within, list | tuple) or len(within) != 2:
        return
    low, high = within
    try:
        wrong = any(a > b for a, b in zip(low, high, strict=True))
    except (TypeError, ValueError):
        return
    if wrong:
        yield ("within",), "must be the lowest corner, then the highest"


def drawn_names(value: object) -> list[str]:
    """Return the texts that a value or a distribution may give."""
    if isinstance(value, str):
        return [value]
    given = value.get("choice") if isinstance(value, Mapping) else None
    if isinstance(given, Mapping):
        given = given.get("of")
    return [one for one in given if isinstance(one, str)] if isinstance(given, list) else []


def _listed(scene: Entry) -> Iterator[tuple[int, Entry]]:
    listed = scene.get("randomise")
    for index, entry in enumerate(listed if isinstance(listed, list | tuple) else ()):
        if isinstance(entry, Mapping):
            yield index, entry


def _part_category(name: str) -> str:
    """Return the category of a part of a room whose name tells it; others are not known."""
    words = name.replace("curtains", "curtain").split()
    return next((word for word in words if word in _PARTS), "")


def _names(scene: Entry, key: str) -> list[str]:
    listed = scene.get(key)
    entries = listed if isinstance(listed, list | tuple) else ()
    named = [entry.get("name") for entry in entries if isinstance(entry, Mapping)]
    return [name for name in named if isinstance(name, str)]
