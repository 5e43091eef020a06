"""Ways of feet: prints on the floor, one after another, and what a body does between them.

A way is a list of prints of feet in turn. Between two prints one foot swings while the others
stand; a foot that stands keeps its print exactly, so feet do not slide. Of two feet 0 is the left
one and 1 the right one; of four these are in front, and 2 and 3 are behind them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sailenv_ros.postures.easing import smooth_step
from sailenv_ros.postures.polylines import Polyline

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

MOST_TURN_RAD = (0.9, 0.4)
"""Of one step on the spot, by two feet and by four [rad]."""

_TURN = 0.6
"""Share of a turn of one step on the spot that costs as much as a step ahead."""

_FOUR = (2, 0, 3, 1)
"""Order in which four feet step: each in front after the one behind it."""


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
    """Measures of steps.

    Attributes
    ----------
    length_m : float
        From a foot's print to the next one's.
    width_m : float
        Between the feet, across.
    step_s : float
        Time of a step.
    base_m : float
        From the feet behind to those in front; 0 for two feet.
    lead_m : float
        How far the body's place is ahead of the middle of its feet.
    """

    length_m: float
    width_m: float
    step_s: float
    base_m: float = 0.0
    lead_m: float = 0.0

    @property
    def order(self) -> tuple[int, ...]:
        """Feet in the order in which they step."""
        return _FOUR if self.base_m else (0, 1)

    def scaled(self, factor: float) -> Stride:
        """Return it in lengths that are so many times as large."""
        names = ("length_m", "width_m", "base_m", "lead_m")
        return replace(self, **{name: factor * getattr(self, name) for name in names})

    def foot(self, x: float, y: float, yaw: float, number: int) -> FootPrint:
        """Return the print of a foot that is in its place below a body."""
        across = 0.5 * self.width_m * (1.0 if number % 2 == 0 else -1.0)
        ahead = 0.5 * self.base_m * (1.0 if number < 2 else -1.0) - self.lead_m
        c, s = float(np.cos(yaw)), float(np.sin(yaw))
        return FootPrint(x + ahead * c - across * s, y + ahead * s + across * c, yaw)


@dataclass(frozen=True, slots=True, kw_only=True)
class Moment:
    """A body between two prints.

    Attributes
    ----------
    feet : tuple of FootPrint
        Where they stand, or stood before they swing.
    goal : FootPrint or None
        Where the swinging foot will stand.
    swinging : int
        Number of the swinging foot; -1 where all stand.
    share : float
        Of the step that is done, 0 to 1.
    x, y, yaw : float
        Of the body, on the floor.
    ahead_m, before_m : float
        Length of the step, and of the one before.
    swing_room : float
        Share of the swing of arms, or of a tail, that there is room for; they are held closer.
    """

    feet: tuple[FootPrint, ...]
    goal: FootPrint | None
    swinging: int
    share: float
    x: float
    y: float
    yaw: float
    ahead_m: float
    before_m: float = 0.0
    swing_room: float = 1.0

    def scaled(self, factor: float) -> Moment:
        """Return it in lengths that are so many times as large."""
        if factor == 1.0:
            return self
        return replace(
            self,
            feet=tuple(place.scaled(factor) for place in self.feet),
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
        Of all feet.
    prints : tuple of (int, FootPrint)
        Which foot, and where it is put.
    step_s : float
    lead_m : float
        As that of the `Stride`.
    """

    start: tuple[FootPrint, ...]
    prints: tuple[tuple[int, FootPrint], ...]
    step_s: float
    lead_m: float = 0.0

    @property
    def duration_s(self) -> float:
        """Time to go it [s]."""
        return len(self.prints) * self.step_s

    @property
    def steps_of_pace(self) -> int:
        """Number of steps after which the other side has its turn."""
        return len(self.start) // 2

    def feet_after(self, count: int) -> tuple[FootPrint, ...]:
        """Return where the feet stand after so many steps."""
        return self._feet[min(count, len(self.prints))]

    @cached_property
    def _feet(self) -> tuple[tuple[FootPrint, ...], ...]:
        """Where the feet stand after each number of steps."""
        found = [self.start]
        for side, place in self.prints:
            found.append(_stepped(found[-1], side, place))
        return tuple(found)

    def at(self, time_s: float) -> Moment:
        """Return the body at a time since the beginning [s]."""
        number = int(time_s / self.step_s)
        if time_s < 0.0:
            number = 0
        if number >= len(self.prints):
            feet = self.feet_after(len(self.prints))
            return moment_of(feet, self.lead_m)
        share = min(max(time_s / self.step_s - number, 0.0), 1.0)
        feet = self.feet_after(number)
        side, goal = self.prints[number]
        after = _stepped(feet, side, goal)
        now, later = _middle(feet, self.lead_m), _middle(after, self.lead_m)
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


def moment_of(feet: tuple[FootPrint, ...], lead_m: float = 0.0) -> Moment:
    """Return a body whose feet stand; `lead_m` is that of its `Stride`."""
    x, y, yaw = _middle(feet, lead_m)
    return Moment(feet=feet, goal=None, swinging=-1, share=0.0, x=x, y=y, yaw=yaw, ahead_m=0.0)


def way_to_turn(feet: tuple[FootPrint, ...], yaw: float, stride: Stride) -> Way:
    """Return steps on the spot until the body points a way [rad]."""
    x, y, now = _middle(feet, stride.lead_m)
    turn = _turn(now, yaw)
    count = max(1, int(np.ceil(abs(turn) / MOST_TURN_RAD[bool(stride.base_m)])))
    # First a foot on the side to which the body turns.
    order = [foot if turn > 0.0 else foot ^ 1 for foot in stride.order]
    prints: list[tuple[int, FootPrint]] = []
    for number in range(1, count + 1):
        heading = now + turn * number / count
        prints += ((foot, stride.foot(x, y, heading, foot)) for foot in order)
    return Way(start=feet, prints=tuple(prints), step_s=0.8 * stride.step_s, lead_m=stride.lead_m)


def way_along(feet: tuple[FootPrint, ...], corners: ArrayLike, stride: Stride) -> Way:
    """Return steps along a line from where the feet stand, with feet side by side at its end.

    Parameters
    ----------
    corners : (N, 2) floats
        Of the line [m]; it begins where the body is.
    """
    line = Polyline(np.asarray(corners, np.float64)[:, :2])
    order = stride.order
    turn_rad = _TURN * MOST_TURN_RAD[bool(stride.base_m)]
    # At the end the other feet come to stand beside the last one.
    ways_m = np.append(line.stops(stride.length_m, turn_rad), [line.length_m] * (len(order) - 1))
    prints = []
    for number, ((x, y), heading) in enumerate(
        zip(line.at(ways_m).tolist(), line.headings(ways_m).tolist(), strict=True)
    ):
        foot = order[number % len(order)]
        prints.append((foot, stride.foot(x, y, heading, foot)))
    return Way(start=feet, prints=tuple(prints), step_s=stride.step_s, lead_m=stride.lead_m)


def way_to_stand(
    feet: tuple[FootPrint, ...], line: Doubles, yaw: float | None, stride: Stride
) -> Way:
    """Return steps along a line: turns to it first where that is needed, and at its end.

    Parameters
    ----------
    line : (N, 2) float64
        From where the body is [m].
    yaw : float or None
        Which way the body looks at the end [rad]; None for any.
    """
    way = Way(start=feet, prints=(), step_s=stride.step_s, lead_m=stride.lead_m)
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


def standing_feet(x: float, y: float, yaw: float, stride: Stride) -> tuple[FootPrint, ...]:
    """Return feet side by side."""
    return tuple(stride.foot(x, y, yaw, number) for number in range(len(stride.order)))


def _distance(one: FootPrint, other: FootPrint) -> float:
    return float(np.hypot(other.x - one.x, other.y - one.y))


def _stepped(feet: tuple[FootPrint, ...], number: int, place: FootPrint) -> tuple[FootPrint, ...]:
    """Return feet of which one has stepped to a place."""
    return (*feet[:number], place, *feet[number + 1 :])


def _middle(feet: Sequence[FootPrint], lead_m: float = 0.0) -> tuple[float, float, float]:
    def mean(parts: Iterable[float]) -> float:
        return sum(parts) / len(feet)

    first = feet[0].yaw
    yaw = first + mean(_turn(first, foot.yaw) for foot in feet)
    x, y = mean(foot.x for foot in feet), mean(foot.y for foot in feet)
    return x + lead_m * float(np.cos(yaw)), y + lead_m * float(np.sin(yaw)), yaw


def _turn(start: float, end: float) -> float:
    return float((end - start + np.pi) % (2.0 * np.pi) - np.pi)
