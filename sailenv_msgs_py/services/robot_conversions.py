"""Services of robots whose messages' fields are not simply the operation's arguments.

``write_…`` makes fields of a request of the arguments, ``read_…`` arguments of the fields.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from sailenv_msgs_py.object_msgs import keys_to_json
from sailenv_msgs_py.services.service import Arguments
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.simulation.operations.argument_checks import pose_of
from sailenv_ros.types.scene_info import SceneInfo


def write_spawned(given: Arguments) -> Arguments:
    settings = given["settings"]
    return {
        **given,
        "pose": pose_of(given["position"], given["rotation"], given["pose"]),
        "settings": "" if settings is None else keys_to_json("settings", settings),
    }


def read_spawned(given: Arguments) -> Arguments:
    names = ("file", "name", "mount", "pose")
    return {**{name: given[name] for name in names}, "settings": _object(given["settings"])}


def fill_spawned(response: Any, name: str, info: SceneInfo) -> None:
    response.spawned_name = name


def write_named(given: Arguments, values: str) -> Arguments:
    """Write a mapping of joints to numbers as names and numbers."""
    named: Mapping[str, float] = given[values]
    return {**given, "names": list(named), values: list(named.values())}


def read_named(given: Arguments, values: str) -> Arguments:
    """Read names and numbers as a mapping of joints to numbers."""
    rest = {key: value for key, value in given.items() if key != "names"}
    return {**rest, values: _mapping(given["names"], given[values])}


def write_targets(given: Arguments) -> Arguments:
    return write_named(given, "targets")


def read_targets(given: Arguments) -> Arguments:
    found = read_named(given, "targets")
    # A message that says nothing of these holds 0.
    return {**found, **{key: found[key] or None for key in ("gain", "effort", "speed")}}


def write_command(given: Arguments) -> Arguments:
    linear = given["forward_m_s"], given["left_m_s"], 0.0
    return {**given, "command": (linear, (0.0, 0.0, given["turn_rad_s"]))}


def read_command(given: Arguments) -> Arguments:
    (forward, left, _), (_, _, turn) = given["command"]
    return {
        "robot": given["robot"],
        "forward_m_s": forward,
        "left_m_s": left,
        "turn_rad_s": turn,
        "seconds": given["seconds"],
    }


def write_elsewhere(given: Arguments) -> Arguments:
    return write_named({**given, "positions": given["joints"] or {}}, "positions")


def read_elsewhere(given: Arguments) -> Arguments:
    joints = _mapping(given["names"], given["positions"])
    return {"robot": given["robot"], "link": given["link"], "joints": joints or None}


def _mapping(names: Sequence[str], numbers: Sequence[float]) -> dict[str, float]:
    if len(names) != len(numbers) or len(set(names)) < len(names):
        accepted = "different names, and as many numbers as there are names"
        raise InvalidRequest("joints", list(names), accepted)
    return dict(zip(names, map(float, numbers), strict=True))


def _object(text: str) -> dict[str, Any] | None:
    if not text:
        return None
    try:
        value = json.loads(text)
    except ValueError:
        value = None
    if not isinstance(value, dict):
        raise InvalidRequest("settings", text[:80], "the text of a JSON object")
    return value
