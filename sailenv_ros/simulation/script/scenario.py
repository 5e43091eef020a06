"""Scenarios as SAILenv writes them, turned into objects as scene files have them.

A mapping (of JSON or YAML) in, entries for a scene's `objects` out. Which assets there are and
whether an entry is right is checked where the scene is built.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sailenv_ros.behaviours.durations import moving_time_s
from sailenv_ros.errors import InvalidEntry, InvalidRequest, UnknownName
from sailenv_ros.scene.entries import plain_value, read_document
from sailenv_ros.types.validation import checked_flag, checked_number

__all__ = [
    "NOTHING_MORE",
    "SCENARIO_KEYS",
    "SceneOverlay",
    "scenario_additions",
    "scenario_entries",
    "wanted_scenario",
]

SCENARIO_KEYS = ("scene", "scene_name", "objects", "timings", "frustum", "lessons")

TIMINGS = ("all_together", "wait_until_complete", "dict")

BOUNCE = "uniform_movement_random_bounce"
"""The one dynamic that can be kept within a view; the others go where they are told."""

_VECTORS = ("position", "rotation", "scale", "start_direction")

Entry = dict[str, Any]


@dataclass(frozen=True, slots=True)
class SceneOverlay:
    """SceneOverlay to a scene: more objects, and other lessons.

    Attributes
    ----------
    objects : sequence of mapping
        As a scene file describes them.
    lessons : mapping or None
        Instead of those of the scene; as a scene file describes them.
    """

    objects: Sequence[Mapping[str, Any]] = ()
    lessons: Mapping[str, Any] | None = None


NOTHING_MORE = SceneOverlay()


def wanted_scenario(
    scenario: str | Mapping[str, Any], *, present: str, viewer: str
) -> tuple[str, SceneOverlay]:
    """Return the scene that a scenario is played in, and what it adds to that.

    Parameters
    ----------
    scenario : mapping or str
        Or its text; a text that is only a name is that of the scene.
    present : str
        The scene where it names none.
    viewer : str
        See `scenario_entries`.
    """
    wanted = read_document(scenario) if isinstance(scenario, str) else scenario
    if isinstance(wanted, str):
        wanted = {"scene": wanted}
    if not isinstance(wanted, Mapping):
        raise InvalidRequest("scenario", wanted, "a mapping with scene, objects, timings")
    names = [wanted[key] for key in ("scene", "scene_name") if key in wanted]
    scene = names[0] if names else present
    if not isinstance(scene, str) or len(names) > 1:
        raise InvalidRequest("scene", names, "the name of a scene")
    return scene, scenario_additions(wanted, viewer=viewer)


def scenario_additions(scenario: Mapping[str, Any], *, viewer: str) -> SceneOverlay:
    """Return the objects and the lessons of a scenario; see `scenario_entries`."""
    lessons = plain_value(scenario.get("lessons"))
    if lessons is not None and scenario.get("timings") is not None:
        accepted = "left out where there are lessons, which say when objects come"
        raise InvalidRequest("timings", scenario["timings"], accepted)
    return SceneOverlay(scenario_entries(scenario, viewer=viewer), lessons)


def scenario_entries(scenario: Mapping[str, Any], *, viewer: str) -> list[Entry]:
    """Return the objects of a scenario in their order.

    Parameters
    ----------
    scenario : mapping
        With the keys `SCENARIO_KEYS`. Objects have the keys of a scene file; ``prefab`` stands for
        ``asset``, ``id`` for ``name``, ``dynamic`` (type, description) for one behaviour without
        gravity, ``{x, y, z}`` for a list of three.
    viewer : str
        Name of the agent in whose view objects with ``frustum_limited`` are kept.

    Raises
    ------
    UnknownName, InvalidRequest
        If something is not as it is described here.
    """
    for key in scenario:
        if key not in SCENARIO_KEYS:
            raise UnknownName("key of a scenario", str(key), SCENARIO_KEYS)
    objects = plain_value(scenario.get("objects", []))
    if not isinstance(objects, list):
        raise InvalidRequest("objects", objects, "a list of objects")
    frustum = _frustum(scenario.get("frustum"), viewer)
    entries = [_entry(number, entry, frustum) for number, entry in enumerate(objects)]
    for entry, start_s in zip(entries, _starts(scenario.get("timings"), entries), strict=True):
        if start_s:
            _delay(entry, start_s)
    return entries


def _entry(number: int, given: object, frustum: Mapping[str, Any]) -> Entry:
    what = f"objects[{number}]"
    if not isinstance(given, dict):
        raise InvalidEntry(
            "objects", [given], [(f"[{number}]", f"must be a mapping, got {given!r}")]
        )
    entry: Entry = _listed(given)
    _rename(what, entry, "prefab", "asset")
    _rename(what, entry, "id", "name")
    if isinstance(entry.get("name"), int):
        entry["name"] = str(entry["name"])
    limited = checked_flag(f"{what}.frustum_limited", entry.pop("frustum_limited", False))
    dynamic = entry.pop("dynamic", None)
    if dynamic is not None:
        behaviours = entry.get("behaviours") or []
        entry["behaviours"] = [*behaviours, _behaviour(f"{what}.dynamic", dynamic)]
        entry.setdefault("gravity", False)
    if limited and frustum:
        _keep_in_view(what, entry, frustum)
    return entry


def _rename(what: str, entry: Entry, old: str, new: str) -> None:
    if old in entry and new in entry:
        raise InvalidRequest(f"{what}.{old}", entry[old], f"left out where there is {new!r}")
    if old in entry:
        entry[new] = entry.pop(old)


def _behaviour(what: str, dynamic: object) -> Entry:
    if not isinstance(dynamic, dict) or not set(dynamic) <= {"type", "description"}:
        raise InvalidRequest(what, dynamic, "a mapping with type and description")
    description = dynamic.get("description") or {}
    if not isinstance(description, dict) or "type" in description:
        raise InvalidRequest(f"{what}.description", description, "a mapping of parameters")
    return {"type": dynamic.get("type"), **description}


def _keep_in_view(what: str, entry: Entry, frustum: Mapping[str, Any]) -> None:
    bounces = [
        behaviour
        for behaviour in entry.get("behaviours") or []
        if isinstance(behaviour, dict) and behaviour.get("type") == BOUNCE
    ]
    if not bounces:
        accepted = f"false for what does not move by {BOUNCE}"
        raise InvalidRequest(f"{what}.frustum_limited", True, accepted)
    for behaviour in bounces:
        behaviour.update(frustum)


def _frustum(given: object, viewer: str) -> dict[str, Any]:
    """Return the parameters that keep an object in view; none where no frustum is asked for."""
    frustum = {"spawn": True} if given is None else given
    if not isinstance(frustum, Mapping) or not set(frustum) <= {"spawn", "far_clip_plane"}:
        raise InvalidRequest("frustum", given, "a mapping with spawn and far_clip_plane")
    if not checked_flag("frustum.spawn", frustum.get("spawn", True)):
        return {}
    distance = checked_number(
        "frustum.far_clip_plane", frustum.get("far_clip_plane", 10.0), 0.0, 1e6
    )
    if not distance:
        raise InvalidRequest("frustum.far_clip_plane", distance, "a number above 0 [m]")
    return {"keep_in_view": viewer, "view_distance": distance}


def _starts(given: object, entries: list[Entry]) -> list[float]:
    """Return when each object begins to move [s]."""
    timings = {"type": "all_together"} if given is None else given
    if not isinstance(timings, Mapping) or not set(timings) <= {"type", "description"}:
        raise InvalidRequest("timings", given, "a mapping with type and description")
    type_ = timings.get("type")
    if type_ not in TIMINGS:
        raise UnknownName("timings.type", str(type_), TIMINGS)
    wanted = timings.get("description") or {}
    key = "times" if type_ == "dict" else "wait_time"
    if not isinstance(wanted, Mapping) or not set(wanted) <= {key}:
        raise InvalidRequest("timings.description", wanted, f"a mapping with {key}")
    if type_ == "dict":
        return _given_times(wanted.get("times", {}), len(entries))
    wait_s = checked_number("timings.description.wait_time", wanted.get("wait_time", 0.0), 0.0, 1e6)
    if type_ == "all_together":
        return [wait_s] * len(entries)
    return _one_after_another(entries, wait_s)


def _given_times(times: object, count: int) -> list[float]:
    if not isinstance(times, Mapping):
        raise InvalidRequest("timings.description.times", times, "a mapping of index to seconds")
    starts = [0.0] * count
    for index, seconds in times.items():
        # JSON's keys are texts.
        number = int(index) if str(index).isdecimal() else -1
        if not 0 <= number < count:
            accepted = f"the index of an object, 0 to {count - 1}"
            raise InvalidRequest("key of timings.description.times", index, accepted)
        starts[number] = checked_number(f"timings.description.times[{index}]", seconds, 0.0, 1e6)
    return starts


def _one_after_another(entries: list[Entry], wait_s: float) -> list[float]:
    """Let each begin a while after the one before has come to the end of its track."""
    starts, next_s = [], 0.0
    for number, entry in enumerate(entries):
        starts.append(next_s)
        duration_s = moving_time_s(entry.get("behaviours"))
        if duration_s is None:
            if number < len(entries) - 1:
                accepted = "all_together or dict where an object but the last moves without end"
                raise InvalidRequest("timings.type", "wait_until_complete", accepted)
            break
        next_s += duration_s + wait_s
    return starts


def _delay(entry: Entry, start_s: float) -> None:
    for behaviour in entry.get("behaviours") or []:
        if isinstance(behaviour, dict) and isinstance(behaviour.get("start", 0.0), int | float):
            behaviour["start"] = behaviour.get("start", 0.0) + start_s


def _listed(value: Any, key: str = "") -> Any:
    """Turn each ``{x, y, z}`` of a vector into a list of three; what is left out is 0."""
    if isinstance(value, dict):
        if key in _VECTORS and value and set(value) <= {"x", "y", "z"}:
            return [value.get(axis, 0.0) for axis in "xyz"]
        return {name: _listed(part, name) for name, part in value.items()}
    if isinstance(value, list):
        return [_listed(part) for part in value]
    return value
