"""Rigid body of a mover in the physics engine: a ball and its constants.

Crosses `scene/`, `operations/`, `world/`, which makes the ball: see `world.mover_body`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sailenv_ros.types.validation import Bounds, check_bounds, checked_flag

__all__ = ["RIGID_BODY_LIMITS", "STEPS_PER_SECOND", "RigidBody"]

STEPS_PER_SECOND = 240
"""Steps of the physics engine per second of simulated time."""

RIGID_BODY_LIMITS: Mapping[str, Bounds] = {
    "mass_kg": Bounds(least=0.001, most=1000.0, unit="kg"),
    "radius_m": Bounds(least=0.01, most=1.0, unit="m"),
    "drag_per_s": Bounds(least=0.0, most=1000.0, unit="1/s"),
    "angular_drag_per_s": Bounds(least=0.0, most=1000.0, unit="1/s"),
    "friction": Bounds(least=0.0, most=10.0),
    "restitution": Bounds(least=0.0, most=1.0),
}
"""Bounds of each number."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidBody:
    """A ball that wrenches, gravity and collisions move.

    Attributes
    ----------
    mass_kg : float
        0.001 to 1000 [kg].
    radius_m : float
        0.01 to 1 [m].
    drag_per_s, angular_drag_per_s : float
        Rate at which its velocity and its angular velocity decay, v = v0 exp(-drag t), 0 to 1000
        [1/s].
    friction : float
        Coefficient of sliding friction, 0 to 10; without any, nothing that it touches turns it.
    restitution : float
        Share of the speed that it strikes with that it has afterwards, whatever it strikes, 0 to 1.
    gravity : bool
        False if gravity does not pull it.

    Raises
    ------
    InvalidRequest
        If a number is out of its range.
    """

    mass_kg: float = 1.0
    radius_m: float = 0.15
    drag_per_s: float = 0.0
    angular_drag_per_s: float = 0.0
    friction: float = 0.0
    restitution: float = 0.0
    gravity: bool = True

    def __post_init__(self) -> None:
        check_bounds(self, RIGID_BODY_LIMITS, before="body's ")
        checked_flag("body's gravity", self.gravity)
