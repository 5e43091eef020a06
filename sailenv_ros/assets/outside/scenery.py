"""Surfaces that lie outside, as they are collected: painted flat pieces and cards of leaves.

Kinds of surroundings add to a `Scenery`; `atlas` makes a model of it.
"""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.outside.daylight import Daylight, Occluders
from sailenv_ros.assets.outside.painting import Painter

__all__ = ["GROUND_M", "Card", "Piece", "Scenery"]

Vector3 = tuple[float, float, float]
Floats = NDArray[np.float64]

GROUND_M = -0.45
"""Height of the ground outside: below the floor, by the height of three steps [m]."""

_WHOLE = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))


@dataclass(frozen=True, eq=False, slots=True)
class Piece:
    """A flat painted surface.

    Attributes
    ----------
    origin, right, up : (3,) tuple of float
        Lower left corner as seen from the front, and two sides [m].
    paint : callable
        Its painter.
    density : float
        Pixels for each metre.
    outline : sequence of (float, float)
        Its corners in shares of the sides, counter-clockwise.
    has_own_light : bool
        True if its painter paints radiance; False for a colour in daylight.
    """

    origin: Vector3
    right: Vector3
    up: Vector3
    paint: Painter
    density: float
    outline: Sequence[tuple[float, float]] = _WHOLE
    has_own_light: bool = False

    @property
    def size_m(self) -> tuple[float, float]:
        """Width and height [m]."""
        return math.dist(self.right, (0, 0, 0)), math.dist(self.up, (0, 0, 0))

    @property
    def normal(self) -> Floats:
        """(3,) unit normal of the front."""
        across = np.cross(self.right, self.up)
        unit: Floats = across / np.sqrt((across * across).sum())
        return unit

    def places(self, shares: Floats) -> Floats:
        """Return (N, 3) points for shares (N, 2) of the sides [m]."""
        result: Floats = (
            np.asarray(self.origin)
            + shares[:, :1] * np.asarray(self.right)
            + shares[:, 1:] * np.asarray(self.up)
        )
        return result


@dataclass(frozen=True, slots=True)
class Card:
    """A square that shows a spray of leaves.

    Attributes
    ----------
    centre, right, up : (3,) tuple of float
        Its middle and half its sides [m].
    normal : (3,) tuple of float
        For its shading.
    foliage : int
        Number of the colour of its leaves; see `Scenery.leaf_colours`.
    """

    centre: Vector3
    right: Vector3
    up: Vector3
    normal: Vector3
    foliage: int


@dataclass(eq=False, slots=True)
class Scenery:
    """The parts that were added.

    Attributes
    ----------
    dice : random.Random
        For the layout; its numbers are the same everywhere.
    daylight : Daylight
    """

    dice: random.Random
    daylight: Daylight
    pieces: list[Piece] = field(default_factory=list)
    cards: list[Card] = field(default_factory=list)
    occluders: Occluders = field(default_factory=Occluders)
    leaf_colours: list[Vector3] = field(default_factory=list)

    def add(
        self,
        origin: Vector3,
        right: Vector3,
        up: Vector3,
        paint: Painter,
        density: float,
        *,
        outline: Sequence[tuple[float, float]] = _WHOLE,
        has_own_light: bool = False,
    ) -> None:
        """Add a flat piece; see `Piece`."""
        self.pieces.append(Piece(origin, right, up, paint, density, outline, has_own_light))

    def level(
        self, x: tuple[float, float], y: tuple[float, float], z: float, paint: Painter,
        density: float,
    ) -> None:  # fmt: skip
        """Add a level rectangle that looks up; its picture runs along its longer side."""
        wide, deep = x[1] - x[0], y[1] - y[0]
        if wide >= deep:
            self.add((x[0], y[0], z), (wide, 0, 0), (0, deep, 0), paint, density)
        else:
            self.add((x[1], y[0], z), (0, deep, 0), (-wide, 0, 0), paint, density)

    def box(
        self,
        low: Vector3,
        high: Vector3,
        paint: Painter,
        density: float,
        *,
        top: Painter | None = None,
        sides: str = "nesw",
        casts: bool = False,
    ) -> None:
        """Add an upright box without its underside.

        Parameters
        ----------
        low, high : (3,) tuple of float
            Opposite corners [m].
        paint : callable
            Of its sides.
        density : float
        top : callable or None
            Of its upper face; None for that of the sides.
        sides : str
            Letters of those that can be seen: north (+y), east (+x), south, west.
        casts : bool
            True if it keeps light from other things.
        """
        if casts:
            self.occluders.add_box(low, high)
        (x0, y0, z0), (x1, y1, z1) = low, high
        wide, deep, tall = x1 - x0, y1 - y0, z1 - z0
        faces: dict[str, tuple[Vector3, Vector3]] = {
            "s": ((x0, y0, z0), (wide, 0, 0)),
            "e": ((x1, y0, z0), (0, deep, 0)),
            "n": ((x1, y1, z0), (-wide, 0, 0)),
            "w": ((x0, y1, z0), (0, -deep, 0)),
        }
        for side in sides:
            origin, right = faces[side]
            self.add(origin, right, (0, 0, tall), paint, density)
        self.add((x0, y0, z1), (wide, 0, 0), (0, deep, 0), top or paint, density)

    def new_foliage(self, colour: Vector3) -> int:
        """Return the number of a colour of leaves."""
        self.leaf_colours.append(colour)
        return len(self.leaf_colours) - 1

    def between(self, low: float, high: float) -> float:
        """Draw a number."""
        return low + (high - low) * self.dice.random()
