"""A joint of a scene at an instant: what moves on it, how far it is open, how far it goes.

Made by `world/`, answers requests of clients. Knows no engine and no message. Positions are in
radians for hinges and in metres for slides, as in URDF and sensor_msgs/JointState.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias

__all__ = ["JointKind", "JointState"]

JointKind: TypeAlias = Literal["hinge", "slide"]


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
