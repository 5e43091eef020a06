"""`poltergeist`: something invisible pushes and twists an object now and then."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from sailenv_ros.behaviours.base import (
    Actions,
    BehaviourParameters,
    BodyStates,
    RunningBehaviour,
    batch_behaviour,
)
from sailenv_ros.behaviours.steering import random_direction, torques
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


@batch_behaviour("poltergeist", Poltergeist)
def poltergeist(
    running: Sequence[RunningBehaviour], times_s: NDArray[np.float64], bodies: BodyStates
) -> Actions:
    """Push and twist the object in random directions at random instants."""
    idle = np.zeros(len(running))
    pushes, twists = np.zeros((len(running), 3)), np.zeros((len(running), 3))
    for number, (one, time_s) in enumerate(zip(running, times_s.tolist(), strict=True)):
        _go_on(one, time_s)
        if "until" in one.memory:
            pushes[number], twists[number] = one.memory["push"], one.memory["twist"]
        else:
            idle[number] = one.memory["next"]
    return Actions(
        acts=idle == 0.0,
        forces_n=pushes * bodies.masses_kg[:, None],
        torques_nm=torques(bodies.orientations, bodies.inertias_kg_m2, twists),
        idle_until_s=idle,
    )


def _go_on(running: RunningBehaviour, time_s: float) -> None:
    """Begin a push that is due, or end one and draw the time of the next."""
    parameters, memory, rng = running.parameters, running.memory, running.rng
    assert isinstance(parameters, Poltergeist)
    if memory.pop("next", None) is not None:
        memory.update(_push(parameters, rng), until=time_s + parameters.duration)
    if "until" not in memory or time_s >= memory["until"] - 1e-9:
        memory.clear()
        memory["next"] = time_s + rng.exponential(parameters.mean_interval)


def _push(parameters: Poltergeist, rng: np.random.Generator) -> dict[str, Any]:
    """Draw a push [m/s2] and a twist [rad/s2] of at least half the strength."""
    push = parameters.acceleration * rng.uniform(0.5, 1.0)
    twist = math.radians(parameters.angular_acceleration) * rng.uniform(0.5, 1.0)
    return {"push": random_direction(rng) * push, "twist": random_direction(rng) * twist}
