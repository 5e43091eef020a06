"""Ways of feet: prints on the floor, one after another, and what a body does between them.

A way is a list of prints of alternating feet. Between two prints one foot swings while the other
stands; a foot that stands keeps its print exactly, so feet do not slide.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sailenv_ros.postures.easing import smooth_step

__all__ = [
    "FootPrint",
    "Moment",
    "Stride",
    "Way",
    "moment_of",
    "standing_feet",
    "way_along",
    "way_to_stand",
    "way_to_turn",
]

Doubles = NDArray[np.float64]

_LEAST_WAY_M = 0.12

MOST_TURN_RAD = 0.9
"""Of one step on the spot [rad]."""

_SIDES = ("L", "R")


@dataclass(frozen=True, slots=True)
class FootPrint:
    """Where a foot stands: below its ankle [m], and which way it points [rad]."""

    x: float
    y: float
    yaw: float

    def scaled(self, factor: float) -> FootPrint:
        """Return it in lengths that are so many times as large."""
        return FootPrint(self.x * factor, self.y * factor, self.yaw)


@dataclass(frozen=True, slots=True, kw_only=True)
class Stride:
    """Measures of a person's steps.

    Attributes
    ----------
    length_m : float
        From a foot's print to the other's.
    width_m : float
        Between the feet, across.
    step_s : float
        Time of a step.
    """

    length_m: float
    width_m: float
    step_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Moment:
    """A body between two prints.

    Attributes
    ----------
    feet : tuple of FootPrint
        Left and right: where they stand, or stood before they swing.
    goal : FootPrint or None
        Where the swinging foot will stand.
    swinging : int
        0 left, 1 right; -1 where both stand.
    share : float
        Of the step that is done, 0 to 1.
    x, y, yaw : float
        Of the body, on the floor.
    ahead_m, before_m : float
        Length of the step, and of the one before.
    """

    feet: tuple[FootPrint, FootPrint]
    goal: FootPrint | None
    swinging: int
    share: float
    x: float
    y: float
    yaw: float
    ahead_m: float
    before_m: float = 0.0

    def scaled(self, factor: float) -> Moment:
        """Return it in lengths that are so many times as large."""
        if factor == 1.0:
            return self
        left, right = (place.scaled(factor) for place in self.feet)
        return replace(
            self,
            feet=(left, right),
            goal=None if self.goal is None else self.goal.scaled(factor),
            x=self.x * factor,
            y=self.y * factor,
            ahead_m=self.ahead_m * factor,
            before_m=self.before_m * factor,
        )


@dataclass(frozen=True, kw_only=True)
class Way:
    """Steps from where the feet stand.

    Attributes
    ----------
    start : tuple of FootPrint
        Left and right.
    prints : tuple of (int, FootPrint)
        Which foot, and where it is put.
    step_s : float
    """

    start: tuple[FootPrint, FootPrint]
    prints: tuple[tuple[int, FootPrint], ...]
    step_s: float

    @property
    def duration_s(self) -> float:
        """Time to go it [s]."""
        return len(self.prints) * self.step_s

    def feet_after(self, count: int) -> tuple[FootPrint, FootPrint]:
        """Return where the feet stand after so many steps."""
        return self._feet[min(count, len(self.prints))]

    @cached_property
    def _feet(self) -> tuple[tuple[FootPrint, FootPrint], ...]:
        """Where the feet stand after each number of steps."""
        found = [self.start]
        for side, place in self.prints:
            left, right = found[-1]
            found.append((place, right) if side == 0 else (left, place))
        return tuple(found)

    def at(self, time_s: float) -> Moment:
        """Return the body at a time since the beginning [s]."""
        number = int(time_s / self.step_s)
        if time_s < 0.0:
            number = 0
        if number >= len(self.prints):
            feet = self.feet_after(len(self.prints))
            return moment_of(feet)
        share = min(max(time_s / self.step_s - number, 0.0), 1.0)
        feet = self.feet_after(number)
        side, goal = self.prints[number]
        then = (goal, feet[1]) if side == 0 else (feet[0], goal)
        now, later = _middle(feet), _middle(then)
        eased = share
        if number == 0:
            eased = share * share * (2.0 - share)  # from rest
        if number == len(self.prints) - 1:
            eased = 1.0 - (1.0 - eased) ** 2 * (1.0 + eased) if number else smooth_step(share)
        x, y = (a + eased * (b - a) for a, b in zip(now[:2], later[:2], strict=True))
        yaw = now[2] + eased * _turn(now[2], later[2])
        return Moment(
            feet=feet,
            goal=goal,
            swinging=side,
            share=share,
            x=x,
            y=y,
            yaw=yaw,
            ahead_m=_distance(feet[side], goal),
            before_m=self._length_of(number - 1),
        )

    def _length_of(self, number: int) -> float:
        if number < 0:
            return 0.0
        side, goal = self.prints[number]
        return _distance(self.feet_after(number)[side], goal)

    def then(self, other: Way) -> Way:
        """Return this way and another one that begins where it ends."""
        return replace(self, prints=self.prints + other.prints)


def moment_of(feet: tuple[FootPrint, FootPrint]) -> Moment:
    """Return a body whose feet stand."""
    x, y, yaw = _middle(feet)
    return Moment(feet=feet, goal=None, swinging=-1, share=0.0, x=x, y=y, yaw=yaw, ahead_m=0.0)


def way_to_turn(feet: tuple[FootPrint, FootPrint], yaw: float, stride: Stride) -> Way:
    """Return steps on the spot until the body points a way [rad]."""
    x, y, now = _middle(feet)
    turn = _turn(now, yaw)
    count = max(1, int(np.ceil(abs(turn) / MOST_TURN_RAD)))
    first = 0 if turn > 0.0 else 1  # the foot on the side to which the body turns
    prints: list[tuple[int, FootPrint]] = []
    for number in range(1, count + 1):
        heading = now + turn * number / count
        for side in (first, 1 - first):
            prints.append((side, _beside(x, y, heading, side, stride.width_m)))
    return Way(start=feet, prints=tuple(prints), step_s=0.8 * stride.step_s)


def way_along(feet: tuple[FootPrint, FootPrint], corners: ArrayLike, stride: Stride) -> Way:
    """Return steps along a line from where the feet stand, with feet side by side at its end.

    Parameters
    ----------
    corners : (N, 2) floats
        Of the line [m]; it begins where the body is.
    """
    line = _Line(np.asarray(corners, np.float64)[:, :2])
    length = line.length_m
    count = max(1, int(np.ceil(length / stride.length_m)))
    step = length / count
    prints = []
    side = 0
    for number in range(1, count + 1):
        x, y = line.at(number * step)
        prints.append((side, _beside(x, y, line.heading(number * step), side, stride.width_m)))
        side = 1 - side
    x, y = line.at(length)
    prints.append((side, _beside(x, y, line.heading(length), side, stride.width_m)))
    return Way(start=feet, prints=tuple(prints), step_s=stride.step_s)


def way_to_stand(
    feet: tuple[FootPrint, FootPrint], line: Doubles, yaw: float | None, stride: Stride
) -> Way:
    """Return steps along a line: turns to it first where that is needed, and at its end.

    Parameters
    ----------
    line : (N, 2) float64
        From where the body is [m].
    yaw : float or None
        Which way the body looks at the end [rad]; None for any.
    """
    way = Way(start=feet, prints=(), step_s=stride.step_s)
    length = float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())
    if length > _LEAST_WAY_M:
        first = line[1] - line[0]
        way = _turned(way, float(np.arctan2(first[1], first[0])), stride)
        way = way.then(way_along(way.feet_after(len(way.prints)), line, stride))
    return way if yaw is None else _turned(way, yaw, stride)


def _turned(way: Way, heading: float, stride: Stride) -> Way:
    feet = way.feet_after(len(way.prints))
    turn = abs(_turn(moment_of(feet).yaw, heading))
    if turn < (0.02 if way.prints else 0.35):
        return way
    return way.then(way_to_turn(feet, heading, stride))


class _Line:
    """Corners of a line, by the way along it."""

    def __init__(self, corners: Doubles) -> None:
        self._corners = corners
        self._ways = np.concatenate(
            [[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))]
        )

    @property
    def length_m(self) -> float:
        return float(self._ways[-1])

    def at(self, way_m: float) -> tuple[float, float]:
        x, y = (np.interp(way_m, self._ways, self._corners[:, k]) for k in (0, 1))
        return float(x), float(y)

    def heading(self, way_m: float, window_m: float = 0.3) -> float:
        before = self.at(max(way_m - window_m, 0.0))
        after = self.at(min(way_m + window_m, self.length_m))
        return float(np.arctan2(after[1] - before[1], after[0] - before[0]))


def standing_feet(x: float, y: float, yaw: float, width_m: float) -> tuple[FootPrint, FootPrint]:
    """Return feet side by side."""
    left, right = (_beside(x, y, yaw, side, width_m) for side in (0, 1))
    return left, right


def _distance(one: FootPrint, other: FootPrint) -> float:
    return float(np.hypot(other.x - one.x, other.y - one.y))


def _beside(x: float, y: float, yaw: float, side: int, width_m: float) -> FootPrint:
    across = 0.5 * width_m * (1.0 if side == 0 else -1.0)
    return FootPrint(x - across * float(np.sin(yaw)), y + across * float(np.cos(yaw)), yaw)


def _middle(feet: Sequence[FootPrint]) -> tuple[float, float, float]:
    left, right = feet
    yaw = left.yaw + 0.5 * _turn(left.yaw, right.yaw)
    return 0.5 * (left.x + right.x), 0.5 * (left.y + right.y), yaw


def _turn(start: float, end: float) -> float:
    return float((end - start + np.pi) % (2.0 * np.pi) - np.pi)
