"""Rules between the keys of lessons and of objects that come and go."""

from __future__ import annotations

from collections.abc import Mapping

from sailenv_ros.scene.messages import shown, suggestion
from sailenv_ros.scene.rules import Entry, Faults, listed
from sailenv_ros.types.validation import is_finite_number

__all__ = [
    "after_needs_laps",
    "leaves_after_it_appears",
    "pupils_exist",
    "stays_its_lesson",
    "visitors_stand_alone",
]


def after_needs_laps(entry: Entry) -> Faults:
    """Refuse to say what comes after laps that have no end."""
    if entry.get("after") is not None and entry.get("laps") is None:
        yield ("after",), "means something only beside laps"


def leaves_after_it_appears(entry: Entry) -> Faults:
    """Refuse an object that leaves before it is there."""
    appear, leave = entry.get("appear", 0.0), entry.get("leave")
    if is_finite_number(appear) and is_finite_number(leave) and leave <= appear:
        yield ("leave",), f"must be later than appear, got {shown(leave)} and {shown(appear)}"


def pupils_exist(scene: Entry) -> Faults:
    """Refuse lessons of objects which the scene lacks."""
    names = [
        str(entry["name"])
        for entry in listed(scene, "objects")
        if isinstance(entry, Mapping) and isinstance(entry.get("name"), str)
    ]
    for place, name in _named(scene):
        if name not in names:
            known = suggestion(name, names, listing="its objects")
            yield place, f"the scene has no object {name!r}; {known}"


def stays_its_lesson(scene: Entry) -> Faults:
    """Refuse an object that would appear only when its lesson is over."""
    lessons = scene.get("lessons")
    sequence = listed(lessons, "sequence") if isinstance(lessons, Mapping) else ()
    appears = {
        entry["name"]: entry["appear"]
        for entry in listed(scene, "objects")
        if isinstance(entry, Mapping)
        and isinstance(entry.get("name"), str)
        and is_finite_number(entry.get("appear"))
    }
    for number, lesson in enumerate(sequence):
        duration = lesson.get("duration") if isinstance(lesson, Mapping) else None
        if not is_finite_number(duration):
            continue
        for index, name in enumerate(listed(lesson, "objects")):
            if isinstance(name, str) and appears.get(name, 0.0) >= duration:
                place = ("lessons", "sequence", number, "objects", index)
                yield (
                    place,
                    f"{name!r} appears {shown(appears[name])} s after its lesson has begun, which "
                    f"then is over; a lesson must be longer than that",
                )


def visitors_stand_alone(scene: Entry) -> Faults:
    """Refuse joints of and on what comes and goes."""
    objects = [entry for entry in listed(scene, "objects") if isinstance(entry, Mapping)]
    lessons = scene.get("lessons")
    lesson_objects = {name for _, name in _named(scene)} if isinstance(lessons, Mapping) else set()
    joints = [entry["joint"] for entry in objects if isinstance(entry.get("joint"), Mapping)]
    parents = {str(joint.get("parent")) for joint in joints}
    for number, entry in enumerate(objects):
        given = entry.get("name")
        name = given if isinstance(given, str) else ""
        comes = name in lesson_objects or entry.get("appear") or entry.get("leave") is not None
        if comes and (entry.get("joint") is not None or name in parents):
            yield (
                ("objects", number),
                f"{shown(given)} cannot come and go, as it is on a joint or carries what is on one",
            )


def _named(scene: Entry) -> list[tuple[tuple[str | int, ...], str]]:
    lessons = scene.get("lessons")
    sequence = listed(lessons, "sequence") if isinstance(lessons, Mapping) else ()
    return [
        (("lessons", "sequence", number, "objects", index), name)
        for number, lesson in enumerate(sequence)
        if isinstance(lesson, Mapping)
        for index, name in enumerate(listed(lesson, "objects"))
        if isinstance(name, str)
    ]
