"""Rules for the walls inside a room and the parts of its floor.

Rules take entries as plain data, of which nothing is certain yet, as those of `rules`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from sailenv_ros.scene.messages import shown
from sailenv_ros.scene.room_rules import DOOR_SIZE_M, room_part_names, size_of
from sailenv_ros.scene.rules import Entry, Faults
from sailenv_ros.types.validation import is_finite_number, shown_number

__all__ = [
    "along_an_axis",
    "corners_apart",
    "distinct_parts",
    "doorways_inside",
    "floors_apart",
    "inside_room",
]


LEAST_LENGTH_M = 0.1
_TOUCHING_M = 1e-9


def along_an_axis(partition: Entry) -> Faults:
    """Refuse walls that are neither along x nor along y, or have no length."""
    ends = _ends(partition)
    if ends is None:
        return
    (x0, y0), (x1, y1) = ends
    if abs(x1 - x0) > _TOUCHING_M and abs(y1 - y0) > _TOUCHING_M:
        yield ("end",), f"must have the same x or the same y as start, got {shown([x1, y1])}"
    elif max(abs(x1 - x0), abs(y1 - y0)) < LEAST_LENGTH_M:
        yield ("end",), f"must lie {shown_number(LEAST_LENGTH_M)} [m] or more from start"


def doorways_inside(partition: Entry) -> Faults:
    """Refuse doorways that leave their wall or overlap one before them."""
    ends = _ends(partition)
    if ends is None:
        return
    length = max(abs(a - b) for a, b in zip(*ends, strict=True))
    before: list[tuple[int, float, float]] = []
    listed = partition.get("doorways")
    for index, entry in enumerate(listed if isinstance(listed, list | tuple) else ()):
        if not isinstance(entry, Mapping):
            continue
        at, width = entry.get("at", 0.0), entry.get("width", DOOR_SIZE_M[0])
        if not (is_finite_number(at) and is_finite_number(width)):
            continue
        place = ("doorways", index)
        free = (length - width) / 2.0
        if free < -_TOUCHING_M:
            limit = f"at most {shown_number(length)} [m], the length of the wall"
            yield (*place, "width"), f"must be {limit}, got {shown_number(width)}"
        elif abs(at) > free + _TOUCHING_M:
            bound = shown_number(free)
            limit = f"from {shown_number(-free)} to {bound} [m], so that it lies in the wall"
            yield (*place, "at"), f"must be {limit}, got {shown_number(at)}"
        for other, other_at, other_width in before:
            if abs(at - other_at) < (width + other_width) / 2.0 - _TOUCHING_M:
                yield place, f"overlaps doorways[{other}]"
                break
        before.append((index, at, width))


def corners_apart(area: Entry) -> Faults:
    """Refuse parts of a floor without an area."""
    ends = _ends(area)
    if ends is not None and min(abs(a - b) for a, b in zip(*ends, strict=True)) < LEAST_LENGTH_M:
        least = shown_number(LEAST_LENGTH_M)
        yield ("end",), f"must lie {least} [m] or more from start along x and along y"


def inside_room(room: Entry) -> Faults:
    """Refuse walls and parts of the floor that leave the room, and doorways above the ceiling."""
    size = size_of(room)
    if not size:
        return
    for key, index, entry in _parts(room):
        ends = _ends(entry)
        for name, corner in zip(("start", "end"), ends or (), strict=False):
            if any(abs(corner[k]) > size[k] / 2.0 + _TOUCHING_M for k in range(2)):
                x, y = (shown_number(size[k] / 2.0) for k in range(2))
                limit = f"from -{x} to {x} along x and from -{y} to {y} along y [m]"
                yield (key, index, name), f"must lie in the room, {limit}, got {shown(corner)}"
        listed = entry.get("doorways")
        for place, doorway in enumerate(listed if isinstance(listed, list | tuple) else ()):
            tall = doorway.get("height", DOOR_SIZE_M[1]) if isinstance(doorway, Mapping) else None
            if is_finite_number(tall) and tall > size[2] + _TOUCHING_M:
                where = (key, index, "doorways", place, "height")
                yield (
                    where,
                    f"must be at most {shown_number(size[2])} [m], got {shown_number(tall)}",
                )


def floors_apart(room: Entry) -> Faults:
    """Refuse parts of the floor that overlap one before them."""
    before: list[tuple[int, tuple[float, ...], tuple[float, ...]]] = []
    for key, index, entry in _parts(room):
        ends = _ends(entry) if key == "floors" else None
        if ends is None:
            continue
        low = tuple(min(a, b) for a, b in zip(*ends, strict=True))
        high = tuple(max(a, b) for a, b in zip(*ends, strict=True))
        for other, its_low, its_high in before:
            shared = (
                min(high[k], its_high[k]) - max(low[k], its_low[k]) > _TOUCHING_M for k in range(2)
            )
            if all(shared):
                yield ("floors", index), f"overlaps floors[{other}]"
                break
        before.append((index, low, high))


def distinct_parts(room: Entry) -> Faults:
    """Refuse walls and parts of the floor that are called as another part of the room is."""
    others = list(room_part_names({**room, "partitions": (), "floors": ()}))
    taken = set(others)
    for key, index, entry in _parts(room):
        name = entry.get("name")
        if not isinstance(name, str):
            continue
        if name in taken:
            yield (key, index, "name"), f"is the name of another part of the room: {shown(name)}"
        taken.add(name)


def _parts(room: Entry) -> Iterator[tuple[str, int, Entry]]:
    for key in ("partitions", "floors"):
        listed = room.get(key)
        for index, entry in enumerate(listed if isinstance(listed, list | tuple) else ()):
            if isinstance(entry, Mapping):
                yield key, index, entry


def _ends(entry: Entry) -> tuple[Sequence[float], Sequence[float]] | None:
    """Return start and end whose numbers are numbers, else None."""
    ends = entry.get("start"), entry.get("end")
    for end in ends:
        if not isinstance(end, list | tuple) or len(end) != 2:
            return None
        if not all(map(is_finite_number, end)):
            return None
    return ends  # type: ignore[return-value]
