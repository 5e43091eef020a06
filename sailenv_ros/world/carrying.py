"""A body that is carried: it gets the speed with which a step brings it to where it is wanted."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours import MAX_SPEED_M_S, STEP_S
from sailenv_ros.world import actuation
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.bullet import BulletClient

__all__ = ["carry"]

Doubles = NDArray[np.float64]

_FASTEST_RAD_S = 30.0


def carry(client: BulletClient, body: Body, turn: Doubles, origin: Doubles) -> None:
    """Let the next step move a body to a pose.

    Parameters
    ----------
    turn : (3, 3) float64
        World from the body frame.
    origin : (3,) float64
        Of the body frame [m].
    """
    now = body.world_from_body()
    centre = np.asarray(body.placement.asset.centre_of_mass_m) * body.placement.scale
    way = origin + turn @ centre - (now[:3, :3] @ centre + now[:3, 3])
    gravity = np.zeros(3) if body.floats else np.asarray(client.gravity)
    linear = way / STEP_S - gravity * STEP_S
    angular = _rotation(turn @ now[:3, :3].T) / STEP_S
    speed, rate = float(np.linalg.norm(linear)), float(np.linalg.norm(angular))
    linear *= min(1.0, MAX_SPEED_M_S / max(speed, 1e-9))
    angular *= min(1.0, _FASTEST_RAD_S / max(rate, 1e-9))
    actuation.wake(client, body.bullet_id)
    client.resetBaseVelocity(body.bullet_id, linear.tolist(), angular.tolist())


def _rotation(turn: Doubles) -> Doubles:
    """Return (3,): the axis of a rotation times its angle [rad]."""
    axis = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    sine = 0.5 * float(np.linalg.norm(axis))
    cosine = 0.5 * (float(np.trace(turn)) - 1.0)
    if sine < 1e-9:
        return np.zeros(3)
    found: Doubles = axis * (0.5 * np.arctan2(sine, cosine) / sine)
    return found
