"""Checks of what users pass in: numbers, integers, switches, names, vectors.

A value of any type in, a value of the right type out, or an `InvalidRequest` that says in one
sentence what is accepted. NumPy's scalars count as numbers; booleans never do.
"""

from __future__ import annotations

import math
import re
from typing import TypeGuard

import numpy as np
from numpy.typing import ArrayLike

from sailenv_ros.errors import InvalidRequest

__all__ = [
    "IDENTIFIER",
    "checked_flag",
    "checked_integer",
    "checked_number",
    "is_finite_number",
    "is_integer",
    "is_number",
    "vector",
]

IDENTIFIER = re.compile(r"[a-z][a-z0-9_]{0,62}")
"""Pattern of the names of agents and assets; ROS and file systems accept them too."""


def is_number(value: object) -> TypeGuard[float]:
    """Return whether a value is a real number, be it infinite or not a number."""
    number = isinstance(value, int | float | np.integer | np.floating)
    return number and not isinstance(value, bool)


def is_finite_number(value: object) -> TypeGuard[float]:
    """Return whether a value is a number that a float can hold; an integer may be too large."""
    try:
        return is_number(value) and math.isfinite(float(value))
    except OverflowError:
        return False


def is_integer(value: object) -> TypeGuard[int]:
    """Return whether a value is an integer by its type; 3.0 is none."""
    return isinstance(value, int | np.integer) and not isinstance(value, bool)


def checked_number(what: str, value: object, low: float, high: float, *, unit: str = "") -> float:
    """Return a number from `low` to `high`.

    Parameters
    ----------
    what : str
        The name that an error tells.
    value : object
    low, high : float
        Both are accepted.
    unit : str
        What an error tells in brackets behind the range, e.g. ``"m"``.

    Raises
    ------
    InvalidRequest
        If it is no number, or outside of the range.
    """
    if not is_number(value) or not low <= value <= high:
        raise InvalidRequest(what, value, _accepted(f"a number from {low:g} to {high:g}", unit))
    return float(value)


def checked_integer(what: str, value: object, low: int, high: int, *, unit: str = "") -> int:
    """Return an integer from `low` to `high`; see `checked_number`."""
    if not is_integer(value) or not low <= value <= high:
        raise InvalidRequest(what, value, _accepted(f"an integer from {low} to {high}", unit))
    return int(value)


def checked_flag(what: str, value: object) -> bool:
    """Return a boolean.

    Raises
    ------
    InvalidRequest
        If it is anything else.
    """
    if not isinstance(value, bool):
        raise InvalidRequest(what, value, "true or false")
    return value


def vector(what: str, values: ArrayLike, *, limit: float = math.inf) -> tuple[float, float, float]:
    """Return three finite numbers.

    Parameters
    ----------
    what : str
        The name that an error tells.
    values : (3,) array-like
    limit : float
        The largest magnitude accepted for each of them.

    Raises
    ------
    InvalidRequest
        If there are not three, or one is not finite or beyond the limit.
    """
    accepted = "three finite numbers" + (f" within ±{limit:g}" if math.isfinite(limit) else "")
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidRequest(what, values, accepted) from None
    if array.shape != (3,) or not np.isfinite(array).all() or bool((np.abs(array) > limit).any()):
        raise InvalidRequest(what, values, accepted)
    return float(array[0]), float(array[1]), float(array[2])


def _accepted(interval: str, unit: str) -> str:
    return f"{interval} [{unit}]" if unit else interval
