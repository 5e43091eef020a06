"""Rules for the parts of a room: openings lie in their walls and do not overlap, names are free.

Rules take entries as plain data, of which nothing is certain yet, as those of `rules`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal

from sailenv_ros.scene.messages import shown
from sailenv_ros.scene.rules import Entry, Faults
from sailenv_ros.scene.spec_outside import NO_OUTSIDE, OUTSIDE
from sailenv_ros.types.validation import is_finite_number, shown_number

__all__ = [
    "DOOR_SIZE_M",
    "WALLS",
    "WINDOW_SIZE_M",
    "inside_walls",
    "names_beside_room",
    "room_part_names",
    "size_of",
    "without_overlaps",
]

WALLS: Final[tuple[Literal["north", "east", "south", "west"], ...]] = (
    "north",
    "east",
    "south",
    "west",
)
WINDOW_SIZE_M = (1.2, 1.3, 0.9)
"""Width, height and height of the sill of a window that says nothing."""
DOOR_SIZE_M = (0.9, 2.05)
"""Width and height of a door that says nothing."""

_TOUCHING_M = 1e-9


@dataclass(frozen=True, slots=True)
class _Opening:
    """An opening whose numbers are numbers."""

    index: int
    wall: str
    at: float
    width: float
    low: float
    high: float

    def overlaps(self, other: _Opening) -> bool:
        beside = abs(self.at - other.at) - (self.width + other.width) / 2.0
        above = max(self.low, other.low) - min(self.high, other.high)
        return self.wall == other.wall and max(beside, above) < -_TOUCHING_M


def size_of(room: Entry) -> Sequence[float]:
    """Return a room's width, depth and height [m]; nothing if they are none."""
    size = room.get("size")
    if isinstance(size, list | tuple) and len(size) == 3 and all(map(is_finite_number, size)):
        return size
    return ()


def inside_walls(room: Entry) -> Faults:
    """Refuse openings that are larger than their wall or leave it."""
    size = size_of(room)
    for opening in _openings(room) if size else ():
        length = size[0] if opening.wall in ("north", "south") else size[1]
        place, wall = ("openings", opening.index), f"the {opening.wall} wall"
        free = (length - opening.width) / 2.0
        if free < -_TOUCHING_M:
            limit = f"at most {shown_number(length)} [m], the length of {wall}"
            yield (*place, "width"), f"must be {limit}, got {shown_number(opening.width)}"
        elif abs(opening.at) > free + _TOUCHING_M:
            bound = shown_number(free)
            limit = f"from {shown_number(-free)} to {bound} [m], so that it lies in {wall}"
            yield (*place, "at"), f"must be {limit}, got {shown_number(opening.at)}"
        if opening.high > size[2] + _TOUCHING_M:
            limit = f"at most {shown_number(size[2] - opening.low)} [m]"
            got = shown_number(opening.high - opening.low)
            yield (*place, "height"), f"must be {limit}, up to the ceiling, got {got}"


def without_overlaps(room: Entry) -> Faults:
    """Refuse openings that overlap one before them."""
    openings = list(_openings(room))
    for number, opening in enumerate(openings):
        hit = next((other for other in openings[:number] if opening.overlaps(other)), None)
        if hit is not None:
            yield (
                ("openings", opening.index),
                f"overlaps openings[{hit.index}] on the {opening.wall} wall",
            )


def names_beside_room(scene: Entry) -> Faults:
    """Refuse objects that are called as a part of the room is."""
    room, objects = scene.get("room"), scene.get("objects")
    if not isinstance(room, Mapping) or not isinstance(objects, list | tuple):
        return
    taken = frozenset(room_part_names(room))
    for index, entry in enumerate(objects):
        name = entry.get("name") if isinstance(entry, Mapping) else None
        if isinstance(name, str) and name in taken:
            yield ("objects", index, "name"), f"is the name of a part of the room: {shown(name)}"


def room_part_names(room: Entry) -> Iterator[str]:
    """Yield the names of all objects that a room may become."""
    yield from ("floor", "ceiling", "skirting")
    outside = room.get("outside")
    kind = outside.get("kind") if isinstance(outside, Mapping) else outside
    if isinstance(kind, str) and kind != NO_OUTSIDE:
        yield OUTSIDE
    yield from (f"{wall} wall" for wall in WALLS)
    for key in ("partitions", "floors"):
        parts = room.get(key)
        for part in parts if isinstance(parts, list | tuple) else ():
            name = part.get("name") if isinstance(part, Mapping) else None
            if isinstance(name, str):
                yield name
                doorways = part.get("doorways")
                count = len(doorways) if isinstance(doorways, list | tuple) else 0
                yield from (f"{name} door {number} leaf" for number in range(1, count + 1))
    counts = {"window": 0, "door": 0}
    listed = room.get("openings")
    for entry in listed if isinstance(listed, list | tuple) else ():
        kind = entry.get("type") if isinstance(entry, Mapping) else None
        if isinstance(kind, str) and kind in counts:
            counts[kind] += 1
            yield f"{kind} {counts[kind]}"
            if kind == "window":
                yield f"curtains {counts[kind]}"
            elif entry.get("hinged") is True:
                yield f"door {counts[kind]} leaf"


def _openings(room: Entry) -> Iterator[_Opening]:
    """Yield the openings whose keys are well, with their defaults."""
    listed = room.get("openings")
    for index, entry in enumerate(listed if isinstance(listed, list | tuple) else ()):
        if not isinstance(entry, Mapping) or entry.get("wall") not in WALLS:
            continue
        if entry.get("type") not in ("window", "door"):
            continue
        width, height, sill = WINDOW_SIZE_M if entry.get("type") == "window" else (*DOOR_SIZE_M, 0)
        at, width, height, sill = (
            entry.get("at", 0.0),
            entry.get("width", width),
            entry.get("height", height),
            entry.get("sill", sill),
        )
        if all(map(is_finite_number, (at, width, height, sill))):
            yield _Opening(index, str(entry["wall"]), at, width, sill, sill + height)
