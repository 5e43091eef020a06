"""Sitting: which seats one can take, and sitting down, staying, getting up."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours import STEP_S
from sailenv_ros.behaviours.person import Activity
from sailenv_ros.postures.figure import figure_of
from sailenv_ros.postures.footsteps import Moment, moment_of, standing_feet
from sailenv_ros.postures.sitting import SIT_S, SeatPlace, seat_distance_m, sitting_posture
from sailenv_ros.postures.skeleton import Posture
from sailenv_ros.world.activities.base import Actor, Instant, SpotActivity
from sailenv_ros.world.crowd import Crowd
from sailenv_ros.world.seats import Seat
from sailenv_ros.world.skin import contact_skin

__all__ = ["HIGHEST", "Sitting", "seats_for", "ways_to_sit"]

Doubles = NDArray[np.float64]

_FEET_BEFORE_M = 0.02
_SINK_M = 0.02
"""How far the skin of one who sits presses into the seat [m]."""

_BESIDE_M = 0.2
"""Depth from which something is not below the body but beside it [m]."""

_SEATED = ("root", "spine05", "spine04", "upperleg01.L", "upperleg01.R")
_ROUNDS = 3

HIGHEST = 0.95
"""Height of a seat that one can reach, over the leg's length."""


class Sitting(SpotActivity):
    """A person on a seat.

    Parameters
    ----------
    actor : Actor
    seat : Seat
    heights : callable or None
        ``heights(places)``: (N,) heights of the piece at (N, 2) places of the world [m]; None for
        a level one.
    """

    def __init__(
        self, actor: Actor, seat: Seat, heights: Callable[[Doubles], Doubles] | None = None
    ) -> None:
        self._actor, self._rig = actor, actor.rig
        height = seat.height_m - actor.floor_m
        back = seat_distance_m(actor.rig, height / actor.scale) * actor.scale
        ahead = max(back - min(seat.depth_m, 0.62 * back + 0.08), _FEET_BEFORE_M)
        c, s = float(np.cos(seat.yaw)), float(np.sin(seat.yaw))
        self.feet = (seat.x + ahead * c, seat.y + ahead * s)
        self.yaw: float = seat.yaw
        self.piece = seat.name
        self.takes = ((seat.x, seat.y),)
        self._heights = heights
        self._ahead_m, self._depth_m = ahead / actor.scale, seat.depth_m / actor.scale
        self._bare = SeatPlace(back_m=back / actor.scale, height_m=height / actor.scale)
        self._done_s = 0.0
        self._rises = False

    @property
    def word(self) -> Activity:
        """Word for it now."""
        if self._rises:
            return "getting up"
        return "seated" if self._done_s >= SIT_S else "sitting down"

    def advance(self, world_from_body: Doubles, moment: Moment) -> bool:
        """Continue by a step; return False once the person stands again."""
        self._done_s = min(self._done_s + (-STEP_S if self._rises else STEP_S), SIT_S)
        return self._done_s > 0.0

    def end(self) -> None:
        """Begin to get up."""
        self._rises = True

    def seated_posture(self) -> Posture:
        """Return the posture of one who sits, with the feet side by side."""
        return self._seated_on(self._seat)

    def _seated_on(self, seat: SeatPlace) -> Posture:
        feet = standing_feet(0.0, 0.0, 0.0, figure_of(self._rig).stride)
        return sitting_posture(self._rig, moment_of(feet), seat, 1.0, 0.0)

    @cached_property
    def _seat(self) -> SeatPlace:
        """The seat for this body: as much higher as its flesh and clothes are thick."""
        skin, found = contact_skin(self._actor.asset), self._bare
        numbers = [number for name, number in self._rig.joint_of.items() if name in _SEATED]
        sits = np.isin(skin.joints, numbers)
        for _ in range(_ROUNDS):
            places = skin.places(self._seated_on(found))[sits]
            depths = self._tops(places[:, :2]) - places[:, 2]
            deep_m = float(depths[depths < _BESIDE_M].max(initial=0.0))
            found = replace(found, height_m=found.height_m + max(deep_m - _SINK_M, 0.0))
        return found

    def _tops(self, places: Doubles) -> Doubles:
        """Return (N,): heights of the seat at (N, 2) places of the body frame [m]; -inf beside."""
        if self._heights is None:
            behind_m = -self._ahead_m - places[:, 0]
            over = (behind_m > 0.0) & (behind_m < self._depth_m)
            return np.where(over, self._bare.height_m, -np.inf)
        actor, (c, s) = self._actor, (float(np.cos(self.yaw)), float(np.sin(self.yaw)))
        world = actor.scale * places @ np.array([[c, s], [-s, c]]) + self.feet
        return np.asarray((self._heights(world) - actor.floor_m) / actor.scale)

    def posture(self, now: Instant) -> Posture:
        """Return the posture, in the frame of the body before the seat."""
        return sitting_posture(
            *(self._rig, now.moment, self._seat, min(self._done_s / SIT_S, 1.0), now.time_s),
            seed=now.seed,
            look=now.look,
        )


def seats_for(actor: Actor, crowd: Crowd) -> list[Seat]:
    """Return the seats that nobody else has taken."""
    return [seat for seat in crowd.seats() if crowd.is_free(actor.name, (seat.x, seat.y))]


def ways_to_sit(actor: Actor, crowd: Crowd, name: str) -> Iterator[Sitting]:
    """Yield the ways to sit on a piece."""
    highest = HIGHEST * actor.figure.leg_m * actor.scale
    for seat in seats_for(actor, crowd):
        if seat.name == name and seat.height_m - actor.floor_m <= highest:
            yield Sitting(actor, seat)
