"""Durations of the motion of objects, computed from the descriptions in a scene file.

Plain data of behaviours and lessons in, seconds and faults out; starts nothing.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import ValidationError

from sailenv_ros.behaviours.registry import behaviour_kinds
from sailenv_ros.scene.rules import listed
from sailenv_ros.types.validation import is_finite_number

__all__ = ["lesson_errors", "moving_time_s", "presence_s"]


def moving_time_s(behaviours: object) -> float | None:
    """Return how long an object moves from its appearance on [s].

    Parameters
    ----------
    behaviours : object
        A list of mappings as a scene file has them; what is wrong in it counts for nothing, as
        its check tells.

    Returns
    -------
    time_s : float or None
        0 for what does not move; None without end.
    """
    longest = 0.0
    for behaviour in behaviours if isinstance(behaviours, list | tuple) else ():
        if not isinstance(behaviour, Mapping):
            continue
        kind = behaviour_kinds().get(str(behaviour.get("type")))
        if kind is None:
            if ":" in str(behaviour.get("type")):
                return None  # one of a user's: nobody knows
            continue
        try:
            parameters = kind.parameters.model_validate(
                {key: value for key, value in behaviour.items() if key != "type"}
            )
        except ValidationError:
            continue
        if parameters.duration_s is None:
            return None
        longest = max(longest, parameters.start + parameters.duration_s)
    return longest


def lesson_errors(scene: Mapping[str, Any]) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Yield which lessons of a scene have no end, or no time: places and sentences.

    Parameters
    ----------
    scene : mapping
        Plain data of a scene file; nothing in it is certain.
    """
    lessons = scene.get("lessons")
    if not isinstance(lessons, Mapping):
        return
    sequence = listed(lessons, "sequence")
    objects = {
        str(entry.get("name")): entry
        for entry in listed(scene, "objects")
        if isinstance(entry, Mapping)
    }
    # The one lesson that may go on for ever is the very last.
    goes_on = (
        lessons.get("after") == "go_on" and lessons.get("laps") == 1 and not lessons.get("shuffled")
    )
    for number, lesson in enumerate(sequence):
        if not isinstance(lesson, Mapping) or lesson.get("duration") is not None:
            continue
        scheduled_objects = [str(name) for name in listed(lesson, "objects")]
        if not scheduled_objects or any(name not in objects for name in scheduled_objects):
            continue
        times = {name: presence_s(objects[name]) for name in scheduled_objects}
        endless = next((name for name, time_s in times.items() if time_s is None), None)
        place = ("lessons", "sequence", number)
        if endless is not None and not (goes_on and number == len(sequence) - 1):
            yield place, f"has no end, as {endless!r} moves without end; give it a duration"
        elif endless is None and not any(times.values()):
            yield place, "takes no time, as its objects do not move; give it a duration"


def presence_s(entry: Mapping[str, Any]) -> float | None:
    """Return how long a lesson takes because of an object [s]; 0 and None as `moving_time_s`."""
    appear, leave = entry.get("appear", 0.0), entry.get("leave")
    if is_finite_number(leave):
        return float(leave)
    moving = moving_time_s(entry.get("behaviours"))
    if not moving:
        return moving
    return moving + (float(appear) if is_finite_number(appear) else 0.0)
