"""Rules for the names that randomisation refers to: they must exist in the scene."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fnmatch import fnmatchcase
from typing import Any

from sailenv_ros.scene.messages import suggestion
from sailenv_ros.scene.room_rules import room_part_names

__all__ = ["drawn_names", "random_targets_exist"]

Entry = Mapping[str, Any]


def random_targets_exist(scene: Entry) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Refuse names and patterns that mean nothing in the scene."""
    room = scene.get("room")
    objects = _names(scene, "objects")
    surfaces = list(room_part_names(room)) if isinstance(room, Mapping) else []
    known = {
        "object": objects,
        "material": [*objects, *surfaces],
        "light": _names(scene, "lights"),
    }
    listed = scene.get("randomise")
    for index, entry in enumerate(listed if isinstance(listed, list | tuple) else ()):
        kind = entry.get("type") if isinstance(entry, Mapping) else None
        names = known.get(kind) if isinstance(kind, str) else None
        if names is None:
            continue
        given = entry.get("of")
        patterns = [given] if isinstance(given, str) else given
        for pattern in patterns if isinstance(patterns, list | tuple) else ():
            if not isinstance(pattern, str) or any(
                name == pattern or fnmatchcase(name, pattern) for name in names
            ):
                continue
            what = "object or part of the room" if kind == "material" else kind
            near = suggestion(pattern, names, listing="there are")
            yield ("randomise", index, "of"), f"the scene has no {what} {pattern!r}; {near}"


def drawn_names(value: object) -> list[str]:
    """Return the texts that a value or a distribution may give."""
    if isinstance(value, str):
        return [value]
    given = value.get("choice") if isinstance(value, Mapping) else None
    if isinstance(given, Mapping):
        given = given.get("of")
    return [one for one in given if isinstance(one, str)] if isinstance(given, list) else []


def _names(scene: Entry, key: str) -> list[str]:
    listed = scene.get(key)
    entries = listed if isinstance(listed, list | tuple) else ()
    named = [entry.get("name") for entry in entries if isinstance(entry, Mapping)]
    return [name for name in named if isinstance(name, str)]
