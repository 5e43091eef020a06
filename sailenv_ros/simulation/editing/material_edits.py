"""Other materials for what stands in a running world: objects, walls, floor, ceiling.

What was asked for is written down in the words of a scene file, so that it is saved and can be
undone. Shapes, places and ids stay; baked light stays too, and is updated elsewhere.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.scene.entries import checked_scene, plain_value
from sailenv_ros.scene.room_rules import WALLS, room_part_names
from sailenv_ros.scene.spec import ObjectSpec, RoomSpec
from sailenv_ros.scene.spec_materials import ALL_PARTS, LookSpec, MaterialSpec
from sailenv_ros.simulation.live_scene import LiveScene
from sailenv_ros.world.build import room_placements
from sailenv_ros.world.world import World

__all__ = ["changed_materials", "changed_surface", "merged_look", "set_surface", "surface_keys"]

_EXCLUSIVE = ("material", "picture")
"""Keys that replace one another."""

_WALL = " wall"


def changed_materials(
    entry: ObjectSpec, part: str, changes: Mapping[str, Any]
) -> list[dict[str, Any]]:
    """Return the materials of an object with one changed; see `operations` for arguments."""
    chosen = part or ALL_PARTS
    entries = [m.model_dump(mode="json", exclude_unset=True) for m in entry.materials]
    parts = [entry.get("part", ALL_PARTS) for entry in entries]
    if chosen == ALL_PARTS:
        # What is asked for last is what is seen.
        before = entries[parts.index(ALL_PARTS)] if ALL_PARTS in parts else {}
        kept: list[dict[str, Any]] = []
    else:
        before = entries[parts.index(chosen)] if chosen in parts else {"part": chosen}
        kept = [entry for entry, name in zip(entries, parts, strict=True) if name != chosen]
    if changes:
        kept.append(merged_look(before, changes, MaterialSpec))
    return kept


def changed_surface(
    world: World, instance_id: int, part: str, changes: Mapping[str, Any]
) -> dict[str, Any] | None:
    """Return the keys of the changed look of a part of the room; None: the scene file's."""
    if part not in ("", ALL_PARTS):
        name = world.body(instance_id).placement.name
        raise UnknownName(f"material of {name}", part, (ALL_PARTS,))
    if not changes:
        return None
    return merged_look(surface_keys(world, instance_id) or {}, changes, LookSpec)


def merged_look(
    present: Mapping[str, Any], changes: Mapping[str, Any], model: type[LookSpec]
) -> dict[str, Any]:
    """Return the keys of a look with some of them changed; None takes one out.

    Raises
    ------
    UnknownName
        If there is no such key.
    """
    known = {**model.model_fields, **LookSpec.model_fields}
    for key in changes:
        if key not in known or key == "part":
            raise UnknownName("key of a material", key, [k for k in known if k != "part"])
    wanted = plain_value(changes)
    merged = {**present, **wanted}
    for key, other in (_EXCLUSIVE, _EXCLUSIVE[::-1]):
        if wanted.get(key) is not None and wanted.get(other) is None:
            merged.pop(other, None)
    return {key: value for key, value in merged.items() if value is not None}


def surface_keys(world: World, instance_id: int) -> dict[str, Any] | None:
    """Return what the scene says of the look of a part of the room; None for what is none.

    None for the leaf of a door, too, whose look is that of the door.
    """
    described = world.described
    name = world.body(instance_id).placement.name
    if described is None or described.room is None or name not in _part_names(described.room):
        return None
    if world.joint(instance_id) is not None:
        return None
    return _keys_of(described.room, name)


def set_surface(scene: LiveScene, instance_id: int, keys: Mapping[str, Any] | None) -> None:
    """Change the look of a part of the room to these keys; None: to the scene file's."""
    world = scene.world
    body = world.body(instance_id)
    name = body.placement.name
    described = world.described
    assert described is not None
    room = _room(described.room, name)
    if keys is None:
        keys = _keys_of(_room(world.first_room, name), name)
    entry = _with_keys(room, name, keys)
    spec = checked_scene(
        {"version": 1, "room": entry}, scene.library.knowledge_of(world.scene), what=f"{name!r}"
    ).room
    assert spec is not None
    stock = scene.library.materials.of(world.scene)
    made = {p.name: p for p in room_placements(spec, world.categories, stock)}
    described = described.model_copy(update={"room": spec})
    world.replace_body(instance_id, replace(body.placement, asset=made[name].asset), described)
    # A leaf has the colour of its door.
    for number, other in list(world.numbered_bodies):
        leaf = other.placement.name
        if other.placement.entry is None and leaf == f"{name} leaf" and leaf in made:
            painted = replace(other.placement, asset=made[leaf].asset)
            world.replace_body(number, painted, described)
    scene.announce()


def _part_names(room: RoomSpec) -> frozenset[str]:
    return frozenset(room_part_names(room.model_dump(mode="json", exclude_unset=True)))


def _room(room: RoomSpec | None, name: str) -> RoomSpec:
    if room is None:
        raise InvalidRequest("object", name, "one of the scene's own, or a part of its room")
    return room


def _keys_of(room: RoomSpec, name: str) -> dict[str, Any]:
    """Return the keys of a part's look, of all that it could have those that differ."""
    look = room.look_of(name)
    if look is not None:
        return look
    entry = room.model_dump(mode="json", exclude_unset=True)
    place = _colour_place(room, name, entry)
    return {"colour": place["colour"]} if "colour" in place else {}


def _with_keys(room: RoomSpec, name: str, keys: Mapping[str, Any]) -> dict[str, Any]:
    """Return the room as a file would have it, with another look of one of its parts."""
    entry: dict[str, Any] = room.model_dump(mode="json", exclude_unset=True)
    if name.removesuffix(_WALL) in WALLS and name.endswith(_WALL):
        walls = dict(entry.get("wall_materials", {}))
        walls[name.removesuffix(_WALL)] = dict(keys)
        entry["wall_materials"] = walls
    elif name in ("floor", "ceiling"):
        entry[name] = dict(keys)
    elif any(area.name == name for area in room.floors):
        for area in entry["floors"]:
            if area["name"] == name:
                area["surface"] = dict(keys)
    elif any(partition.name == name for partition in room.partitions):
        for partition in entry["partitions"]:
            if partition["name"] == name:
                partition.update({wall: dict(keys) for wall in _sides(partition)})
    else:
        place = _colour_place(room, name, entry)
        place.pop("colour", None)
        place.update(keys)
    return entry


def _sides(partition: Mapping[str, Any]) -> tuple[str, str]:
    """Return where the two sides of a wall inside the room look."""
    (x0, y0), (x1, y1) = partition["start"], partition["end"]
    return ("north", "south") if abs(x1 - x0) > abs(y1 - y0) else ("east", "west")


def _colour_place(room: RoomSpec, name: str, entry: dict[str, Any]) -> dict[str, Any]:
    """Return the mapping within a room's entry that holds the colour of a board or an opening."""
    if name == "skirting":
        if not isinstance(entry.get("skirting"), dict):
            entry["skirting"] = {}
        board: dict[str, Any] = entry["skirting"]
        return board
    kind, _, number = name.partition(" ")
    wanted = {"window": "window", "door": "door", "curtains": "window"}.get(kind)
    if wanted is None or not number.isdecimal():
        accepted = "a wall, the floor, the ceiling, a window or a door, with which goes its leaf"
        raise InvalidRequest("object", name, accepted)
    same = [one for one in entry.get("openings", ()) if one["type"] == wanted]
    opening: dict[str, Any] = same[int(number) - 1]
    if kind != "curtains":
        return opening
    if not isinstance(opening.get("curtains"), dict):
        opening["curtains"] = {}
    cloth: dict[str, Any] = opening["curtains"]
    return cloth
