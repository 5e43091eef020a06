"""`poltergeist`: something invisible pushes and twists an object now and then."""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from sailenv_ros.behaviours.base import Action, BehaviourParameters, BodyState, behaviour
from sailenv_ros.behaviours.steering import random_direction, vector3
from sailenv_ros.scene.field_types import Number

__all__ = ["Poltergeist", "poltergeist"]


class Poltergeist(BehaviourParameters):
    """Parameters of `poltergeist`."""

    mean_interval: Annotated[float, Number(least=0.05, most=1e4, unit="s")] = Field(
        default=4.0, description="time from one push to the next, on average [s]"
    )
    duration: Annotated[float, Number(above=0.0, most=10.0, unit="s")] = Field(
        default=0.1, description="how long a push lasts [s]"
    )
    acceleration: Annotated[float, Number(least=0.0, most=1000.0, unit="m/s2")] = Field(
        default=25.0, description="strongest force, divided by the object's mass [m/s2]"
    )
    angular_acceleration: Annotated[float, Number(least=0.0, most=1e5, unit="deg/s2")] = Field(
        default=1500.0,
        description="strongest torque, divided by the object's moment of inertia [deg/s2]",
    )


@behaviour("poltergeist", Poltergeist)
def poltergeist(
    parameters: Poltergeist,
    time_s: float,
    body: BodyState,
    memory: dict[str, Any],
    rng: np.random.Generator,
) -> Action:
    """Push and twist the object in random directions at random instants."""
    if memory.pop("due", False):
        memory.update(_push(parameters, rng), until=time_s + parameters.duration)
    if "until" in memory and time_s < memory["until"] - 1e-9:
        axes = body.pose.matrix()[:3, :3]
        torque = axes @ (body.inertia_kg_m2 * (axes.T @ memory["twist"]))
        return Action(force_n=vector3(memory["push"] * body.mass_kg), torque_nm=vector3(torque))
    memory.clear()
    memory["due"] = True
    return Action(idle_until_s=time_s + rng.exponential(parameters.mean_interval))


def _push(parameters: Poltergeist, rng: np.random.Generator) -> dict[str, Any]:
    """Draw a push [m/s2] and a twist [rad/s2] of at least half the strength."""
    push = parameters.acceleration * rng.uniform(0.5, 1.0)
    twist = math.radians(parameters.angular_acceleration) * rng.uniform(0.5, 1.0)
    return {"push": random_direction(rng) * push, "twist": random_direction(rng) * twist}
