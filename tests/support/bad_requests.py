"""Requests that no service can do: a good one with bad values in one field, or in every one.

A service's fields are known from its type alone, so what is added is tried as well.
"""

from __future__ import annotations

import math
import re
from array import array
from collections.abc import Iterator, Mapping
from importlib import import_module
from typing import Any

import numpy as np
from rclpy.parameter import Parameter

__all__ = ["REQUESTS", "bad_requests"]

REQUESTS = 20
"""Bad requests for each service, or as many as there are."""

LONG = "x" * 1_000_000

FLOATS = (math.nan, math.inf, -math.inf, 1.7e308, -1.7e308)
TEXTS = (
    "nobody", LONG, "../../etc/passwd", "\u202e🛋️ ünïcode", "two\nlines\x1b[2J", "generated:🛋:-1",
    "generated:kitchen:1e99", "[" * 2000, "&a [*a, *a]", "{objects: [{asset: 5}]}",
)  # fmt: skip
LENGTHS = (0, 3, 100_000)

RIGHT = (("exposure", 0.5), ("mass", 2.0), ("intensity", 3.0), ("colour", "#ff0000"))
"""Values of which one may be right."""

GOOD: dict[str, Any] = {"id": 1, "asset": "cube", "scene": "optical", "type": "point"}
"""Values of fields in the good request, by name; others have their defaults."""


def bad_requests(kind: type[Any], random: np.random.Generator) -> Iterator[tuple[str, Any]]:
    """Yield what is bad, in words, and the request.

    Parameters
    ----------
    kind : type
        Of the service.
    random : numpy.random.Generator
        Chooses among the values of fields, if there are too many, and those of flags.
    """
    leaves = dict(_leaves(kind.Request()))
    floats = [path for path, type_ in leaves.items() if _is_float(type_)]
    for value in FLOATS[:3] if floats else ():
        yield f"{value} everywhere", _request(kind, dict.fromkeys(floats, value), random)
    pairs = [(path, value) for path, type_ in leaves.items() for value in _values(type_)]
    for chosen in sorted(random.permutation(len(pairs))[: REQUESTS - 3]):
        path, value = pairs[chosen]
        yield f"{'.'.join(path)} = {str(value)[:40]!r}", _request(kind, {path: value}, random)


def _request(
    kind: type[Any], bad: Mapping[tuple[str, ...], Any], random: np.random.Generator
) -> Any:
    request = kind.Request()
    for path, type_ in _leaves(request):
        if path in bad:
            _put(request, path, bad[path])
        elif type_ == "boolean":
            _put(request, path, bool(random.integers(2)))
        elif path[-1] in GOOD:
            _put(request, path, GOOD[path[-1]])
    return request


def _put(message: Any, path: tuple[str, ...], value: Any) -> None:
    for name in path[:-1]:
        message = getattr(message, name)
    present = getattr(message, path[-1])
    if isinstance(present, np.ndarray):
        value = np.full(present.shape, value, present.dtype)
    setattr(message, path[-1], value)


def _leaves(message: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], str]]:
    """Yield every field that is no message, with its type as ROS writes it."""
    for name, type_ in message.get_fields_and_field_types().items():
        value = getattr(message, name)
        if hasattr(value, "get_fields_and_field_types"):
            yield from _leaves(value, (*path, name))
        else:
            yield (*path, name), type_


def _values(type_: str) -> tuple[Any, ...]:
    sequence = re.fullmatch(r"sequence<(.*?)(, \d+)?>", type_)
    if sequence:
        return tuple(_many(sequence[1], length) for length in LENGTHS) + _changes(sequence[1])
    if _is_float(type_):
        return FLOATS
    if type_ == "string":
        return TEXTS
    size = re.fullmatch(r"(u?)int(\d+)", type_)
    if size:
        bits = int(size[2])
        return (0, 2**bits - 1) if size[1] else (-(2 ** (bits - 1)), -1, 2 ** (bits - 1) - 1)
    return ()


def _many(of: str, length: int) -> Any:
    if "/" in of:
        return [_spoilt(of)] * min(length, 3000)
    if _is_float(of):
        return array("f" if of == "float" else "d", [math.nan] * length)
    if of == "string":
        return ["nobody"] * length
    if of == "uint8":
        return array("B", bytes(length))
    return array({"uint16": "H", "uint32": "I", "int32": "i", "int64": "q"}[of], [0] * length)


def _spoilt(of: str) -> Any:
    """Return a message without any number."""
    package, name = of.split("/")
    message = getattr(import_module(f"{package}.msg"), name)()
    for path, type_ in _leaves(message):
        if _is_float(type_):
            _put(message, path, math.nan)
    return message


def _changes(of: str) -> tuple[list[Any], ...]:
    """Return values by name, one that may be right before one that is wrong."""
    if of != "rcl_interfaces/Parameter":
        return ()
    return tuple(
        [
            Parameter(key, value=right).to_parameter_msg(),
            Parameter("nobody", value=wrong).to_parameter_msg(),
        ]
        for key, right in RIGHT
        for wrong in (math.nan, "nobody", [math.nan] * 3, 2**62)
    )


def _is_float(type_: str) -> bool:
    return bool(re.fullmatch(r"(float|double|float32|float64)(\[\d+\])?", type_))
