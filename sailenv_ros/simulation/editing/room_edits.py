"""The room of a running world: made, resized, put back, and its floor plan.

A room is centred on the world's origin, so a resize moves opposite walls alike; objects stay where
they are. Knows no operation; those are in `operations.rooms`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from sailenv_ros.assets.outside import daylight_of
from sailenv_ros.errors import InvalidEntry, InvalidRequest, NameTaken
from sailenv_ros.scene.entries import checked_scene
from sailenv_ros.scene.room_rules import inside_walls, room_part_names, without_overlaps
from sailenv_ros.scene.spec import RoomSpec
from sailenv_ros.scene.spec_room import OpeningSpec
from sailenv_ros.simulation.editing.edit_records import ObjectRecord, bring_back, record_of
from sailenv_ros.simulation.editing.editor import SceneEditor
from sailenv_ros.simulation.editing.saving import room_entry, unserialisable_changes
from sailenv_ros.simulation.live_scene import LiveScene
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.build import room_placements
from sailenv_ros.world.world import World

__all__ = [
    "FloorPlan",
    "PlanObject",
    "RoomRecord",
    "floor_plan_of",
    "resize_room",
    "restore_room",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class RoomRecord:
    """A room as it was before or after a change.

    Attributes
    ----------
    room : RoomSpec or None
        None where there was none.
    objects : tuple of ObjectRecord
        Objects that were there before a room took their place, such as a plane called ``floor``.
    """

    room: RoomSpec | None
    objects: tuple[ObjectRecord, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanObject:
    """An object as it lies in a floor plan.

    Attributes
    ----------
    id : int
    name : str
    corners_m : tuple of (2,) tuple of float
        Of its box, seen from above: 8 points in the world's x and y [m]. The point of index
        4 a + 2 b + c is at the far end of the object's own x, y, z where a, b, c is 1.
    """

    id: int
    name: str
    corners_m: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class FloorPlan:
    """Contents of a floor plan.

    Attributes
    ----------
    size_m : (3,) tuple of float or None
        Of the room, inside: along x, along y, height [m]; None if there is no room.
    openings : tuple of OpeningSpec
    objects : tuple of PlanObject
        All but the parts of the room.
    """

    size_m: tuple[float, float, float] | None
    openings: tuple[OpeningSpec, ...]
    objects: tuple[PlanObject, ...]


def floor_plan_of(world: World) -> FloorPlan:
    """Return the room and its objects as they lie in a plan now."""
    assert world.described is not None
    room = world.described.room
    return FloorPlan(
        size_m=None if room is None else room.size,
        openings=() if room is None else room.openings,
        objects=tuple(
            PlanObject(id=id_, name=body.placement.name, corners_m=_corners(body))
            for id_, body in world.bodies_by_id.items()
            if body.placement.entry is not None
        ),
    )


def resize_room(
    editor: SceneEditor, size_m: tuple[float, float, float]
) -> tuple[RoomRecord, RoomRecord]:
    """Resize the room or make one; return it as it was and is.

    See `RoomOperations.set_room_size` for errors.
    """
    scene = editor.scene
    world = scene.world
    assert world.described is not None
    lost = list(unserialisable_changes(world))
    if lost:
        raise InvalidEntry("room", world.described.room, lost)
    present = room_entry(world)
    wanted = {**present, "size": list(size_m)}
    _require_openings_fit(wanted, size_m)
    room = _checked(scene, wanted)
    before, parts = world.described.room, set(room_part_names(wanted))
    if world.missing_parts:
        before = _checked(scene, present)
    replaced = tuple(
        record_of(world, id_)
        for id_, body in world.bodies_by_id.items()
        if body.placement.entry is not None
        and body.placement.static
        and body.placement.name in parts
    )
    records = RoomRecord(room=before, objects=replaced), RoomRecord(room=room)
    restore_room(editor, *records)
    return records


def restore_room(editor: SceneEditor, present: RoomRecord, wanted: RoomRecord) -> None:
    """Make of the room what a record says; see `RoomOperations.restore_room` for errors."""
    scene = editor.scene
    world = scene.world
    assert world.described is not None
    going = [world.find(record.name) for record in present.objects]
    staying = {
        body.placement.name
        for id_, body in world.bodies_by_id.items()
        if body.placement.entry is not None and id_ not in going
    }
    for record in wanted.objects:
        if record.name in staying:
            raise NameTaken("object", record.name)
    daylight = daylight_of(world.contents.lights, world.contents.environment)
    stock = scene.library.materials.of(world.scene)
    world.replace_room(
        room_placements(wanted.room, world.categories, stock, daylight),
        world.described.model_copy(update={"room": wanted.room}),
        without=going,
    )
    for record in wanted.objects:
        bring_back(editor, record)
    scene.library.load_light(world)
    scene.announce()


def _checked(scene: LiveScene, entry: Mapping[str, Any]) -> RoomSpec:
    data = {"version": 1, "room": entry}
    room = checked_scene(data, scene.library.knowledge_of(scene.world.scene), what="room").room
    assert room is not None
    return room


def _require_openings_fit(room: Mapping[str, Any], size_m: tuple[float, float, float]) -> None:
    """Refuse a size in the words of the first opening that it leaves no place."""
    for rule in (inside_walls, without_overlaps):
        for place, why in rule(room):
            index = int(place[1])
            opening = room["openings"][index]
            same = [other["type"] for other in room["openings"][: index + 1]]
            name = f"{opening['type']} {same.count(opening['type'])}"
            accepted = f"one that {name} in the {opening['wall']} wall fits into"
            value = f" ({place[2]} {why})" if len(place) > 2 else f" ({why})"
            raise InvalidRequest("size of the room", size_m, accepted + value)


def _corners(body: Body) -> tuple[tuple[float, float], ...]:
    ends = body.placement.asset.model.bounds() * np.asarray(body.placement.scale)
    points = np.array(list(product(*ends.T)))
    matrix = body.world_from_body()
    placed = points @ matrix[:2, :3].T + matrix[:2, 3]
    return tuple((float(x), float(y)) for x, y in placed)
