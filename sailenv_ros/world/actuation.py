"""Actuation of a rigid body for one step: forces and set velocities.

Stateless; a body is named by PyBullet's number.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours import Action
from sailenv_ros.world.bullet import LINK_OF_BASE, BulletClient

__all__ = ["apply_action", "push", "velocity", "wake"]


def velocity(client: BulletClient, body: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the velocity of the centre of mass [m/s] and the angular velocity [rad/s]."""
    linear, angular = client.getBaseVelocity(body)
    return np.asarray(linear), np.asarray(angular)


def wake(client: BulletClient, body: int) -> None:
    """Let physics move a body again, if it has come to rest and sleeps."""
    state = client.constants.ACTIVATION_STATE_WAKE_UP
    client.changeDynamics(body, LINK_OF_BASE, activationState=state)


def push(
    client: BulletClient, body: int, force_n: Sequence[float], *, link: int = LINK_OF_BASE
) -> None:
    """Push at the centre of mass during the next step [N]."""
    if link == LINK_OF_BASE:
        position, _ = client.getBasePositionAndOrientation(body)
    else:
        position = client.getLinkState(body, link, computeForwardKinematics=1)[0]
    frame = client.constants.WORLD_FRAME
    client.applyExternalForce(body, link, force_n, position, frame)


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
