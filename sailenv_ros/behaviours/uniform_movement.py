"""`uniform_movement_random_bounce`: straight on at one speed, and off what is met at random."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from sailenv_ros.behaviours.base import (
    MAX_SPEED_M_S,
    Actions,
    BehaviourParameters,
    BodyStates,
    RunningBehaviour,
    batch_behaviour,
)
from sailenv_ros.behaviours.steering import dots, lengths, random_direction
from sailenv_ros.scene.field_types import Number, Text, optional
from sailenv_ros.scene.fields import Direction

__all__ = ["UniformMovement", "uniform_movement_random_bounce"]

Vector = NDArray[np.float64]

SCATTER = 0.5
"""Length of the random vector that is added to the unit vector of a reflected direction."""

HIT_SHARE = 0.2
"""Share of its speed that an impact changes at least."""


class UniformMovement(BehaviourParameters):
    """Parameters of `uniform_movement_random_bounce`."""

    start_direction: Direction | None = optional(
        "where it goes first, world frame; random if left out"
    )
    speed: Annotated[float, Number(above=0.0, most=MAX_SPEED_M_S, unit="m/s")] = Field(
        default=1.0, description="[m/s]"
    )
    angular_speed: Annotated[float, Number(least=0.0, most=1000.0, unit="deg/s")] = Field(
        default=0.0, description="turn about a random axis, a new one at each bounce [deg/s]"
    )
    keep_in_view: Annotated[str, Text(r"|[a-z][a-z0-9_]{0,62}", "the name of an agent")] = Field(
        default="", description="agent whose view it does not leave; empty: it goes anywhere"
    )
    view_distance: Annotated[float, Number(above=0.0, most=1e4, unit="m")] = Field(
        default=10.0, description="how far from that agent it may go [m]"
    )

    @property
    def viewer(self) -> str:
        """Name of the agent in whose view the object is kept; empty for none."""
        return self.keep_in_view

    @property
    def view_distance_m(self) -> float:
        """Greatest distance from the viewer [m]."""
        return self.view_distance


@batch_behaviour("uniform_movement_random_bounce", UniformMovement)
def uniform_movement_random_bounce(
    running: Sequence[RunningBehaviour], times_s: Vector, bodies: BodyStates
) -> Actions:
    """Move straight on at a constant speed and bounce off what is met."""
    new = np.array(["direction" not in one.memory for one in running])
    for number in np.flatnonzero(new).tolist():
        _begin(running[number])
    directions, speeds = _wanted(running)
    change = bodies.linear_velocities - directions * speeds[:, None]
    size = lengths(change)
    # An impact changes speed along the normal of what was hit.
    met = ~new & (size >= HIT_SHARE * speeds) & (dots(directions, change) < 0.0)
    for number in np.flatnonzero(met).tolist():
        _bounce(running[number], change[number] / size[number])
    viewed = [number for number, planes in enumerate(bodies.frustum_planes) if len(planes)]
    left = [
        number
        for number in viewed
        if _keep_in_front(
            running[number], bodies.positions_m[number], bodies.frustum_planes[number]
        )
    ]
    if left or met.any():
        directions, speeds = _wanted(running)
    return Actions(
        acts=np.ones(len(running), np.bool_),
        linear_velocities=directions * speeds[:, None],
        angular_velocities=np.array([one.memory["spin"] for one in running]),
    )


def _wanted(running: Sequence[RunningBehaviour]) -> tuple[Vector, Vector]:
    """Return directions (N, 3) and speeds (N,) [m/s]."""
    directions = np.array([one.memory["direction"] for one in running])
    return directions, np.array([_parameters(one).speed for one in running])


def _parameters(running: RunningBehaviour) -> UniformMovement:
    assert isinstance(running.parameters, UniformMovement)
    return running.parameters


def _begin(running: RunningBehaviour) -> None:
    given = _parameters(running).start_direction
    if given is None or not any(given):
        running.memory["direction"] = random_direction(running.rng)
    else:
        direction = np.asarray(given)
        running.memory["direction"] = direction / np.linalg.norm(direction)
    _spin_anew(running)


def _spin_anew(running: RunningBehaviour) -> None:
    rate = math.radians(_parameters(running).angular_speed)
    running.memory["spin"] = random_direction(running.rng) * rate


def _keep_in_front(running: RunningBehaviour, position: Vector, planes: Vector) -> bool:
    """Turn it back at the planes that it is to be in front of and is not; say if there are any."""
    behind = planes[:, :3] @ position + planes[:, 3] < 0.0
    for normal in planes[behind, :3]:
        _bounce(running, normal)
    return bool(behind.any())


def _bounce(running: RunningBehaviour, normal: Vector) -> None:
    """Reflect the direction off a plane, scattered at random, unless it leads away already."""
    direction = running.memory["direction"]
    if direction @ normal >= 0.0:
        return
    reflected = direction - 2.0 * (direction @ normal) * normal
    scattered = reflected + SCATTER * random_direction(running.rng)
    away = scattered @ normal
    if away < 0.1:
        scattered = scattered + (0.1 - away) * normal
    running.memory["direction"] = scattered / np.linalg.norm(scattered)
    _spin_anew(running)
