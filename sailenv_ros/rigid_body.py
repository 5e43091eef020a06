"""What a mover is to the physics engine when it is a rigid body: a ball and its constants.

Crosses `scene/`, `operations/`, `world/`, which makes the ball: see `world.mover_body`.
"""

from __future__ import annotations

from dataclasses import dataclass

from sailenv_ros.validation import checked_flag, checked_number

__all__ = ["RIGID_BODY_LIMITS", "STEPS_PER_SECOND", "RigidBody"]

STEPS_PER_SECOND = 240
"""Steps of the physics engine per second of simulated time."""

RIGID_BODY_LIMITS: dict[str, tuple[float, float, str]] = {
    "mass_kg": (0.001, 1000.0, "kg"),
    "radius_m": (0.01, 1.0, "m"),
    "drag_per_s": (0.0, 1000.0, "1/s"),
    "angular_drag_per_s": (0.0, 1000.0, "1/s"),
    "friction": (0.0, 10.0, ""),
    "restitution": (0.0, 1.0, ""),
}
"""Least and greatest value of each number, and its unit."""


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
        for name, (low, high, unit) in RIGID_BODY_LIMITS.items():
            given = checked_number(f"body's {name}", getattr(self, name), low, high, unit=unit)
            object.__setattr__(self, name, given)
        checked_flag("body's gravity", self.gravity)
