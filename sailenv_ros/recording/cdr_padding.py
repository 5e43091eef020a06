"""Serialized messages → the same with zeros where the serializer left what was in memory before.

In CDR numbers lie at multiples of their size. Fast DDS skips the bytes between and does not write
them, so two processes serialize the same message to other bytes. `message_layout` reads the layout
from a message class; nothing here knows a particular message.
"""

from __future__ import annotations

import struct
from functools import lru_cache
from importlib import import_module
from typing import Any, TypeAlias

__all__ = ["without_padding_garbage"]

_SIZES = {
    "boolean": 1, "octet": 1, "char": 1, "uint8": 1, "int8": 1, "uint16": 2, "int16": 2,
    "uint32": 4, "int32": 4, "float": 4, "uint64": 8, "int64": 8, "double": 8,
}  # fmt: skip
_HEADER_BYTES = 4

Step: TypeAlias = tuple[str, Any, Any]
"""Kind of a field, and what it takes to skip one; see `_steps_of`."""


def without_padding_garbage(data: bytes, message_class: Any) -> bytes:
    """Return a serialized message whose padding is zero.

    Parameters
    ----------
    data : bytes
        Plain CDR of little-endian byte order, with its header of four bytes.
    message_class : type
        Of the message.
    """
    cleaned = bytearray(data)
    end = _skip_all(cleaned, _HEADER_BYTES, message_layout(message_class))
    cleaned[end:] = bytes(len(cleaned) - end)
    return bytes(cleaned)


@lru_cache(maxsize=64)
def message_layout(message_class: Any) -> tuple[Step, ...]:
    """Return how to go through the bytes of a message of that class."""
    return tuple(_step_of(slot) for slot in message_class.SLOT_TYPES)


def _step_of(slot: Any) -> Step:
    kind = type(slot).__name__
    if kind == "BasicType":
        return "number", _SIZES[slot.typename], None
    if kind in ("UnboundedString", "BoundedString"):
        return "text", None, None
    if kind == "NamespacedType":
        return "message", message_layout(_class_of(slot)), None
    if kind == "Array":
        return "array", _step_of(slot.value_type), slot.size
    if kind in ("UnboundedSequence", "BoundedSequence"):
        return "sequence", _step_of(slot.value_type), None
    raise TypeError(f"no message has fields of {kind}")


def _class_of(slot: Any) -> Any:
    module = import_module(".".join(slot.namespaces))
    return getattr(module, slot.name)


def _skip_all(data: bytearray, at: int, steps: tuple[Step, ...]) -> int:
    for kind, inner, count in steps:
        if kind == "number":
            at = _aligned(data, at, inner) + inner
        elif kind == "text":
            at = _aligned(data, at, 4)
            at += 4 + struct.unpack_from("<I", data, at)[0]
        elif kind == "message":
            at = _skip_all(data, at, inner)
        elif kind == "array":
            at = _skip_many(data, at, inner, count)
        else:
            at = _aligned(data, at, 4)
            (length,) = struct.unpack_from("<I", data, at)
            at = _skip_many(data, at + 4, inner, length)
    return at


def _skip_many(data: bytearray, at: int, step: Step, count: int) -> int:
    if not count:
        return at
    if step[0] == "number":
        return _aligned(data, at, step[1]) + step[1] * count
    for _ in range(count):
        at = _skip_all(data, at, (step,))
    return at


def _aligned(data: bytearray, at: int, size: int) -> int:
    padding = -(at - _HEADER_BYTES) % size
    if padding:
        data[at : at + padding] = bytes(padding)
    return at + padding
