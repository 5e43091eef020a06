"""Rigid bodies put into the engine: a placement in, PyBullet's number of the body out."""

from __future__ import annotations

from collections.abc import Sequence

from sailenv_ros.world.bullet import LINK_OF_BASE, BulletClient
from sailenv_ros.world.collision import build_collision, hull_files
from sailenv_ros.world.placement import Placement

__all__ = ["ROLLING_FRICTION", "create_rigid_body", "mass_of"]

ROLLING_FRICTION = 0.002
"""Torque against rolling and spinning over the force that presses [m]."""


def create_rigid_body(
    client: BulletClient,
    placement: Placement,
    mass_kg: float,
    centre_m: tuple[float, float, float],
    position_m: Sequence[float],
) -> int:
    """Put the body of a placement into the engine; return its number there.

    Parameters
    ----------
    client : BulletClient
    placement : Placement
    mass_kg : float
        0 for what is static [kg].
    centre_m : (3,) tuple of float
        Its centre of mass in the body frame [m].
    position_m : (3,) sequence of float
        Where that is in the world [m].
    """
    with hull_files(client) as files:
        shape = build_collision(
            files,
            placement.asset.collision,
            scale=placement.scale,
            centre_of_mass_m=centre_m,
            name=placement.name,
        )
        body = client.createMultiBody(
            baseMass=mass_kg,
            baseCollisionShapeIndex=shape,
            basePosition=position_m,
            baseOrientation=placement.pose.orientation_xyzw,
            # A rigid body, not a tree of links with no link: the engine's step takes half the time.
            useMaximalCoordinates=1,
        )
    client.changeDynamics(
        body,
        LINK_OF_BASE,
        lateralFriction=placement.friction,
        restitution=placement.restitution,
        # Bullet's own default of 0.04 /s would make free fall and free flight inexact.
        linearDamping=0.0,
        angularDamping=0.0,
        rollingFriction=ROLLING_FRICTION if mass_kg else 0.0,
        spinningFriction=ROLLING_FRICTION if mass_kg else 0.0,
    )
    if not placement.static:
        # What has come to rest sleeps: it keeps the very same pose, and costs nothing.
        sleeping = client.constants.ACTIVATION_STATE_ENABLE_SLEEPING
        client.changeDynamics(body, LINK_OF_BASE, activationState=sleeping)
        client.resetBaseVelocity(body, placement.linear_velocity, placement.angular_velocity)
    return int(body)


def mass_of(placement: Placement) -> float:
    """Return the mass of a placement: its own, else its asset's at its scale; 0 if static [kg]."""
    if placement.static:
        return 0.0
    if placement.mass_kg is not None:
        return placement.mass_kg
    sx, sy, sz = placement.scale
    return placement.asset.mass_kg * sx * sy * sz
