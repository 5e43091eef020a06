"""A client's message as Python values: JSON text in, checked types out.

Whatever is sent, the only error is `InvalidRequest`, whose sentence is the answer.
"""

from __future__ import annotations

import base64
import binascii
import json
import math
from collections.abc import Mapping
from typing import Any

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.simulation.operations import argument_checks as check
from sailenv_ros.types.validation import Bounds, checked_flag

__all__ = ["Arguments", "arguments_of_text"]

_INTEGER = Bounds(whole=True)
_LARGEST = 2**63

_OF_SOCKET = ("do", "id")
"""Keys of a message that the socket itself takes: the command's name and the call's number."""


def arguments_of_text(text: str) -> Arguments:
    """Read a message.

    Raises
    ------
    InvalidRequest
        If it is no JSON object, or has a number that no simulator can hold (NaN, infinite, an
        integer of more than 64 bits).
    """
    try:
        value = json.loads(
            text, parse_constant=_refused, parse_float=_finite, parse_int=_representable
        )
    except (ValueError, RecursionError) as error:
        raise InvalidRequest("message", text[:200], f"JSON ({str(error)[:200]})") from None
    return Arguments(value, "message")


class Arguments:
    """The values of one message by their names.

    Parameters
    ----------
    values : object
        As JSON has them.
    what : str
        What they belong to.

    Raises
    ------
    InvalidRequest
        If they are no mapping; so every method does if a value is missing or of another type.
    """

    def __init__(self, values: object, what: str) -> None:
        if not isinstance(values, Mapping):
            raise InvalidRequest(what, values, "a JSON object")
        self._values = values

    @property
    def values(self) -> dict[str, Any]:
        """All but the name of the command and the number of the call."""
        return {name: value for name, value in self._values.items() if name not in _OF_SOCKET}

    def get(self, name: str) -> Any:
        """Return a value as it is; None if it is missing."""
        return self._values.get(name)

    def text(self, name: str) -> str:
        """Return a text."""
        return check.text(name, self.get(name))

    def optional_text(self, name: str) -> str | None:
        """Return a text; None if there is none."""
        return None if self.get(name) is None else self.text(name)

    def integer(self, name: str) -> int:
        """Return an integer."""
        return _INTEGER.integer(name, self.get(name))

    def number(self, name: str) -> float:
        """Return a number."""
        return check.number(name, self.get(name))

    def flag(self, name: str) -> bool:
        """Return true or false; false if it is missing."""
        return checked_flag(name, self._values.get(name, False))

    def mapping(self, name: str) -> dict[str, Any]:
        """Return a JSON object; an empty one if it is missing."""
        value = self._values.get(name, {})
        if not isinstance(value, dict):
            raise InvalidRequest(name, value, "a JSON object")
        return value

    def entries(self, name: str) -> list[Any]:
        """Return a list of anything."""
        value = self.get(name)
        if not isinstance(value, list):
            raise InvalidRequest(name, value, "a list")
        return value

    def data(self, name: str) -> bytes:
        """Return the bytes of a text in base 64."""
        value = self.get(name)
        try:
            return base64.b64decode(value if isinstance(value, str) else "!", validate=True)
        except (binascii.Error, ValueError):
            raise InvalidRequest(name, str(value)[:40], "a piece of a file in base 64") from None


def _refused(constant: str) -> None:
    raise ValueError(f"{constant} is no number")


def _finite(written: str) -> float:
    value = float(written)
    if not math.isfinite(value):
        raise ValueError(f"{written} is no finite number")
    return value


def _representable(written: str) -> int:
    value = int(written)
    if not -_LARGEST <= value < _LARGEST:
        raise ValueError(f"{written[:40]} has more than 64 bits")
    return value
