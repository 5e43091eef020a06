"""Scenarios and dynamics as clients write them, in JSON and Unity's axes, turned into ours.

JSON text in, what `load_scenario` and `spawn_object` take out. Which dynamics there are is known
elsewhere; here only their vectors are turned.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.gateway.unity import pose_from_unity, vector_from_unity
from sailenv_ros.types.validation import is_number

__all__ = ["behaviours_of_dynamic", "entries_of_scenario", "mapping_of_json"]

BOUNCING = "uniform_movement_random_bounce"

_DIRECTIONS = ("start_direction",)
_ENTRY_KEYS = ("id", "prefab", "position", "rotation", "dynamic", "frustum_limited")


def mapping_of_json(what: str, text: str) -> dict[str, Any]:
    """Read a JSON object.

    Raises
    ------
    InvalidRequest
        If it is none.
    """
    try:
        value = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InvalidRequest(what, text, f"JSON ({error})") from None
    if not isinstance(value, dict):
        raise InvalidRequest(what, value, "a JSON object")
    return value


def behaviours_of_dynamic(
    type_: str, description: object, *, keep_in_view: str = ""
) -> list[dict[str, Any]]:
    """Return a dynamic as a list of behaviours: of one, or empty where there is none.

    Parameters
    ----------
    type_ : str
    description : object
        Its parameters, as JSON has them.
    keep_in_view : str
        The agent whose view is not to be left by what bounces; empty for none.
    """
    if not type_:
        return []
    if not isinstance(description, Mapping):
        raise InvalidRequest(f"description of the dynamic {type_!r}", description, "a JSON object")
    given = {str(key): _turned(key, value) for key, value in description.items()}
    if keep_in_view and type_ == BOUNCING:
        given["keep_in_view"] = keep_in_view
    return [{"type": type_, **given}]


def entries_of_scenario(scenario: Mapping[str, Any], agent: str) -> list[dict[str, Any]]:
    """Return a scenario's objects as a scene file describes them, in their order.

    Parameters
    ----------
    scenario : mapping
        As JSON has it.
    agent : str
        Whose view the objects stay in that are ``frustum_limited``.

    Raises
    ------
    InvalidRequest
        If an object is malformed. The timings are checked where they are taken.
    """
    objects = scenario.get("objects", [])
    if not isinstance(objects, list):
        raise InvalidRequest("objects of the scenario", objects, "a list")
    return [_entry(number, entry, agent) for number, entry in enumerate(objects)]


def _entry(number: int, entry: object, agent: str) -> dict[str, Any]:
    what = f"object {number} of the scenario"
    if not isinstance(entry, Mapping) or not isinstance(entry.get("prefab"), str):
        raise InvalidRequest(what, entry, f"a JSON object with prefab and of {_ENTRY_KEYS}")
    for key in entry:
        if key not in _ENTRY_KEYS:
            raise InvalidRequest(f"key of {what}", key, f"one of {_ENTRY_KEYS}")
    position = _xyz(f"position of {what}", entry.get("position", {}))
    pose = pose_from_unity(position, _xyz(f"rotation of {what}", entry.get("rotation", {})))
    dynamic = entry.get("dynamic") or {}
    if not isinstance(dynamic, Mapping):
        raise InvalidRequest(f"dynamic of {what}", dynamic, "a JSON object with type, description")
    behaviours = behaviours_of_dynamic(
        str(dynamic.get("type") or ""),
        dynamic.get("description") or {},
        keep_in_view=agent if entry.get("frustum_limited") else "",
    )
    return {
        "asset": entry["prefab"],
        "position": list(pose.position_m),
        "orientation": list(pose.orientation_xyzw),
        "static": not behaviours,
        **({"gravity": False, "behaviours": behaviours} if behaviours else {}),
    }


def _turned(key: object, value: Any) -> Any:
    """Turn the vectors of a dynamic's description into our axes; leave all else."""
    if key in _DIRECTIONS:
        return list(vector_from_unity(str(key), _xyz(str(key), value)))
    if key == "waypoints" and isinstance(value, list):
        return [_waypoint(number, waypoint) for number, waypoint in enumerate(value)]
    return value


def _waypoint(number: int, waypoint: object) -> dict[str, Any]:
    what = f"waypoint {number}"
    if not isinstance(waypoint, Mapping):
        raise InvalidRequest(what, waypoint, "a JSON object with position and rotation")
    pose = pose_from_unity(
        _xyz(f"position of {what}", waypoint.get("position", {})),
        _xyz(f"rotation of {what}", waypoint.get("rotation", {})),
    )
    return {"position": list(pose.position_m), "rotation": list(pose.rpy_deg)}


def _xyz(what: str, value: object) -> tuple[float, float, float]:
    """Read ``{x, y, z}``, of which those left out are 0, or a list of three."""
    accepted = "three numbers x, y, z"
    if isinstance(value, Mapping):
        if not set(value) <= {"x", "y", "z"}:
            raise InvalidRequest(what, value, accepted)
        value = [value.get(axis, 0.0) for axis in ("x", "y", "z")]
    if not isinstance(value, list) or len(value) != 3:
        raise InvalidRequest(what, value, accepted)
    if not all(map(is_number, value)):
        raise InvalidRequest(what, value, accepted)
    try:
        return float(value[0]), float(value[1]), float(value[2])
    except OverflowError:
        raise InvalidRequest(what, value, accepted) from None
