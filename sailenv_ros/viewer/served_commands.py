"""Functions as commands of the socket: a message's values are checked by the declared parameters.

A function's keywords and its result are what the page's types are generated from, as those of an
operation are.
"""

from __future__ import annotations

import inspect
from collections.abc import Awaitable, Callable, Mapping
from functools import wraps
from typing import Any, Concatenate, Final, Literal, ParamSpec, TypeVar, get_args, get_origin

from typing_extensions import get_type_hints

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.types.validation import vector
from sailenv_ros.viewer.request_arguments import Arguments
from sailenv_ros.viewer.scene_messages import Vector3

__all__ = ["served"]

C = TypeVar("C")
P = ParamSpec("P")
R = TypeVar("R")


def served(
    function: Callable[Concatenate[C, P], Awaitable[R]],
) -> Callable[[C, Arguments], Awaitable[R]]:
    """Have a function answer messages: its keywords are their values.

    Optional values that are missing or null are left at their defaults.

    Raises
    ------
    UnknownName, InvalidRequest
        By the command: if a message has a value of another name or type.
    """
    hints = get_type_hints(function)
    parameters = list(inspect.signature(function).parameters.values())[1:]
    readers = {one.name: _reader(hints[one.name]) for one in parameters}
    optional = {one.name for one in parameters if one.default is not one.empty}

    @wraps(function)
    async def run(context: C, given: Arguments) -> R:
        for name in given.values:
            if name not in readers:
                raise UnknownName(f"argument of {given.text('do')}", name, readers)
        values: dict[str, Any] = {
            name: read(given, name)
            for name, read in readers.items()
            if name not in optional or given.get(name) is not None
        }
        return await function(context, **values)  # type: ignore[call-arg]  # read by their hints

    return run


def _reader(hint: Any) -> Callable[[Arguments, str], Any]:
    kinds = [one for one in get_args(hint) if one is not type(None)]
    if type(None) in get_args(hint) and len(kinds) == 1:
        return _reader(kinds[0])
    if hint in _READERS:
        return _READERS[hint]
    if get_origin(hint) is Literal:
        return Arguments.text
    if get_origin(hint) is list:
        return _texts
    return Arguments.mapping  # a typed dictionary, whose values an operation checks


def _texts(given: Arguments, name: str) -> list[Any]:
    values = given.entries(name)
    if not all(isinstance(value, str) for value in values):
        raise InvalidRequest(name, values, "a list of texts")
    return values


def _vector(given: Arguments, name: str) -> Vector3:
    return vector(name, given.get(name))


_READERS: Final[Mapping[Any, Callable[[Arguments, str], Any]]] = {
    int: Arguments.integer,
    float: Arguments.number,
    str: Arguments.text,
    bool: Arguments.flag,
    bytes: Arguments.data,
    Vector3: _vector,
}
"""By the declared type of a parameter."""
