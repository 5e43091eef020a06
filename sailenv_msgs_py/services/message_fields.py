"""Fields of services' messages to and from the arguments and results of operations.

A field is converted by its ROS type, so that a service's messages need no code of their own as
long as their fields have the names of the operation's arguments.
"""

from __future__ import annotations

import array
from collections.abc import Callable, Mapping
from typing import Any

from sailenv_msgs_py.agent_msgs import agent_spec_from_msg, agent_spec_to_msg
from sailenv_msgs_py.changes import changes_from_msg, changes_to_msg
from sailenv_msgs_py.mover_msgs import rigid_body_from_msg, rigid_body_to_msg
from sailenv_msgs_py.object_msgs import behaviour_from_msg, behaviour_to_msg
from sailenv_msgs_py.picture_msgs import picture_from_msg, picture_to_msg
from sailenv_msgs_py.scene_msgs import colour_to_msg, light_from_msg, light_to_msg, rgb_from_msg
from sailenv_msgs_py.stamps import ns_from_stamp, stamp_from_ns
from sailenv_msgs_py.transforms import (
    point_to_msg,
    pose_from_msg,
    pose_to_msg,
    twist_from_msg,
    twist_to_msg,
    vector_to_msg,
    xyz_from_msg,
)
from sailenv_ros.errors import InvalidRequest

__all__ = ["field_types", "read_fields", "refuse_nul", "write_field"]

RESPONSE_HEADER = ("success", "code", "message", "revision")
"""Fields that every response has."""

Convert = Callable[[Any], Any]


def _bytes_to_msg(data: bytes) -> array.array[int]:
    return array.array("B", data)


_CONVERTERS: Mapping[str, tuple[Convert, Convert]] = {
    "boolean": (bool, bool),
    "double": (float, float),
    "builtin_interfaces/Time": (stamp_from_ns, ns_from_stamp),
    "geometry_msgs/Point": (point_to_msg, xyz_from_msg),
    "geometry_msgs/Pose": (pose_to_msg, pose_from_msg),
    "geometry_msgs/Twist": (twist_to_msg, twist_from_msg),
    "geometry_msgs/Vector3": (vector_to_msg, xyz_from_msg),
    "std_msgs/ColorRGBA": (colour_to_msg, rgb_from_msg),
    "sailenv_msgs/AgentInfo": (agent_spec_to_msg, agent_spec_from_msg),
    "sailenv_msgs/Behaviour": (behaviour_to_msg, behaviour_from_msg),
    "sailenv_msgs/Light": (light_to_msg, light_from_msg),
    "sailenv_msgs/RigidBody": (rigid_body_to_msg, rigid_body_from_msg),
    "sailenv_msgs/PictureSettings": (picture_to_msg, picture_from_msg),
    "sequence<uint8>": (_bytes_to_msg, bytes),
    "sequence<rcl_interfaces/Parameter>": (changes_to_msg, changes_from_msg),
}
"""Converters to and from messages, by ROS type; other types are passed unchanged."""


def field_types(message_type: Any) -> dict[str, str]:
    """Return the ROS types of a request's or response's own fields by their names."""
    types: Mapping[str, str] = message_type.get_fields_and_field_types()
    return {name: type_ for name, type_ in types.items() if name not in RESPONSE_HEADER}


def write_field(message: Any, field: str, type_: str, value: Any) -> None:
    """Set a field of a message to a value of an operation."""
    setattr(message, field, _converter(type_, 0)(value))


def read_fields(message: Any, types: Mapping[str, str]) -> dict[str, Any]:
    """Return the values of fields of a message by their names.

    Raises
    ------
    InvalidRequest
        If a value cannot be what it is said to be, e.g. a quaternion of length 0.
    """
    return {name: _converter(type_, 1)(getattr(message, name)) for name, type_ in types.items()}


def refuse_nul(service: str, message: Any) -> None:
    """Refuse a text with a NUL in it: the messages' C code would cut it off there unseen.

    Raises
    ------
    InvalidRequest
    """
    for name, kind in message.get_fields_and_field_types().items():
        value = getattr(message, name)
        if "string" in kind:
            texts = [value] if isinstance(value, str) else value
            if any("\0" in text for text in texts):
                raise InvalidRequest(f"{name} of the request to {service}", value, "without a NUL")
        elif hasattr(value, "get_fields_and_field_types"):
            refuse_nul(service, value)
        elif isinstance(value, list):
            for part in value:
                if hasattr(part, "get_fields_and_field_types"):
                    refuse_nul(service, part)


def _converter(type_: str, direction: int) -> Convert:
    if type_ in _CONVERTERS:
        return _CONVERTERS[type_][direction]
    if type_.startswith("sequence<"):
        convert = _converter(type_.removeprefix("sequence<").removesuffix(">"), direction)
        return lambda values: [convert(value) for value in values]
    return _same


def _same(value: Any) -> Any:
    return value
