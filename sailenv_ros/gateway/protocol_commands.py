"""Commands of clients: the byte, the name and the fields of each.

Tables alone; `codec` reads by them and `session` answers. Integers and floats are little-endian.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType
from typing import Literal, get_args

from sailenv_ros.errors import UnknownName

__all__ = ["HELLO", "CommandKind", "Field", "Protocol", "commands_of"]

Protocol = Literal["0.5", "0.6"]
"""Revision of the client: 0.5 is what PyPI has (0.5b0), 0.6 what came after it."""


class Field(Enum):
    """Encoding of a field."""

    BYTE = "1 byte"
    BOOL = "1 byte, 0 or 1"
    INT = "4 bytes, signed"
    FLOAT = "4 bytes, IEEE"
    VECTOR = "three floats"
    NAME = "int characters, then UTF-8: a short text"
    DOCUMENT = "the same, of more length: JSON"
    FILE = "int bytes, then as many"


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandKind:
    """One command.

    Attributes
    ----------
    name : str
        Also of the method that answers it.
    fields : tuple of (str, Field)
        What follows its byte, in order.
    extra : tuple of (str, Field)
        What follows those if the last of them, a BOOL, is true.
    """

    name: str
    fields: tuple[tuple[str, Field], ...] = ()
    extra: tuple[tuple[str, Field], ...] = ()


HELLO = CommandKind(
    name="register", fields=(("width", Field.INT), ("height", Field.INT), ("use_gzip", Field.BOOL))
)
"""First message of a connection; it has no byte of its own."""

_LIGHT = ("light", Field.NAME)
_RGB = (("red", Field.INT), ("green", Field.INT), ("blue", Field.INT))
_POSE = (("position", Field.VECTOR), ("rotation", Field.VECTOR))
_SPAWN = (
    ("name", Field.NAME),
    *_POSE,
    ("remove_dynamics", Field.BOOL),
    ("scale", Field.VECTOR),
    ("use_parent", Field.BOOL),
)

_BASE: Mapping[int, CommandKind] = {
    0x00: CommandKind(name="frame", fields=(("flags", Field.BYTE),)),
    0x01: CommandKind(name="delete"),
    0x02: CommandKind(name="change_scene", fields=(("name", Field.NAME),)),
    0x03: CommandKind(name="get_categories"),
    0x04: CommandKind(name="get_position"),
    0x05: CommandKind(name="set_position", fields=(("position", Field.VECTOR),)),
    0x06: CommandKind(name="get_rotation"),
    0x07: CommandKind(name="set_rotation", fields=(("rotation", Field.VECTOR),)),
    0x08: CommandKind(name="toggle_follow"),
    0x09: CommandKind(name="spawn_object", fields=_SPAWN),
    0x0A: CommandKind(name="despawn_object", fields=(("id", Field.INT),)),
    0x0B: CommandKind(name="get_spawnables"),
    0x0C: CommandKind(name="send_obj_zip", fields=(("filename", Field.NAME), ("data", Field.FILE))),
    0x0D: CommandKind(name="set_background", fields=_RGB),
    0x0E: CommandKind(name="get_light_colour", fields=(_LIGHT,)),
    0x0F: CommandKind(name="set_light_colour", fields=(_LIGHT, *_RGB)),
    0x10: CommandKind(name="get_light_intensity", fields=(_LIGHT,)),
    0x11: CommandKind(name="set_light_intensity", fields=(_LIGHT, ("value", Field.FLOAT))),
    0x12: CommandKind(name="get_light_indirect", fields=(_LIGHT,)),
    0x13: CommandKind(name="set_light_indirect", fields=(_LIGHT, ("value", Field.FLOAT))),
    0x14: CommandKind(name="get_light_position", fields=(_LIGHT,)),
    0x15: CommandKind(name="set_light_position", fields=(_LIGHT, ("vector", Field.VECTOR))),
    0x16: CommandKind(name="get_light_direction", fields=(_LIGHT,)),
    0x17: CommandKind(name="set_light_direction", fields=(_LIGHT, ("vector", Field.VECTOR))),
    0x18: CommandKind(name="get_light_type", fields=(_LIGHT,)),
    0x19: CommandKind(name="get_lights"),
    0x1A: CommandKind(name="get_ambient_colour"),
    0x1B: CommandKind(name="set_ambient_colour", fields=_RGB),
}

_LATER: Mapping[int, CommandKind] = {
    0x09: CommandKind(
        name="spawn_object",
        fields=(*_SPAWN, ("frustum_limited", Field.BOOL), ("has_dynamic", Field.BOOL)),
        extra=(("dynamic_type", Field.NAME), ("dynamic", Field.DOCUMENT)),
    ),
    0x1C: CommandKind(name="spawn_view_frustum"),
    0x1D: CommandKind(name="load_scenario", fields=(("scenario", Field.DOCUMENT),)),
    0x1E: CommandKind(name="move_object", fields=(("id", Field.INT), *_POSE)),
}

_COMMANDS: Mapping[str, Mapping[int, CommandKind]] = {
    "0.5": MappingProxyType(dict(_BASE)),
    "0.6": MappingProxyType({**_BASE, **_LATER}),
}


def commands_of(protocol: str) -> Mapping[int, CommandKind]:
    """Return the commands of a revision by their bytes; read-only.

    Raises
    ------
    UnknownName
        If there is no such revision.
    """
    if protocol not in _COMMANDS:
        raise UnknownName("protocol", protocol, get_args(Protocol))
    return _COMMANDS[protocol]
