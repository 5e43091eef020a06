"""The place of a room among its surroundings, turned so that its front looks to the south."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.outside.daylight import Daylight
from sailenv_ros.scene.spec_room import DoorSpec, OpeningSpec, RoomSpec, WallName, WindowSpec

__all__ = ["Site", "site_of"]

Vector3 = tuple[float, float, float]

_FRONTS: tuple[WallName, ...] = ("south", "west", "north", "east")
"""Walls by the quarter turns, counter-clockwise, that bring them to the south."""


@dataclass(frozen=True, slots=True)
class Site:
    """A house of one room.

    Attributes
    ----------
    half_x, half_y : float
        Half its outer size, turned [m].
    height_m : float
        Of its ceiling above the floor.
    quarter_turns : int
        By which it was turned, counter-clockwise.
    open_sides : frozenset of str
        Walls that one can look through, as they lie now: ``"n"``, ``"e"``, ``"s"``, ``"w"``.
    """

    half_x: float
    half_y: float
    height_m: float
    quarter_turns: int
    open_sides: frozenset[str]

    def sees(self, points: NDArray[np.float64]) -> bool:
        """Return whether any of points (N, 3) lies before a wall that one can look through."""
        x, y = points[:, 0], points[:, 1]
        before = {
            "n": y.max() > self.half_y,
            "s": y.min() < -self.half_y,
            "e": x.max() > self.half_x,
            "w": x.min() < -self.half_x,
        }
        return any(before[side] for side in self.open_sides)

    def faced_by(self, origin: Vector3, normal: NDArray[np.float64]) -> bool:
        """Return whether any place in the room lies before a plane through a point."""
        x, y, z = origin
        nx, ny, nz = normal.tolist()
        reach = abs(nx) * self.half_x + abs(ny) * self.half_y + max(0.0, nz) * self.height_m
        return bool(reach > nx * x + ny * y + nz * z)

    def turned_light(self, daylight: Daylight) -> Daylight:
        """Return the light as it falls on the turned place."""
        x, y, z = daylight.towards_sun
        for _ in range(self.quarter_turns):
            x, y = -y, x
        return Daylight(
            towards_sun=(x, y, z),
            sun=daylight.sun,
            zenith=daylight.zenith,
            horizon=daylight.horizon,
            ground=daylight.ground,
        )

    def turned_back(self, vectors: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return vectors (N, 3) in the axes of the world, exactly."""
        x, y, z = vectors.T
        for _ in range(self.quarter_turns):
            x, y = y, -x
        return np.stack([x, y, z], axis=1)


def site_of(room: RoomSpec) -> Site:
    """Return the place of a room: its front is the wall with the largest windows."""
    area: dict[WallName, float] = dict.fromkeys(_FRONTS, 0.0)
    for opening in room.openings:
        if isinstance(opening, WindowSpec):
            area[opening.wall] += opening.width * opening.height
    front = max(_FRONTS, key=lambda wall: area[wall])
    turns = _FRONTS.index(front)
    half_x, half_y = (size / 2.0 + room.thickness for size in room.size[:2])
    order = "senw"  # as they follow each other counter-clockwise
    seen = {
        order[(order.index(opening.wall[0]) + turns) % 4]
        for opening in room.openings
        if leads_out(opening, room)
    }
    return Site(
        half_x=half_y if turns % 2 else half_x,
        half_y=half_x if turns % 2 else half_y,
        height_m=room.size[2],
        quarter_turns=turns,
        open_sides=frozenset(seen),
    )


def leads_out(opening: OpeningSpec, room: RoomSpec) -> bool:
    """Return whether one looks out of an opening: a window, or a door between windows."""
    if isinstance(opening, WindowSpec):
        return True
    beside = any(isinstance(o, WindowSpec) and o.wall == opening.wall for o in room.openings)
    return beside and can_be_open(opening)


def can_be_open(opening: OpeningSpec) -> bool:
    """Return whether an opening is a door that stands open, or may be opened."""
    return isinstance(opening, DoorSpec) and (opening.open > 0.0 or opening.hinged)
