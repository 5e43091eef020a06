"""Objects and behaviours to and from their messages."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from geometry_msgs.msg import Twist

import sailenv_msgs.msg as msgs
from sailenv_msgs.srv import GetObject
from sailenv_msgs_py.frame_info import WORLD_FRAME_ID
from sailenv_msgs_py.scene_msgs import instance_to_msg
from sailenv_msgs_py.stamps import ns_from_stamp, stamp_from_ns
from sailenv_msgs_py.transforms import (
    pose_from_msg,
    pose_stamped_to_msg,
    vector_to_msg,
    xyz_from_msg,
)
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.labels import Instance
from sailenv_ros.types.objects import ObjectState

__all__ = [
    "behaviour_from_msg",
    "behaviour_to_msg",
    "keys_from_json",
    "keys_to_json",
    "object_state_from_response",
    "object_state_to_response",
    "to_json",
]


def behaviour_to_msg(behaviour: Mapping[str, Any]) -> msgs.Behaviour:
    """Make the message of a behaviour, which is its ``type`` and its parameters.

    Raises
    ------
    InvalidRequest
        If it is no such mapping.
    """
    if not isinstance(behaviour, Mapping) or not isinstance(behaviour.get("type"), str):
        raise InvalidRequest("behaviour", behaviour, "a mapping with its type and parameters")
    parameters = {key: value for key, value in behaviour.items() if key != "type"}
    text = keys_to_json("parameters of a behaviour", parameters) if parameters else ""
    return msgs.Behaviour(type=behaviour["type"], parameters_json=text)


def behaviour_from_msg(msg: msgs.Behaviour) -> dict[str, Any]:
    """Read a behaviour as a scene file would write it.

    Raises
    ------
    InvalidRequest
        If its parameters are no JSON object.
    """
    accepted = 'a JSON object such as {"angular_velocity": [0, 0, 45]}'
    parameters = keys_from_json("parameters_json", msg.parameters_json, accepted)
    if "type" in parameters:
        raise InvalidRequest("parameters_json", msg.parameters_json, accepted)
    return {"type": msg.type, **parameters}


def keys_to_json(what: str, keys: Mapping[str, Any]) -> str:
    """Write keys of a scene file with their values as a JSON object.

    Raises
    ------
    InvalidRequest
        If a value is nothing that JSON has.
    """
    return to_json(what, dict(keys))


def to_json(what: str, value: Any) -> str:
    """Write plain data as JSON; see `keys_to_json`."""
    try:
        return json.dumps(value, default=_as_list)
    except (TypeError, ValueError, RecursionError):
        accepted = "of numbers, texts, truth values and lists of them"
        raise InvalidRequest(what, value, accepted) from None


def keys_from_json(what: str, text: str, accepted: str) -> dict[str, Any]:
    """Read what `keys_to_json` wrote; an empty text is an empty object.

    Raises
    ------
    InvalidRequest
        If it is no JSON object; `accepted` says what would be.
    """
    try:
        keys = json.loads(text or "{}")
    except (ValueError, RecursionError):
        keys = None
    if not isinstance(keys, dict):
        raise InvalidRequest(what, text, accepted)
    return keys


def object_state_to_response(state: ObjectState, response: GetObject.Response) -> None:
    """Fill the answer of `get_object`."""
    instance = Instance(
        id=state.id,
        name=state.name,
        asset=state.asset,
        category_id=state.category_id,
        category=state.category,
        static=state.static,
    )
    response.instance = instance_to_msg(instance, moving=bool(state.behaviours))
    stamp = stamp_from_ns(state.sim_time_ns)
    response.pose = pose_stamped_to_msg(state.pose, stamp, WORLD_FRAME_ID)
    response.twist = Twist(
        linear=vector_to_msg(state.linear_velocity), angular=vector_to_msg(state.angular_velocity)
    )
    response.scale = vector_to_msg(state.scale)
    response.size = vector_to_msg(state.size_m)
    response.mass_kg = state.mass_kg
    response.bottom_m = float(state.bottom_m)
    response.behaviours = [behaviour_to_msg(behaviour) for behaviour in state.behaviours]


def object_state_from_response(response: GetObject.Response) -> ObjectState:
    """Read the answer of `get_object`."""
    instance = response.instance
    return ObjectState(
        id=instance.id,
        name=instance.name,
        asset=instance.asset,
        category_id=instance.category_id,
        category=instance.category,
        pose=pose_from_msg(response.pose.pose),
        scale=xyz_from_msg(response.scale),
        size_m=xyz_from_msg(response.size),
        static=instance.is_static,
        mass_kg=response.mass_kg,
        bottom_m=response.bottom_m,
        linear_velocity=xyz_from_msg(response.twist.linear),
        angular_velocity=xyz_from_msg(response.twist.angular),
        behaviours=tuple(behaviour_from_msg(behaviour) for behaviour in response.behaviours),
        sim_time_ns=ns_from_stamp(response.pose.header.stamp),
    )


def _as_list(value: Any) -> Any:
    """Return JSON NumPy's arrays and numbers as lists and numbers."""
    as_python = getattr(value, "tolist", None)
    if not callable(as_python):
        raise TypeError(type(value).__name__)
    return as_python()
