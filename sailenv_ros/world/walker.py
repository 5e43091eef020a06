"""A person's way through the world: where it walks and looks, and what it does on the spot.

Told by behaviours, moved by time. Knows the crowd around, and not the engine. What it does where a
way ends is an activity of `world.activities`.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours import STEP_S
from sailenv_ros.behaviours.person import Activity, ClipPlay
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
from sailenv_ros.postures.skeleton import Posture
from sailenv_ros.postures.walking import walking_posture
from sailenv_ros.space.free_space import BodySize
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import Asset
from sailenv_ros.world.activities.base import Actor, Instant, SpotActivity
from sailenv_ros.world.activities.lying import lanes_for, ways_to_lie
from sailenv_ros.world.activities.playing import Playing
from sailenv_ros.world.activities.sitting import seats_for, ways_to_sit
from sailenv_ros.world.crowd import Crowd, body_size

__all__ = ["Walker"]

Doubles = NDArray[np.float64]
Place = tuple[float, float]

_BLOCKED_S = 1.2
"""Time for which one waits for another who is in the way [s]."""

_STAND_OFF_M = 0.42
"""Distance from which one looks at a thing [m]."""


class Walker:
    """One person on its way; a `behaviours.person.Person`.

    Parameters
    ----------
    name : str
        Of the person.
    asset : Asset
        With a rig.
    scale : float
    pose : Pose
        Where it stands at first.

    Attributes
    ----------
    crowd : Crowd or None
        What it knows of the world; without it, it stands.
    problem : str
        Why it has not arrived where it was last sent; empty if it has.
    matrix, matrix_before : (4, 4) float64
        World from the body now, and a step ago.
    pass_through : callable
        ``pass_through(name, passes)`` lets limbs pass through a piece of furniture, or not.
    """

    _way: Way | None

    def __init__(self, name: str, asset: Asset, scale: float, pose: Pose) -> None:
        self._name, self._scale = name, scale
        self._actor = Actor(name=name, asset=asset, scale=scale, floor_m=0.0)
        self._figure = self._actor.figure
        self.crowd: Crowd | None = None
        self.problem = ""
        self.pass_through: Callable[[str, bool], None] = lambda name, passes: None
        self._time_s = 0.0
        self._does: SpotActivity | None = None
        self.stand_at(pose)

    def stand_at(self, pose: Pose) -> None:
        """Stand at a pose from now on."""
        self.leave()
        self._stand_at(pose)
        self.matrix = self.matrix_before = self._matrix_of_moment()

    def advance(self, time_s: float) -> None:
        """Do what is to be done in the step that begins at a simulated time [s]."""
        self._time_s = time_s + STEP_S
        self.matrix_before = self.matrix
        if self._way is not None:
            self._walk_on()
        elif self._does is not None:
            goes_on = self._does.advance(self.matrix)
            self.matrix = self._does.moved(self._matrix_of_moment())
            if not goes_on:
                self.leave()
        if self.crowd is not None:
            x, y = self._place
            self.crowd.people[self._name] = (x, y, self._radius_m)

    @property
    def posture(self) -> Posture:
        """Where its root and joints are now, in the body frame before the scale."""
        look = 0.0, 0.0
        if self._looks_at and self.crowd is not None:
            eyes_m = self._figure.height_m * self._scale
            look = self.crowd.look_deg(self._looks_at, self.matrix, eyes_m)
        now = Instant(
            moment=self._moment().scaled(1.0 / self._scale),
            time_s=self._time_s,
            seed=zlib.crc32(self._name.encode()) % 97,
            look_deg=look,
        )
        if self._does is not None and self._way is None:
            return self._does.posture(now)
        return walking_posture(
            self._actor.rig, now.moment, now.time_s, seed=now.seed, look_deg=now.look_deg
        )

    # -- what behaviours tell it (see behaviours.person.Person) --------------------------------

    @property
    def activity(self) -> Activity:
        """Activity now."""
        if self._way is not None:
            return "walking"
        return "standing" if self._does is None else self._does.word

    def random_place(self, rng: np.random.Generator) -> Place | None:
        """Return a free place that it can reach [m]; None if there is none."""
        if self.crowd is None:
            return None
        return self.crowd.random_place(self._size, self._place, rng)

    def walk_to(self, place: Place) -> bool:
        """Begin to walk to a place [m]; False, and nothing begins, if no way leads there."""
        return self._go(place, None)

    def walk_near(self, name: str) -> bool:
        """Begin to walk to where it stands before an object and faces it; False if it cannot."""
        if self.crowd is None:
            return False
        before = self.crowd.before(name, _STAND_OFF_M + self._radius_m)
        return before is not None and self._go(*before)

    def sit_on(self, name: str) -> bool:
        """Begin to walk to a seat and sit down; False if it cannot."""
        return self.crowd is not None and self._go_and(ways_to_sit(self._actor, self.crowd, name))

    def lie_on(self, name: str) -> bool:
        """Begin to walk to a bed and lie down; False if it cannot."""
        return self.crowd is not None and self._go_and(ways_to_lie(self._actor, self.crowd, name))

    def play(self, play: ClipPlay) -> bool:
        """Begin to walk to where a clip is played, and play it; False if it cannot."""
        if self.crowd is None:
            return False
        playing = Playing(self._actor, play, self._place, _yaw_of(self.matrix))
        if not self.crowd.is_clear(self._size, playing.way()):
            self.problem = f"there is no room for the clip {play.clip!r}"
            return False
        return self._go_and([playing])

    def get_up(self) -> None:
        """Begin to get up, if it sits or lies."""
        if self._does is not None and self._way is None:
            self._does.end()

    def seats(self) -> tuple[str, ...]:
        """Return the names of seats that nobody has taken."""
        if self.crowd is None:
            return ()
        return tuple(dict.fromkeys(seat.name for seat in seats_for(self._actor, self.crowd)))

    def beds(self) -> tuple[str, ...]:
        """Return the names of what it can lie on and nobody has taken."""
        if self.crowd is None:
            return ()
        lanes = lanes_for(self._actor, self.crowd)
        return tuple(dict.fromkeys(lane.name for lane, _ in lanes))

    def things(self) -> tuple[str, ...]:
        """Return the names of furniture that one may look at."""
        return () if self.crowd is None else self.crowd.things()

    def look_at(self, name: str) -> None:
        """Look at an object from now on; the empty name looks ahead."""
        self._looks_at = name

    # -- inside ----------------------------------------------------------------------------

    @property
    def _radius_m(self) -> float:
        return self._size.radius_m

    @property
    def _size(self) -> BodySize:
        return body_size(self._figure.height_m * 1.12 * self._scale, self._actor.floor_m)

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
        self._goal: tuple[Place, float | None] | None = None
        self._looks_at = ""

    def _feet_at(self, matrix: Doubles) -> tuple[FootPrint, FootPrint]:
        width = self._figure.stride.width_m * self._scale
        return standing_feet(float(matrix[0, 3]), float(matrix[1, 3]), _yaw_of(matrix), width)

    def _moment(self) -> Moment:
        if self._way is not None:
            return self._way.at(self._way_s)
        return moment_of(self._feet)

    def _matrix_of_moment(self) -> Doubles:
        moment = self._moment()
        c, s = math.cos(moment.yaw), math.sin(moment.yaw)
        return np.array([
            [c, -s, 0.0, moment.x],
            [s, c, 0.0, moment.y],
            [0.0, 0.0, 1.0, self._actor.floor_m],
            [0.0, 0.0, 0.0, 1.0],
        ])  # fmt: skip

    def _stride(self) -> Stride:
        stride = self._figure.stride
        return replace(
            stride,
            length_m=stride.length_m * self._scale,
            width_m=stride.width_m * self._scale,
        )

    def _go(self, place: Place, yaw: float | None) -> bool:
        if self.crowd is None or self._does is not None:
            return False
        corners = self.crowd.way(self._size, self._place, place)
        self._goal = (place, yaw)
        return self._follow(corners, yaw)

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
        self._looks_at = ""
        return True

    def _walk_on(self) -> None:
        way = self._way
        assert way is not None
        number, later = (int(t / way.step_s + 1e-9) for t in (self._way_s, self._way_s + STEP_S))
        if later > number or self._way_s == 0.0:
            if self.crowd is not None and self.crowd.blocks(self._name, self._radius_m, way, later):
                self._wait(way, later)
                return
            self._waited_s = 0.0
        self._way_s += STEP_S
        if self._way_s >= way.duration_s:
            self._feet = way.feet_after(len(way.prints))
            self._way = None
        self.matrix = self._matrix_of_moment()

    def _wait(self, way: Way, number: int) -> None:
        """Stand where a step has ended; go round who stands in the way, or give up."""
        self._waited_s += STEP_S
        if self._waited_s < _BLOCKED_S:
            return
        assert self.crowd is not None
        self._feet = way.feet_after(number)
        self._way, self._waited_s = None, 0.0
        discs = self.crowd.discs(self._name)
        corners, goal = None, self._goal
        if goal is not None:
            corners = self.crowd.way(self._size, self._place, goal[0], discs)
        if corners is not None and goal is not None and self._follow(corners, goal[1]):
            return
        self.problem = "someone stands in the way"
        self.leave()
        # Put the feet side by side where it stands.
        yaw = self._moment().yaw
        way = way_to_turn(self._feet, yaw, self._stride())
        self._way, self._way_s, self._goal = way, 0.0, None

    def _go_and(self, ways: Iterable[SpotActivity]) -> bool:
        """Begin to go where something is done, by the first way to do it that can be reached."""
        if self.crowd is None or self._does is not None or self._way is not None:
            return False
        for activity in ways:
            if self._go(activity.feet, activity.yaw):
                self._does = activity
                self.crowd.taken[self._name] = activity.takes
                if activity.piece:
                    self.pass_through(activity.piece, True)
                return True
        return False

    def leave(self) -> None:
        """Do nothing on the spot any more."""
        if self._does is not None and self._does.travels and self._way is None:
            self._feet = self._feet_at(self.matrix)
        if self._does is not None and self._does.piece:
            self.pass_through(self._does.piece, False)
        self._does = None
        if self.crowd is not None:
            self.crowd.taken.pop(self._name, None)


def _yaw_of(matrix: Doubles) -> float:
    return float(np.arctan2(matrix[1, 0], matrix[0, 0]))
