"""Actuation of a rigid body for one step: forces, set velocities, and walls that hold it up.

Stateless; a body is named by PyBullet's number.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours import MAX_SPEED_M_S, Action
from sailenv_ros.world.bullet import LINK_OF_BASE, BulletClient

__all__ = ["apply_action", "push", "limit_penetration", "velocity", "wake"]

CAREFUL_SPEED_M_S = 0.5
"""Slower bodies are kept out of walls by the engine alone."""

MAX_DEPTH_M = 0.002
OUT_OF_WALLS_PER_S = 24.0


def velocity(client: BulletClient, body: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the velocity of the centre of mass [m/s] and the angular velocity [rad/s]."""
    linear, angular = client.getBaseVelocity(body)
    return np.asarray(linear), np.asarray(angular)


def wake(client: BulletClient, body: int) -> None:
    """Let physics move a body again, if it has come to rest and sleeps."""
    state = client.constants.ACTIVATION_STATE_WAKE_UP
    client.changeDynamics(body, LINK_OF_BASE, activationState=state)


def push(client: BulletClient, body: int, force_n: Sequence[float]) -> None:
    """Push at the centre of mass during the next step [N]."""
    position, _ = client.getBasePositionAndOrientation(body)
    frame = client.constants.WORLD_FRAME
    client.applyExternalForce(body, LINK_OF_BASE, force_n, position, frame)


def apply_action(client: BulletClient, body: int, action: Action) -> None:
    """Do what a behaviour asks for; what it does not name stays as it is."""
    if action.acts:
        wake(client, body)
    if action.linear_velocity is not None or action.angular_velocity is not None:
        linear, angular = velocity(client, body)
        client.resetBaseVelocity(
            body,
            action.linear_velocity if action.linear_velocity is not None else linear.tolist(),
            action.angular_velocity if action.angular_velocity is not None else angular.tolist(),
        )
    if action.force_n is not None:
        push(client, body, action.force_n)
    if action.torque_nm is not None:
        frame = client.constants.WORLD_FRAME
        client.applyExternalTorque(body, LINK_OF_BASE, action.torque_nm, frame)


def limit_penetration(client: BulletClient, body: int) -> bool:
    """Keep a body out of walls, into which driven bodies are pressed anew at each step.

    Returns
    -------
    is_fast : bool
        True if it must be looked after at the next step, too.
    """
    linear, angular = velocity(client, body)
    speed = float(np.linalg.norm(linear))
    if speed < CAREFUL_SPEED_M_S:
        return False
    limited = linear * min(1.0, MAX_SPEED_M_S / speed)
    for normal, depth_m in _walls(client, body):
        # As fast into the wall as the engine bears, or out of it where it is in too deep.
        least = max(0.0, depth_m - MAX_DEPTH_M) * OUT_OF_WALLS_PER_S
        limited = limited + max(0.0, least - float(limited @ normal)) * normal
    if (limited != linear).any():
        client.resetBaseVelocity(body, limited.tolist(), angular.tolist())
    return True


def _walls(client: BulletClient, body: int) -> Iterator[tuple[NDArray[np.float64], float]]:
    """Yield the normals of static bodies that a body stands in, and how deep [m]."""
    for point in client.getContactPoints(bodyA=body):
        other, normal, distance = point[2], point[7], point[8]
        if distance < 0.0 and not client.getDynamicsInfo(other, LINK_OF_BASE)[0]:
            yield np.asarray(normal), -distance
