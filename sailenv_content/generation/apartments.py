"""The shell of an apartment: a rectangle that walls divide into rooms, with doorways between them.

Layouts of a kind's rules in, a `Shell` with several areas out. Each room has its own materials.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from sailenv_content.generation.plan import Area, Block, WallGap, WallSide
from sailenv_content.generation.room_shapes import (
    DOOR_M,
    OUTER,
    PARTITION_M,
    Shell,
    add_openings,
    note_openings,
    surface_entry,
)
from sailenv_ros.authoring.room_rules.random_stream import RandomStream
from sailenv_ros.authoring.room_rules.rule_files import Rules
from sailenv_ros.authoring.room_rules.rule_models import SplitRule

__all__ = ["apartment"]

_EDGE_M = 1e-6
_FROM_CORNER_M = 0.25
_OPPOSITE = {"north": "south", "south": "north", "east": "west", "west": "east"}
_NORMALS = {wall: inward for wall, (_, _, inward) in OUTER.items()}


@dataclass(slots=True)
class _Room:
    """A part of the apartment: its rectangle between the middle lines of its walls."""

    split: SplitRule
    low: tuple[float, float]
    high: tuple[float, float]
    faces: dict[str, Any] = field(default_factory=dict)
    sides: list[WallSide] = field(default_factory=list)


def apartment(kind: str, rules: Rules, dice: RandomStream) -> Shell:
    """Return the shell of an apartment."""
    file = rules.kind(kind)
    x, y = (round(dice.between(span), 1) for span in (file.shape.width, file.shape.depth))
    height = round(dice.between(file.shape.height), 2)
    shell = Shell(entry={"size": [x, y, height]})
    flips = (dice.chance(0.5), dice.chance(0.5))
    rooms = list(_divided(dice.one(file.layouts), (-x / 2, -y / 2), (x / 2, y / 2), flips, dice))
    own = dice.one(file.materials)
    openings: list[dict[str, Any]] = []
    entrance = next((room for room in rooms if room.split.hub), rooms[0])
    for room in rooms:
        assert room.split.kind is not None
        file_of_room = rules.kind(room.split.kind)
        name = own if own in file_of_room.materials else dice.one(file_of_room.materials)
        materials = rules.materials[name]
        room.faces["walls"] = surface_entry(dice.one(materials.walls), dice.whole((0, 99)))
        room.faces["floor"] = surface_entry(dice.one(materials.floor), dice.whole((0, 99)))
        outer = _outer_sides(room, (x, y))
        holes, outer = add_openings(
            outer, file_of_room, materials, dice, height, doors=room is entrance
        )
        openings += holes
        room.sides += outer
    for entry in _partitions(rooms, (x, y), dice):
        shell.entry.setdefault("partitions", []).append(entry)
    shell.entry["openings"] = openings
    _take_materials(shell, rooms, entrance)
    for room in rooms:
        low, high = _inner(room, (x, y))
        shell.areas.append(
            Area(
                name=str(room.split.name), kind=str(room.split.kind), low=low, high=high,
                height=height, walls=tuple(room.sides),
            )
        )  # fmt: skip
        own_openings = [o for o in openings if any(s.wall == o["wall"] for s in room.sides)]
        note_openings(shell, own_openings if room is entrance else (), room.sides)
    for entry in shell.entry.get("partitions", ()):
        shell.walls += _blocks(entry, height)
    return shell


def _divided(
    split: SplitRule,
    low: tuple[float, float],
    high: tuple[float, float],
    flips: tuple[bool, bool],
    dice: RandomStream,
) -> Sequence[_Room]:
    """Return the rooms of a layout within a rectangle; both axes may be turned round."""
    if split.along is None:
        return [_Room(split, low, high)]
    axis = "xy".index(split.along)
    share = dice.between(split.at)
    parts = list(split.parts)
    if flips[axis]:
        parts, share = parts[::-1], 1.0 - share
    at = round(low[axis] + share * (high[axis] - low[axis]), 1)
    middle_high, middle_low = list(high), list(low)
    middle_high[axis] = middle_low[axis] = at
    first = _divided(parts[0], low, (middle_high[0], middle_high[1]), flips, dice)
    second = _divided(parts[1], (middle_low[0], middle_low[1]), high, flips, dice)
    return [*first, *second]


def _inner(
    room: _Room, size: tuple[float, float]
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the rectangle between the faces of a room's walls."""
    half = PARTITION_M / 2.0
    low = tuple(
        v if abs(v + s / 2.0) < _EDGE_M else v + half for v, s in zip(room.low, size, strict=True)
    )
    high = tuple(
        v if abs(v - s / 2.0) < _EDGE_M else v - half for v, s in zip(room.high, size, strict=True)
    )
    return (low[0], low[1]), (high[0], high[1])


def _side(room: _Room, wall: str, size: tuple[float, float], outer: str) -> WallSide:
    """Return the whole side of a room that looks away from one of the four directions."""
    low, high = _inner(room, size)
    start_signs, end_signs, inward = OUTER[wall]
    corner = {-1.0: low, 1.0: high}
    return WallSide(
        wall=outer,
        start=(corner[start_signs[0]][0], corner[start_signs[1]][1]),
        end=(corner[end_signs[0]][0], corner[end_signs[1]][1]),
        inward=inward,
    )


def _outer_sides(room: _Room, size: tuple[float, float]) -> list[WallSide]:
    """Return the sides of a room that are outer walls of the apartment."""
    edges = {
        "north": abs(room.high[1] - size[1] / 2.0),
        "east": abs(room.high[0] - size[0] / 2.0),
        "south": abs(room.low[1] + size[1] / 2.0),
        "west": abs(room.low[0] + size[0] / 2.0),
    }
    return [_side(room, wall, size, wall) for wall, off in edges.items() if off < _EDGE_M]


def _partitions(
    rooms: Sequence[_Room], size: tuple[float, float], dice: RandomStream
) -> list[dict[str, Any]]:
    """Return the walls between rooms; each room has a doorway to the hub, or to one that has."""
    shared = []
    for number, first in enumerate(rooms):
        for second in rooms[number + 1 :]:
            found = _shared(first, second)
            if found is not None:
                shared.append((first, second, found))
    joined = {id(next((room for room in rooms if room.split.hub), rooms[0]))}
    doors: set[int] = set()
    while True:
        new = [
            index
            for index, (a, b, (_, _, low, high)) in enumerate(shared)
            if (id(a) in joined) != (id(b) in joined)
            and high - low > DOOR_M[0] + 2.0 * _FROM_CORNER_M + PARTITION_M
        ]
        if not new:
            break
        doors.add(new[0])
        joined |= {id(shared[new[0]][0]), id(shared[new[0]][1])}
    entries = []
    for index, (first, second, (axis, at, low, high)) in enumerate(shared):
        entries.append(
            _wall_between(first, second, axis, at, (low, high), size, index in doors, dice)
        )
    return entries


def _shared(first: _Room, second: _Room) -> tuple[int, float, float, float] | None:
    """Return axis, place and extent of the line that two rooms share; None if they share none."""
    for axis in range(2):
        other = 1 - axis
        low = max(first.low[other], second.low[other])
        high = min(first.high[other], second.high[other])
        for one, two in ((first, second), (second, first)):
            if abs(one.high[axis] - two.low[axis]) < _EDGE_M and high - low > 0.2:
                return axis, one.high[axis], low, high
    return None


def _wall_between(
    first: _Room,
    second: _Room,
    axis: int,
    at: float,
    extent: tuple[float, float],
    size: tuple[float, float],
    with_door: bool,
    dice: RandomStream,
) -> dict[str, Any]:
    """Return the entry of a wall between two rooms; both get their side of it."""
    other = 1 - axis
    low, high = extent
    # Walls end at the middle lines of those they meet, which is within those.
    start, end = [0.0, 0.0], [0.0, 0.0]
    start[axis] = end[axis] = at
    start[other], end[other] = low, high
    entry: dict[str, Any] = {
        "name": f"wall between {first.split.name} and {second.split.name}",
        "start": [round(v, 3) for v in start],
        "end": [round(v, 3) for v in end],
    }
    hole: tuple[float, float] | None = None
    if with_door:
        margin = DOOR_M[0] / 2.0 + _FROM_CORNER_M + PARTITION_M / 2.0
        middle = (low + high) / 2.0
        door = round(dice.between((low + margin, high - margin)) - middle, 2)
        entry["doorways"] = [{"at": door, "width": DOOR_M[0], "height": DOOR_M[1]}]
        hole = (middle + door - DOOR_M[0] / 2.0, middle + door + DOOR_M[0] / 2.0)
    below, above = (first, second) if first.high[axis] <= at + _EDGE_M else (second, first)
    faces = ("east", "west") if axis == 0 else ("north", "south")
    for room, wall in ((below, faces[0]), (above, faces[1])):
        side = _side(room, wall, size, "")
        # Only the shared stretch of the side is this wall's.
        a, b = list(side.start), list(side.end)
        a[other], b[other] = max(a[other], low), min(b[other], high)
        holes: tuple[WallGap, ...] = ()
        if hole is not None:
            along = (hole[0] - a[other], hole[1] - a[other])
            holes = (WallGap(along=along, up=(0.0, DOOR_M[1]), kind="doorway"),)
        room.sides.append(
            WallSide(
                wall="", start=(a[0], a[1]), end=(b[0], b[1]), inward=_NORMALS[wall], holes=holes
            )
        )
        # The side of the partition that a room sees looks away from its own wall's direction.
        entry[_OPPOSITE[wall]] = room.faces["walls"]
    return entry


def _take_materials(shell: Shell, rooms: Sequence[_Room], hub: _Room) -> None:
    """Take the hub's walls and floor for the apartment, and its own floor for each other room."""
    shell.entry["walls"] = hub.faces["walls"]
    shell.entry["floor"] = hub.faces["floor"]
    shell.entry["skirting"] = {"colour": [0.78, 0.77, 0.73]}
    floors = [
        {
            "name": f"{room.split.name} floor",
            "start": [round(v, 3) for v in room.low],
            "end": [round(v, 3) for v in room.high],
            "surface": room.faces["floor"],
        }
        for room in rooms
        if room is not hub
    ]
    if floors:
        shell.entry["floors"] = floors


def _blocks(entry: dict[str, Any], height: float) -> list[Block]:
    """Return the solid parts of a wall between rooms: left and right of its doorways."""
    (x0, y0), (x1, y1) = entry["start"], entry["end"]
    axis = 0 if abs(x1 - x0) > abs(y1 - y0) else 1
    ends = sorted((entry["start"][axis], entry["end"][axis]))
    middle = sum(ends) / 2.0
    cuts = [ends[0]]
    for door in entry.get("doorways", ()):
        cuts += [
            middle + door["at"] - door["width"] / 2.0,
            middle + door["at"] + door["width"] / 2.0,
        ]
    cuts.append(ends[1])
    half = PARTITION_M / 2.0
    blocks = []
    for low, high in zip(cuts[::2], cuts[1::2], strict=True):
        centre, reach = (low + high) / 2.0, (high - low) / 2.0
        x, y = (centre, y0) if axis == 0 else (x0, centre)
        blocks.append(
            Block(
                x=x, y=y, half_x=reach if axis == 0 else half, half_y=half if axis == 0 else reach,
                low=0.0, high=height,
            )
        )  # fmt: skip
    return blocks
