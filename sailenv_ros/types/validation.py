"""Checks of what users pass in: numbers within bounds, switches, names, vectors.

A value of any type in, a value of the right type out, or an `InvalidRequest` that says in one
sentence what is accepted. NumPy's scalars count as numbers and switches; a switch is no number, and
no number is a switch.

A data class has one table of `Bounds` beside it. Python, scene files, ROS and the viewer read it,
so that they accept the same values and refuse the others in the same words.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeGuard

import numpy as np
from numpy.typing import ArrayLike

from sailenv_ros.errors import InvalidRequest

__all__ = [
    "IDENTIFIER",
    "SEED",
    "Bounds",
    "check_bounds",
    "checked_flag",
    "checked_integer",
    "checked_number",
    "is_finite_number",
    "is_integer",
    "is_number",
    "shown_number",
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


def shown_number(value: float) -> str:
    """Show a number without needless digits, and an integer with all of its own: 1000000, 0.001."""
    return str(value) if is_integer(value) else f"{value:.10g}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Bounds:
    """Finite numbers that are accepted, and the words for them.

    Attributes
    ----------
    above : float or None
        Exclusive lower bound.
    least, most : float or None
        Inclusive bounds.
    unit : str
        Shown in brackets; empty for pure numbers.
    whole : bool
        True if only integers are accepted.
    """

    above: float | None = None
    least: float | None = None
    most: float | None = None
    unit: str = ""
    whole: bool = False

    @property
    def accepted(self) -> str:
        """All that is accepted, e.g. ``"a number above 0 and at most 100 [kg]"``."""
        return self._phrase(self._low(), self.most)

    def refused(self, value: object) -> str:
        """Return in words what a value should have been; nothing if it is accepted."""
        if not is_number(value) or (self.whole and not is_integer(value)):
            return self.accepted
        if not is_finite_number(value):
            return self.accepted
        if (self.above is not None and value <= self.above) or (
            self.least is not None and value < self.least
        ):
            # Only the bound that was missed is told, where it is not one of a close pair.
            return self._phrase(self._low(), None) if self.least is None else self.accepted
        return self.accepted if self.most is not None and value > self.most else ""

    def integer(self, what: str, value: object) -> int:
        """Return an integer within the bounds; see `number`."""
        accepted = self.refused(value)
        if accepted or not is_integer(value):
            raise InvalidRequest(what, value, accepted or self.accepted)
        return int(value)

    def number(self, what: str, value: object) -> float:
        """Return a number within the bounds.

        Parameters
        ----------
        what : str
            The name that an error tells.
        value : object

        Raises
        ------
        InvalidRequest
            If it is no number, or outside of the bounds.
        """
        accepted = self.refused(value)
        if accepted or not is_number(value):
            raise InvalidRequest(what, value, accepted or self.accepted)
        return float(value)

    def _low(self) -> float | None:
        return self.least if self.above is None else self.above

    def _phrase(self, low: float | None, most: float | None) -> str:
        noun = "an integer" if self.whole else "a number"
        unit = f" [{self.unit}]" if self.unit else ""
        if low is not None and low == most:
            return f"{shown_number(low)}{unit}"
        if low is None:
            bounds = "" if most is None else f" of at most {shown_number(most)}"
        elif self.above is not None:
            bounds = f" above {shown_number(low)}"
            bounds += "" if most is None else f" and at most {shown_number(most)}"
        else:
            bounds = f" from {shown_number(low)}"
            bounds += " up" if most is None else f" to {shown_number(most)}"
        return f"{noun}{bounds}{unit}"


SEED = Bounds(least=0, most=2**63 - 1, whole=True)
"""Seeds of everything that is drawn at random."""


def check_bounds(
    instance: object, table: Mapping[str, Bounds], *, before: str = "", after: str = ""
) -> None:
    """Check the numbers of a frozen data class, and keep them as Python's own.

    Parameters
    ----------
    instance : object
        Of the data class, in its ``__post_init__``.
    table : mapping of str to Bounds
        By the names of its attributes.
    before, after : str
        Around the attribute's name in what an error tells.

    Raises
    ------
    InvalidRequest
        If one of them is out of its bounds.
    """
    for name, bounds in table.items():
        check = bounds.integer if bounds.whole else bounds.number
        value = check(f"{before}{name}{after}", getattr(instance, name))
        object.__setattr__(instance, name, value)


def checked_number(what: str, value: object, low: float, high: float, *, unit: str = "") -> float:
    """Return a number from `low` to `high`; see `Bounds.number`."""
    return Bounds(least=low, most=high, unit=unit).number(what, value)


def checked_integer(what: str, value: object, low: int, high: int, *, unit: str = "") -> int:
    """Return an integer from `low` to `high`; see `Bounds.number`."""
    return Bounds(least=low, most=high, unit=unit, whole=True).integer(what, value)


def checked_flag(what: str, value: object) -> bool:
    """Return a boolean.

    Raises
    ------
    InvalidRequest
        If it is anything else, also what only resembles one, such as 1 or ``"no"``.
    """
    if not isinstance(value, bool | np.bool_):
        raise InvalidRequest(what, value, "true or false")
    return bool(value)


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
    try:
        array = np.asarray(values, dtype=np.float64)
    except (OverflowError, TypeError, ValueError):
        array = np.empty(0)
    if array.shape == (3,):
        x, y, z = array.tolist()
        if all(math.isfinite(part) and abs(part) <= limit for part in (x, y, z)):
            return x, y, z
    within = f" within ±{shown_number(limit)}" if math.isfinite(limit) else ""
    raise InvalidRequest(what, values, f"three finite numbers{within}") from None
