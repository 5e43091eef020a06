"""A person's way through the world: where it walks, sits and looks, step by step.

Told by behaviours, moved by time. Knows the crowd around, and neither the engine nor skin.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours import STEP_S
from sailenv_ros.behaviours.person import Activity
from sailenv_ros.postures.figure import figure_of
from sailenv_ros.postures.footsteps import (
    Moment,
    Stride,
    Way,
    standing_feet,
    way_along,
    way_to_turn,
)
from sailenv_ros.postures.sitting import SIT_S, SeatPlace, seat_distance_m, sitting_posture
from sailenv_ros.postures.skeleton import Posture
from sailenv_ros.postures.walking import walking_posture
from sailenv_ros.space.free_space import BodySize
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.rig import Rig
from sailenv_ros.world.crowd import Crowd, body_size
from sailenv_ros.world.seats import Seat

__all__ = ["Walker"]

Doubles = NDArray[np.float64]
Place = tuple[float, float]

_BLOCKED_S = 1.2
"""Time for which one waits for another who is in the way [s]."""

_LEAST_WAY_M = 0.12
_STAND_OFF_M = 0.42
"""Distance from which one looks at a thing [m]."""

_FEET_BEFORE_M = 0.02


class Walker:
    """One person on its way; a `behaviours.person.Person`.

    Parameters
    ----------
    name : str
        Of the person.
    rig : Rig
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

    def __init__(self, name: str, rig: Rig, scale: float, pose: Pose) -> None:
        self._name, self._rig, self._scale = name, rig, scale
        self._figure = figure_of(rig)
        self.crowd: Crowd | None = None
        self.problem = ""
        self.pass_through: Callable[[str, bool], None] = lambda name, passes: None
        self._time_s = 0.0
        self._seat: Seat | None = None
        self.stand_at(pose)

    def stand_at(self, pose: Pose) -> None:
        """Stand at a pose from now on."""
        self.leave_seat()
        self._stand_at(pose)
        self.matrix = self.matrix_before = self._matrix_of_moment()

    def advance(self, time_s: float) -> None:
        """Do what is to be done in the step that begins at a simulated time [s]."""
        self._time_s = time_s + STEP_S
        self.matrix_before = self.matrix
        if self._way is not None:
            self._walk_on()
        elif self._seat is not None:
            self._sit_on()
        if self.crowd is not None:
            x, y = self._place
            self.crowd.people[self._name] = (x, y, self._radius_m)

    @property
    def posture(self) -> Posture:
        """Where its root and joints are now, in the body frame before the scale."""
        moment = self._moment().scaled(1.0 / self._scale)
        look = 0.0, 0.0
        if self._looks_at and self.crowd is not None:
            eyes_m = self._figure.height_m * self._scale
            look = self.crowd.look_deg(self._looks_at, self.matrix, eyes_m)
        seed = zlib.crc32(self._name.encode()) % 97
        if self._seat is not None and self._way is None:
            share = min(self._sit_s / SIT_S, 1.0)
            return sitting_posture(
                self._rig, moment, self._seat_place, share, self._time_s, seed=seed, look_deg=look
            )
        return walking_posture(self._rig, moment, self._time_s, seed=seed, look_deg=look)

    # -- what behaviours tell it (see behaviours.person.Person) --------------------------------

    @property
    def activity(self) -> Activity:
        """Activity now."""
        if self._way is not None:
            return "walking"
        if self._seat is None:
            return "standing"
        if self._rises:
            return "getting up"
        return "seated" if self._sit_s >= SIT_S else "sitting down"

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
        if self.crowd is None or self._seat is not None or self._way is not None:
            return False
        for seat in self._free_seats():
            if seat.name != name:
                continue
            floor = float(self.matrix[2, 3])
            height = seat.height_m - floor
            back = seat_distance_m(self._rig, height / self._scale) * self._scale
            if height > 0.95 * self._figure.leg_m * self._scale:
                continue
            ahead = max(back - min(seat.depth_m, 0.62 * back + 0.08), _FEET_BEFORE_M)
            c, s = float(np.cos(seat.yaw)), float(np.sin(seat.yaw))
            feet = (seat.x + ahead * c, seat.y + ahead * s)
            if not self._go(feet, seat.yaw):
                continue
            self._seat, self._sit_s, self._rises = seat, 0.0, False
            self._seat_place = SeatPlace(back_m=back / self._scale, height_m=height / self._scale)
            self.crowd.taken[self._name] = (seat.x, seat.y)
            self._pass_through_seat(passes=True)
            return True
        return False

    def get_up(self) -> None:
        """Begin to get up, if it sits."""
        if self._seat is not None and self._way is None:
            self._rises = True

    def seats(self) -> tuple[str, ...]:
        """Return the names of seats that nobody has taken."""
        return tuple(dict.fromkeys(seat.name for seat in self._free_seats()))

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
        return body_size(self._figure.height_m * 1.12 * self._scale, self._floor_m)

    @property
    def _place(self) -> Place:
        return float(self.matrix[0, 3]), float(self.matrix[1, 3])

    def _stand_at(self, pose: Pose) -> None:
        matrix = pose.matrix()
        self._floor_m = float(matrix[2, 3])
        yaw = float(np.arctan2(matrix[1, 0], matrix[0, 0]))
        width = self._figure.stride.width_m * self._scale
        self._feet = standing_feet(float(matrix[0, 3]), float(matrix[1, 3]), yaw, width)
        self._way = None
        self._way_s = 0.0
        self._waited_s = 0.0
        self._goal: tuple[Place, float | None] | None = None
        self._seat = None
        self._seat_place = SeatPlace(back_m=0.0, height_m=0.0)
        self._sit_s = 0.0
        self._rises = False
        self._looks_at = ""

    def _moment(self) -> Moment:
        if self._way is not None:
            return self._way.at(self._way_s)
        return Way(start=self._feet, prints=(), step_s=1.0).at(0.0)

    def _matrix_of_moment(self) -> Doubles:
        moment = self._moment()
        c, s = math.cos(moment.yaw), math.sin(moment.yaw)
        return np.array([
            [c, -s, 0.0, moment.x],
            [s, c, 0.0, moment.y],
            [0.0, 0.0, 1.0, self._floor_m],
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
        if self.crowd is None or self._seat is not None:
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
        stride = self._stride()
        way = Way(start=self._feet, prints=(), step_s=stride.step_s)
        line = np.array([self._place, *corners[1:]])
        length = float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())
        if length > _LEAST_WAY_M:
            first = line[1] - line[0]
            heading = float(np.arctan2(first[1], first[0]))
            way = self._turned(way, heading)
            way = way.then(way_along(way.feet_after(len(way.prints)), line, stride))
        if yaw is not None:
            way = self._turned(way, yaw)
        if not way.prints:
            return True
        self._way, self._way_s, self._waited_s = way, 0.0, 0.0
        self._looks_at = ""
        return True

    def _turned(self, way: Way, heading: float) -> Way:
        feet = way.feet_after(len(way.prints))
        now = Way(start=feet, prints=(), step_s=1.0).at(0.0).yaw
        if abs((heading - now + np.pi) % (2.0 * np.pi) - np.pi) < 0.35 and way.prints == ():
            return way
        if abs((heading - now + np.pi) % (2.0 * np.pi) - np.pi) < 0.02:
            return way
        return way.then(way_to_turn(feet, heading, self._stride()))

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
        seat = self._seat
        if goal is not None:
            corners = self.crowd.way(self._size, self._place, goal[0], discs)
        if corners is not None and goal is not None and self._follow(corners, goal[1]):
            return
        self.problem = "someone stands in the way"
        if seat is not None:
            self.leave_seat()
        # Put the feet side by side where it stands.
        yaw = self._moment().yaw
        way = way_to_turn(self._feet, yaw, self._stride())
        self._way, self._way_s, self._goal = way, 0.0, None

    def _sit_on(self) -> None:
        if not self._rises:
            self._sit_s = min(self._sit_s + STEP_S, SIT_S)
            return
        self._sit_s -= STEP_S
        if self._sit_s <= 0.0:
            self.leave_seat()

    def leave_seat(self) -> None:
        """Sit on nothing any more."""
        if self._seat is not None:
            self._pass_through_seat(passes=False)
        self._seat, self._sit_s, self._rises = None, 0.0, False
        if self.crowd is not None:
            self.crowd.taken.pop(self._name, None)

    def _pass_through_seat(self, *, passes: bool) -> None:
        if self._seat is not None:
            self.pass_through(self._seat.name, passes)

    def _free_seats(self) -> list[Seat]:
        if self.crowd is None:
            return []
        taken = [place for name, place in self.crowd.taken.items() if name != self._name]
        return [
            seat
            for seat in self.crowd.seats()
            if all(np.hypot(seat.x - x, seat.y - y) > 0.5 for x, y in taken)
        ]
