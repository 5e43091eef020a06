"""The rigid body of a mover in a scene file."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field

from sailenv_ros.scene.field_types import Number, Switch
from sailenv_ros.scene.fields import DegreesPerSecond, MetresPerSecond, SceneModel
from sailenv_ros.scene.rules import Entry, Faults
from sailenv_ros.types.rigid_body import RIGID_BODY_LIMITS, RigidBody

__all__ = ["BodySpec", "forces_or_waypoints"]

_DEFAULTS = RigidBody()


def _within_limits(name: str) -> Number:
    return Number.within(RIGID_BODY_LIMITS[name])


class BodySpec(SceneModel):
    """A ball that wrenches, gravity and collisions move, and the mover with it."""

    mass: Annotated[float, _within_limits("mass_kg")] = Field(
        default=_DEFAULTS.mass_kg, description="[kg]"
    )
    radius: Annotated[float, _within_limits("radius_m")] = Field(
        default=_DEFAULTS.radius_m, description="of the ball, which is never drawn [m]"
    )
    drag: Annotated[float, _within_limits("drag_per_s")] = Field(
        default=_DEFAULTS.drag_per_s, description="rate at which its velocity decays [1/s]"
    )
    angular_drag: Annotated[float, _within_limits("angular_drag_per_s")] = Field(
        default=_DEFAULTS.angular_drag_per_s,
        description="rate at which its angular velocity decays [1/s]",
    )
    friction: Annotated[float, _within_limits("friction")] = Field(
        default=_DEFAULTS.friction,
        description="coefficient of sliding friction; 0: contacts do not turn it",
    )
    restitution: Annotated[float, _within_limits("restitution")] = Field(
        default=_DEFAULTS.restitution,
        description="bounce: 0 none, 1 full speed, whatever it strikes",
    )
    gravity: Annotated[bool, Switch()] = Field(
        default=_DEFAULTS.gravity, description="false: it floats"
    )
    velocity: MetresPerSecond = Field(
        default=(0.0, 0.0, 0.0), description="at the start, in the world's axes [m/s]"
    )
    angular_velocity: DegreesPerSecond = Field(
        default=(0.0, 0.0, 0.0), description="at the start, about the world's axes [deg/s]"
    )

    def to_rigid_body(self) -> RigidBody:
        """Return the data type that the simulation takes."""
        return RigidBody(
            mass_kg=self.mass,
            radius_m=self.radius,
            drag_per_s=self.drag,
            angular_drag_per_s=self.angular_drag,
            friction=self.friction,
            restitution=self.restitution,
            gravity=self.gravity,
        )

    @property
    def angular_velocity_rad_s(self) -> tuple[float, float, float]:
        """Initial angular velocity, about the world's axes [rad/s]."""
        x, y, z = (math.radians(rate) for rate in self.angular_velocity)
        return x, y, z


def forces_or_waypoints(mover: Entry) -> Faults:
    """Refuse a body that waypoints drive."""
    if mover.get("body") is None or mover.get("controller") == "rigidbody":
        return
    if mover.get("controller") is not None or mover.get("waypoints"):
        yield (
            ("controller",),
            "must be rigidbody for a mover that is a body: forces move it, not waypoints",
        )
