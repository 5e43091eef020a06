"""A client's message as Python values: JSON text in, checked types out.

Whatever is sent, the only error is `InvalidRequest`, whose sentence is the answer.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

from sailenv_ros.errors import InvalidRequest, UnknownName

__all__ = ["Arguments", "arguments_of_text"]

MAX_TEXT = 4096

T = TypeVar("T", bound=str)


def arguments_of_text(text: str) -> Arguments:
    """Read a message.

    Raises
    ------
    InvalidRequest
        If it is no JSON object, or has a number that is none (NaN, infinite).
    """
    try:
        value = json.loads(text, parse_constant=_refuse)
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

    def get(self, name: str) -> Any:
        """Return a value as it is; None if it is missing."""
        return self._values.get(name)

    def text(self, name: str) -> str:
        """Return a text."""
        value = self.get(name)
        # A lone surrogate is valid in JSON and in no file or message.
        if not isinstance(value, str) or len(value) > MAX_TEXT or not _encodes(value):
            raise InvalidRequest(name, value, f"a text of at most {MAX_TEXT} characters")
        return value

    def optional_text(self, name: str) -> str | None:
        """Return a text; None if there is none."""
        return None if self.get(name) is None else self.text(name)

    def choice(self, name: str, accepted: Sequence[T]) -> T:
        """Return one of several texts."""
        value = self.text(name)
        for item in accepted:
            if item == value:
                return item
        raise UnknownName(name, value, map(str, accepted))

    def integer(self, name: str) -> int:
        """Return an integer."""
        value = self.get(name)
        if isinstance(value, bool) or not isinstance(value, int) or abs(value) >= 2**63:
            raise InvalidRequest(name, value, "an integer")
        return value

    def number(self, name: str) -> float:
        """Return a number."""
        return _number(name, self.get(name))

    def numbers(self, name: str, count: int) -> tuple[float, ...]:
        """Return a list of so many numbers."""
        value = self.get(name)
        if not isinstance(value, list) or len(value) != count:
            raise InvalidRequest(name, value, f"a list of {count} numbers")
        return tuple(_number(name, item) for item in value)

    def flag(self, name: str) -> bool:
        """Return true or false; false if it is missing."""
        value = self._values.get(name, False)
        if not isinstance(value, bool):
            raise InvalidRequest(name, value, "true or false")
        return value

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


def _number(name: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or abs(value) > 1e12:
        raise InvalidRequest(name, value, "a number")
    return float(value)


def _encodes(text: str) -> bool:
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return True


def _refuse(constant: str) -> None:
    raise ValueError(f"{constant} is no number")
