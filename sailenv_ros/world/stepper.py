"""Steps of a person or an animal: the way that it goes, foot by foot, round others, to its end.

Knows the crowd around, and not the engine; what is done where a way ends is told elsewhere.
"""

from __future__ import annotations

import zlib
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours import STEP_S
from sailenv_ros.postures.easing import smooth_step
from sailenv_ros.postures.footsteps import (
    FootPrint,
    Moment,
    Stride,
    Way,
    moment_of,
    standing_feet,
    way_to_stand,
    way_to_turn,
)
from sailenv_ros.postures.gaits import gait_of
from sailenv_ros.space.free_space import BodySize, FreeSpace
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import Asset
from sailenv_ros.world.activities.base import Actor, matrix_of
from sailenv_ros.world.attention import Attention
from sailenv_ros.world.crowd import Crowd, body_size
from sailenv_ros.world.ways import Disc, Place

__all__ = ["Place", "Stepper", "yaw_of"]

Doubles = NDArray[np.float64]

_BLOCKED_S = 1.2
"""Time for which one waits for another who is in the way [s]."""


_ROUND_M = 0.05
"""Added to the radius of another whom one goes round: steps cut corners [m]."""


class Stepper:
    """One person, or an animal, on its feet.

    Parameters
    ----------
    name : str
        Of it.
    asset : Asset
        With a rig.
    scale : float

    Attributes
    ----------
    crowd : Crowd or None
        What it knows of the world; without it, it stands.
    problem : str
        Why it has not arrived where it was last sent; empty if it has.
    matrix : (4, 4) float64
        World from the body now.
    """

    _way: Way | None
    matrix: Doubles

    def __init__(self, name: str, asset: Asset, scale: float) -> None:
        self._name, self._scale = name, scale
        self._actor = Actor(name=name, asset=asset, scale=scale, floor_m=0.0)
        self._gait = gait_of(asset)
        self.crowd: Crowd | None = None
        self.problem = ""
        self._seed = zlib.crc32(name.encode()) % 97
        eyes_m = self._gait.eyes_m * scale
        on_four = self._actor.rig.legs == 4
        self._attention = Attention(name, self._seed, eyes_m, by_itself=on_four)

    @property
    def _radius_m(self) -> float:
        return self._size.radius_m

    @property
    def _size(self) -> BodySize:
        gait = self._gait
        return body_size(gait.height_m * self._scale, gait.radius, self._actor.floor_m)

    @property
    def _place(self) -> Place:
        return float(self.matrix[0, 3]), float(self.matrix[1, 3])

    def _stand_at(self, pose: Pose) -> None:
        matrix = pose.matrix()
        self._actor = replace(self._actor, floor_m=float(matrix[2, 3]))
        self._feet = self._feet_at(matrix)
        self._way = None
        self._way_s = 0.0
        self._waited_s = 0.0
        self._swings: tuple[float, float] | None = None
        self._space: FreeSpace | None = None
        self._goal: tuple[Place, float | None] | None = None
        self._attention.forget()
        self.matrix = self._matrix_of_moment()

    def _feet_at(self, matrix: Doubles) -> tuple[FootPrint, ...]:
        x, y = float(matrix[0, 3]), float(matrix[1, 3])
        return standing_feet(x, y, yaw_of(matrix), self._stride())

    def _moment(self) -> Moment:
        if self._way is not None:
            return self._way.at(self._way_s)
        return moment_of(self._feet, self._stride().lead_m)

    def _own_moment(self) -> Moment:
        """Return it before the scale."""
        return self._with_swing(self._moment().scaled(1.0 / self._scale))

    def _matrix_of_moment(self) -> Doubles:
        return matrix_of(self._moment(), self._actor.floor_m)

    def _stride(self) -> Stride:
        return self._gait.stride.scaled(self._scale)

    def _go(self, place: Place, yaw: float | None, *, round_others: bool) -> bool:
        """Begin to go to a place; round where others are now, or as if they went away."""
        if self.crowd is None:
            return False
        others = self._others() if round_others else ()
        corners = self.crowd.way(self._size, self._place, place, others)
        self._goal = (place, yaw)
        return self._follow(corners, yaw)

    def _others(self) -> list[Disc]:
        """Return what others take, and what one who goes round them keeps free."""
        assert self.crowd is not None
        return [(x, y, radius + _ROUND_M) for x, y, radius in self.crowd.discs(self._name)]

    def _follow(self, corners: list[Place] | None, yaw: float | None) -> bool:
        """Begin to go along corners; turn to them first, and at the end."""
        if corners is None:
            self.problem = "no way leads there"
            return False
        self.problem = ""
        line = np.array([self._place, *corners[1:]])
        way = way_to_stand(self._feet, line, yaw, self._stride())
        if not way.prints:
            return True
        self._way, self._way_s, self._waited_s = way, 0.0, 0.0
        # The map that the way was found in: a new one at each step would cost more than the walk.
        self._space = None if self.crowd is None else self.crowd.free_space(self._size)
        self._attention.target = ""
        return True

    def _walk_on(self) -> None:
        way = self._way
        assert way is not None
        number, later = (int(t / way.step_s + 1e-9) for t in (self._way_s, self._way_s + STEP_S))
        if later > number or self._way_s == 0.0:
            if self._is_blocked(way, later):
                self._wait(way, later)
                return
            self._waited_s = 0.0
            _, now = self._swings_here()
            within = [way.at((later + share) * way.step_s) for share in (0.0, 0.5, 1.0)]
            self._swings = now, min(map(self._swing_at, within))
        self._way_s += STEP_S
        if self._way_s >= way.duration_s:
            self._feet = way.feet_after(len(way.prints))
            self._way = None
        self.matrix = self._matrix_of_moment()

    def _is_blocked(self, way: Way, number: int) -> bool:
        """Return whether another is in the way; nobody is of steps on the spot."""
        if self.crowd is None or self._goal is None:
            return False
        return self.crowd.blocks(self._name, self._radius_m, way, number)

    def _swing_at(self, moment: Moment) -> float:
        """Return the share of their swing that arms, or a tail, have room for."""
        space = self._space
        if space is None:
            return 1.0
        cell = space.cell_of((moment.x, moment.y))
        room_m = 0.0 if cell is None else float(space.clearance_m[cell])
        least = self._gait.least_swing
        return min(least + (1.0 - least) * room_m / (self._gait.swing_m * self._scale), 1.0)

    def _swings_here(self) -> tuple[float, float]:
        """Return the shares of their swing at the begin and the end of this step."""
        if self._swings is None:
            if self.crowd is None:  # nothing has happened yet, and nothing is known of the room
                return 1.0, 1.0
            self._space = self.crowd.free_space(self._size)
            swing = self._swing_at(self._moment())
            self._swings = swing, swing
        return self._swings

    def _with_swing(self, moment: Moment) -> Moment:
        """Return it with the swing of arms now: from step to step it changes smoothly."""
        before, after = self._swings_here()
        done = 1.0 if self._way is None else smooth_step(moment.share)
        return replace(moment, swing_room=before + (after - before) * done)

    def _wait(self, way: Way, number: int) -> None:
        """Stand where a step has ended; go round who stands in the way, or give up."""
        self._waited_s += STEP_S
        if self._waited_s < _BLOCKED_S:
            return
        assert self.crowd is not None
        self._feet = way.feet_after(number)
        self._way, self._waited_s = None, 0.0
        if self._goal is not None and self._go(*self._goal, round_others=True):
            return
        self.problem = "someone stands in the way"
        self._stopped()
        # Put the feet side by side where it stands.
        yaw = self._moment().yaw
        way = way_to_turn(self._feet, yaw, self._stride())
        self._way, self._way_s, self._goal = way, 0.0, None

    def _stopped(self) -> None:
        """Give up what was to be done at the end of the way."""


def yaw_of(matrix: Doubles) -> float:
    """Return which way a body looks [rad]."""
    return float(np.arctan2(matrix[1, 0], matrix[0, 0]))
