"""Joints: how one is at an instant, and what it does by itself near an end or at detents.

States are made by `world/` and answer requests of clients. Knows no engine and no message.
Positions are in radians for hinges and in metres for slides, as in URDF and sensor_msgs/JointState.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal, TypeAlias

from sailenv_ros.types.validation import Bounds, check_bounds

__all__ = ["JOINT_LIMITS", "Detents", "JointKind", "JointState", "SoftClose"]

JointKind: TypeAlias = Literal["hinge", "slide"]

JOINT_LIMITS: Mapping[str, Bounds] = {
    "within": Bounds(least=1e-4, most=1e4),
    "speed": Bounds(above=0.0, most=1e3),
    "strength": Bounds(above=0.0, most=1e6),
}
"""Bounds of each number of a soft close and of detents."""

_ROUNDING = 1e-9
"""Share of the spacing by which a detent at a limit may be beyond it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SoftClose:
    """A damper and a spring that shut a joint near one of its ends.

    Attributes
    ----------
    within : float
        Distance from the end at which they begin to act [rad] or [m].
    speed : float
        Greatest speed at the end, and that with which the spring shuts [rad/s] or [m/s].
    strength : float
        Torque [N m] or force [N] of the spring, less friction.
    end : {'low', 'high'}
        The limit at which the joint is shut.

    Raises
    ------
    InvalidRequest
        If a number is out of its range.
    """

    within: float
    speed: float
    strength: float = 2.0
    end: Literal["low", "high"] = "low"

    def __post_init__(self) -> None:
        check_bounds(self, JOINT_LIMITS, before="soft close's ")

    def scaled(self, factor: float) -> SoftClose:
        """Return that of a slide that goes farther by a factor."""
        return replace(self, within=self.within * factor)


@dataclass(frozen=True, slots=True, kw_only=True)
class Detents:
    """Positions at which a joint clicks.

    Attributes
    ----------
    strength : float
        Torque [N m] or force [N] that takes it out of one, friction included. Half of it pulls in.
    every : float or None
        Distance between detents, counted from position 0 [rad] or [m]; None: those of `at`.
    at : tuple of float
        Positions [rad] or [m].
    within : float or None
        Distance at which a detent pulls [rad] or [m]; None: half of `every`, or of the least
        distance between two of `at`.

    Raises
    ------
    InvalidRequest
        If a number is out of its range.
    """

    strength: float
    every: float | None = None
    at: tuple[float, ...] = ()
    within: float | None = None

    def __post_init__(self) -> None:
        check_bounds(self, {"strength": JOINT_LIMITS["strength"]}, before="detents' ")

    @property
    def reach(self) -> float:
        """Distance at which a detent pulls [rad] or [m]."""
        if self.within is not None:
            return self.within
        places = sorted(self.at)
        gaps = [second - first for first, second in pairwise(places)]
        return 0.5 * (self.every or min(gaps, default=0.0))

    def nearest(self, position: float, low: float, high: float) -> float:
        """Return the detent that is nearest to a position, within limits [rad] or [m]."""
        if self.every is None:
            return min(self.at, key=lambda place: abs(place - position))
        number = round(position / self.every)
        if low > -math.inf:
            number = max(number, math.ceil(low / self.every - _ROUNDING))
        if high < math.inf:
            number = min(number, math.floor(high / self.every + _ROUNDING))
        return number * self.every

    def scaled(self, factor: float) -> Detents:
        """Return those of a slide that goes farther by a factor."""
        return replace(
            self,
            every=None if self.every is None else self.every * factor,
            at=tuple(place * factor for place in self.at),
            within=None if self.within is None else self.within * factor,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class JointState:
    """One joint at one instant.

    Attributes
    ----------
    id : int
        Instance id of the object that moves on it.
    name : str
        That object's name, which is the joint's.
    type : {'hinge', 'slide'}
    parent : str
        Name of the object that carries it; empty for the world.
    position : float
        [rad] or [m]; 0 is where the scene file puts the object.
    velocity : float
        [rad/s] or [m/s]
    low, high : float
        Limits [rad] or [m]; infinite where there are none.
    effort : float
        The largest torque [N m] or force [N] with which it is moved when it is asked to.
    """

    id: int
    name: str
    type: JointKind
    parent: str
    position: float
    velocity: float
    low: float
    high: float
    effort: float

    @property
    def open_share(self) -> float:
        """Position as a share of the range between its limits, 0 to 1; NaN without limits."""
        span = self.high - self.low
        return (self.position - self.low) / span if 0.0 < span < math.inf else math.nan
