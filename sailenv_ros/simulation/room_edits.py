"""The room of a running world: made, resized, put back, and its floor plan.

A room is centred on the world's origin, so a resize moves opposite walls alike; objects stay where
they are. These operations belong to an editor that keeps a history of changes, as those of
`edit_records` do.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from sailenv_ros.errors import InvalidEntry, InvalidRequest, NameTaken
from sailenv_ros.operations.operation import Caller, operation
from sailenv_ros.scene.entries import checked_scene
from sailenv_ros.scene.room_rules import inside_walls, room_part_names, without_overlaps
from sailenv_ros.scene.spec import RoomSpec
from sailenv_ros.scene.spec_room import OpeningSpec
from sailenv_ros.simulation.edit_records import ObjectRecord, bring_back, record_of
from sailenv_ros.simulation.saving import room_entry, unsaid
from sailenv_ros.world.build import room_placements

if TYPE_CHECKING:
    from sailenv_ros.simulation.core import SimulationCore
    from sailenv_ros.world.bodies import Body

__all__ = ["FloorPlan", "PlanObject", "RoomOperations", "RoomRecord"]


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


class RoomOperations(Caller):
    """Operations of an editor upon the room."""

    @operation()
    @staticmethod
    def floor_plan(core: SimulationCore) -> FloorPlan:
        """Return the room and its objects as they lie in a plan now."""
        assert core.world.described is not None
        room = core.world.described.room
        return FloorPlan(
            size_m=None if room is None else room.size,
            openings=() if room is None else room.openings,
            objects=tuple(
                PlanObject(id=id_, name=body.placement.name, corners_m=_corners(body))
                for id_, body in core.world.bodies_by_id.items()
                if body.placement.entry is not None
            ),
        )

    @operation(deadline_s=60.0)
    @staticmethod
    def set_room_size(
        core: SimulationCore, size_m: tuple[float, float, float]
    ) -> tuple[RoomRecord, RoomRecord]:
        """Resize the room, or make one with the usual materials where there is none.

        A new room takes the place of static objects that are called as its parts are.

        Parameters
        ----------
        size_m : (3,) tuple of float
            Inside: along x, along y, height [m].

        Returns
        -------
        before, after : RoomRecord
            For `restore_room`.

        Raises
        ------
        InvalidRequest, InvalidEntry, NameTaken
            If an opening does not fit, a part was moved or taken out, the size is out of range, or
            an object that moves is called as a part is; nothing is changed then.
        """
        world = core.world
        assert world.described is not None
        lost = list(unsaid(world))
        if lost:
            raise InvalidEntry("room", world.described.room, lost)
        present = room_entry(world)
        wanted = {**present, "size": list(size_m)}
        _require_openings_fit(wanted, size_m)
        room = _checked(core, wanted)
        before, parts = world.described.room, set(room_part_names(wanted))
        if world.missing_parts:
            before = _checked(core, present)
        replaced = tuple(
            record_of(core, id_)
            for id_, body in world.bodies_by_id.items()
            if body.placement.entry is not None
            and body.placement.static
            and body.placement.name in parts
        )
        records = RoomRecord(room=before, objects=replaced), RoomRecord(room=room)
        _exchange(core, *records)
        return records

    @operation(deadline_s=60.0)
    @staticmethod
    def restore_room(core: SimulationCore, present: RoomRecord, wanted: RoomRecord) -> None:
        """Make of the room what a record says.

        Raises
        ------
        UnknownName, NameTaken
            If others have changed objects so that it cannot be done; nothing is done then.
        """
        _exchange(core, present, wanted)


def _exchange(core: SimulationCore, present: RoomRecord, wanted: RoomRecord) -> None:
    world = core.world
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
    world.replace_room(
        room_placements(wanted.room, world.categories, core.library.materials_of(world.scene)),
        world.described.model_copy(update={"room": wanted.room}),
        without=going,
    )
    for record in wanted.objects:
        bring_back(core, record)
    core.library.load_light(world)
    core.announce()


def _checked(core: SimulationCore, entry: Mapping[str, Any]) -> RoomSpec:
    data = {"version": 1, "room": entry}
    room = checked_scene(data, core.library.knowledge_of(core.world.scene), what="room").room
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
