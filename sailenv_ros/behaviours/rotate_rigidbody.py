"""`rotate_rigidbody`: an object turns at a constant rate, as in the Optical scene."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from pydantic import Field

from sailenv_ros.behaviours.base import Action, BehaviourParameters, BodyState, behaviour
from sailenv_ros.scene.fields import DegreesPerSecond

__all__ = ["RotateRigidbody", "rotate_rigidbody"]


class RotateRigidbody(BehaviourParameters):
    """Parameters of `rotate_rigidbody`."""

    angular_velocity: DegreesPerSecond = Field(
        default=(0.0, 0.0, 45.0), description="turn about the world's axes x, y, z [deg/s]"
    )


@behaviour("rotate_rigidbody", RotateRigidbody)
def rotate_rigidbody(
    parameters: RotateRigidbody,
    time_s: float,
    body: BodyState,
    memory: dict[str, Any],
    rng: np.random.Generator,
) -> Action:
    """Turn at a constant angular velocity."""
    x, y, z = (math.radians(rate) for rate in parameters.angular_velocity)
    return Action(angular_velocity=(x, y, z))
