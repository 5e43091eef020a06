"""Openings through which the surroundings of a room can be seen."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

__all__ = ["Outside"]

Vector3 = tuple[float, float, float]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Outside:
    """A closed room and its openings.

    Attributes
    ----------
    low_m, high_m : (3,) tuple of float
        Opposite corners of the room's inside, in the world [m].
    openings_m : tuple of ((3,) tuple of float, (3,) tuple of float)
        Opposite corners of each hole in the inner faces of its walls, in the world [m].
    shell : mapping of str to (3,) tuple of float
        Names of the parts that close the room (walls, floor, ceiling), and where they are placed
        [m]; while one of them is missing, elsewhere or not opaque, one can look past the openings.
        Empty for a room that is open anyway.
    """

    low_m: Vector3
    high_m: Vector3
    openings_m: tuple[tuple[Vector3, Vector3], ...]
    shell: Mapping[str, Vector3]
