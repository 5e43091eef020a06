"""Rules between the keys of one entry of a scene file.

Each rule takes an entry as plain data, of which nothing is certain yet, and yields the place
inside it and a sentence. Rules keep silent about values that are wrong in themselves.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, TypeAlias

from sailenv_ros.scene.fields import Rule
from sailenv_ros.scene.messages import shown, suggestion
from sailenv_ros.types.labels import UNLABELLED_CATEGORY
from sailenv_ros.types.picture_settings import LIMITS
from sailenv_ros.types.validation import is_finite_number, shown_number

__all__ = [
    "Entry",
    "Faults",
    "at_most_one",
    "away_from_position",
    "below",
    "carriers_exist",
    "distinct",
    "distinct_values",
    "few_samples",
    "listed",
    "named_objects",
    "movers_exist",
    "not_unlabelled",
    "only_beside",
    "parents_exist",
    "spans_ascend",
    "static_never_moves",
    "turned_where_placed",
    "unit_quaternion",
    "walls_need_a_room",
    "within_half",
    "without_zero_length",
]

Faults: TypeAlias = Iterator[tuple[tuple[str | int, ...], str]]
Entry: TypeAlias = Mapping[str, Any]

_UNIT_TOLERANCE = 1e-3


def at_most_one(*keys: str) -> Rule:
    """Make the rule that only one of these keys is given."""

    def rule(entry: Entry) -> Faults:
        given = [key for key in keys if entry.get(key) is not None]
        for key in given[1:]:
            yield (key,), f"cannot stand beside {given[0]}; give one of: {', '.join(keys)}"

    return rule


def below(lower: str, upper: str, defaults: Mapping[str, float], *, equal: bool = False) -> Rule:
    """Make the rule that one number is less than another (or equal)."""

    def rule(entry: Entry) -> Faults:
        low, high = (entry.get(key, defaults[key]) for key in (lower, upper))
        if not (is_finite_number(low) and is_finite_number(high)):
            return
        if low > high or (low == high and not equal):
            accepted = "at most" if equal else "less than"
            place = lower if lower in entry else upper
            yield (
                (place,),
                f"is refused: {lower} must be {accepted} {upper}, "
                f"got {shown_number(low)} and {shown_number(high)}",
            )

    return rule


def few_samples(most: int, defaults: Mapping[str, int]) -> Rule:
    """Make the rule that no side of a picture has more samples than this."""

    def rule(entry: Entry) -> Faults:
        picture = entry.get("picture")
        times = picture.get("supersampling", 1) if isinstance(picture, Mapping) else 1
        if LIMITS["supersampling"].refused(times):
            return
        for key in ("width", "height"):
            size = entry.get(key, defaults[key])
            if is_finite_number(size) and size <= most < times * size:
                yield (
                    ("picture", "supersampling"),
                    f"is refused: it must be at most {most // int(size)} with a {key} of "
                    f"{shown_number(size)} px, got {shown_number(times)}",
                )
                return

    return rule


def within_half(key: str, size_key: str, default: int) -> Rule:
    """Make the rule that a number is at most half of a size, to both sides."""

    def rule(entry: Entry) -> Faults:
        offset, size = entry.get(key, 0.0), entry.get(size_key, default)
        if not (is_finite_number(offset) and is_finite_number(size)):
            return
        if abs(offset) > 0.5 * size:
            yield (
                (key,),
                f"is refused: it must be within half of {size_key}, {shown_number(0.5 * size)}, "
                f"got {shown_number(offset)}",
            )

    return rule


def only_beside(key: str, *others: str) -> Rule:
    """Make the rule that some keys are given only where another one is."""

    def rule(entry: Entry) -> Faults:
        if entry.get(key) is None:
            for other in others:
                if entry.get(other) is not None:
                    yield (other,), f"means something only beside {key}"

    return rule


def spans_ascend(entry: Entry) -> Faults:
    """Refuse spans whose first number is the larger one."""
    for key, value in entry.items():
        if (
            isinstance(value, list | tuple)
            and len(value) == 2
            and all(isinstance(part, int | float) for part in value)
            and value[0] > value[1]
        ):
            yield (key,), f"must be [least, most], got [{value[0]}, {value[1]}]"


def carriers_exist(scene: Entry) -> Faults:
    """Refuse objects upon what is not there, or that carry themselves, be it through others."""
    objects = [entry for entry in listed(scene, "objects") if isinstance(entry, Mapping)]
    named = [entry for entry in objects if isinstance(entry.get("name"), str)]
    carrier = {entry["name"]: entry.get("on") for entry in named}
    for index, entry in enumerate(listed(scene, "objects")):
        on = entry.get("on") if isinstance(entry, Mapping) else None
        if not isinstance(on, str):
            continue
        if on not in carrier:
            known = suggestion(on, [str(name) for name in carrier], listing="its objects")
            yield ("objects", index, "on"), f"the scene has no object {on!r}; {known}"
            continue
        name = entry.get("name")
        seen = {name} if isinstance(name, str) else set()
        while isinstance(on, str) and on not in seen:
            seen.add(on)
            on = carrier.get(on)
        if on == name:
            yield ("objects", index, "on"), "must not be an object that this one carries"


def not_unlabelled(category: Entry) -> Faults:
    """Refuse the id of what has no category."""
    if category.get("id") == UNLABELLED_CATEGORY:
        yield ("id",), f"must not be {UNLABELLED_CATEGORY}, which stands for what has no category"


def parents_exist(scene: Entry) -> Faults:
    """Refuse parts of what is not there, or of themselves."""
    names = named_objects(scene)
    for index, entry in enumerate(listed(scene, "objects")):
        parent = entry.get("part_of") if isinstance(entry, Mapping) else None
        if not isinstance(parent, str):
            continue
        if parent not in names:
            known = suggestion(parent, names, listing="its objects")
            yield ("objects", index, "part_of"), f"the scene has no object {parent!r}; {known}"
        elif parent == entry.get("name"):
            yield ("objects", index, "part_of"), "must be another object than this one"


def walls_need_a_room(scene: Entry) -> Faults:
    """Refuse objects at a wall where there is no room."""
    if scene.get("room") is not None:
        return
    for index, entry in enumerate(listed(scene, "objects")):
        if isinstance(entry, Mapping) and entry.get("wall") is not None:
            yield ("objects", index, "wall"), "needs a room; the scene has none"


def unit_quaternion(entry: Entry) -> Faults:
    """Refuse a quaternion whose length is not 1 within 1e-3."""
    numbers = _numbers(entry.get("orientation"), 4)
    if numbers is None:
        return
    length = math.hypot(*numbers)
    if abs(length - 1.0) > _UNIT_TOLERANCE:
        yield (
            ("orientation",),
            f"must be a quaternion [x, y, z, w] of unit length, got {shown(numbers)} "
            f"of length {shown_number(length)}",
        )


def without_zero_length(entry: Entry) -> Faults:
    """Refuse a direction without a length."""
    numbers = _numbers(entry.get("direction"), 3)
    if numbers is not None and math.hypot(*numbers) < 1e-9:
        yield ("direction",), "must be three numbers [x, y, z], not all 0"


def static_never_moves(entry: Entry) -> Faults:
    """Refuse behaviours and velocities of a static object."""
    if entry.get("static") is not True:
        return
    for key in ("behaviours", "velocity", "angular_velocity"):
        given = entry.get(key)
        if isinstance(given, Sequence) and any(given):
            yield (
                (key,),
                "cannot be given to an object that never moves; "
                f"leave {key} out, or static: true out",
            )


def away_from_position(entry: Entry) -> Faults:
    """Refuse to face the point where one is."""
    eye, target = _numbers(entry.get("position"), 3), _numbers(entry.get("look_at"), 3)
    if eye is not None and target is not None and math.dist(eye, target) < 1e-6:
        yield ("look_at",), f"must be a point away from position, got {shown(target)}"


def turned_where_placed(entry: Entry) -> Faults:
    """Refuse a turn without a place: it would be lost."""
    if entry.get("position") is None:
        for key in ("rotation", "orientation"):
            if entry.get(key) is not None:
                yield (key,), "needs a position beside it"


def distinct(key: str, *lists: str) -> Rule:
    """Make the rule that in each of these lists no two entries have the same value of `key`."""

    def rule(entry: Entry) -> Faults:
        for name in lists:
            entries = [e if isinstance(e, Mapping) else {} for e in listed(entry, name)]
            for index, earlier in _repeated([e.get(key) for e in entries]):
                value = shown(entries[index][key])
                yield (
                    (name, index, key),
                    f"must be unique among {name}, but {name}[{earlier}] has {value} too",
                )

    return rule


def distinct_values(key: str) -> Rule:
    """Make the rule that a list names nothing twice."""

    def rule(entry: Entry) -> Faults:
        values = listed(entry, key)
        for index, _ in _repeated(values):
            yield (key, index), f"names {shown(values[index])} a second time"

    return rule


def movers_exist(scene: Entry) -> Faults:
    """Refuse an agent that follows a mover which the scene lacks."""
    single = scene.get("mover")
    movers = [single] if isinstance(single, Mapping) else listed(scene, "movers")
    names = [m.get("name", "mover") for m in movers if isinstance(m, Mapping)] or ["mover"]
    for index, agent in enumerate(listed(scene, "agents")):
        mover = agent.get("mover") if isinstance(agent, Mapping) else None
        if isinstance(mover, str) and mover not in names:
            known = suggestion(mover, [str(name) for name in names], listing="its movers")
            yield ("agents", index, "mover"), f"the scene has no mover {mover!r}; {known}"


def named_objects(scene: Entry) -> list[str]:
    """Return the names of a scene's objects."""
    objects = [entry for entry in listed(scene, "objects") if isinstance(entry, Mapping)]
    return [entry["name"] for entry in objects if isinstance(entry.get("name"), str)]


def listed(entry: Entry, key: str) -> Sequence[Any]:
    """Return a list of an entry; an empty one for what is none."""
    values = entry.get(key)
    return values if isinstance(values, list | tuple) else ()


def _repeated(values: Sequence[Any]) -> Iterator[tuple[int, int]]:
    """Yield the index of each repeated text or number, and the index of its first occurrence."""
    first: dict[Any, int] = {}
    for index, value in enumerate(values):
        if isinstance(value, str | int) and first.setdefault(value, index) != index:
            yield index, first[value]


def _numbers(values: Any, count: int) -> list[float] | None:
    """Return the numbers of a list of so many; ``None`` if it is anything else."""
    if not isinstance(values, list | tuple) or len(values) != count:
        return None
    return list(values) if all(is_finite_number(value) for value in values) else None
