"""`uniform_movement_random_bounce`: straight on at one speed, and off what is met at random."""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from sailenv_ros.behaviours.base import (
    MAX_SPEED_M_S,
    Action,
    BehaviourParameters,
    BodyState,
    behaviour,
)
from sailenv_ros.behaviours.steering import random_direction, vector3
from sailenv_ros.scene.field_types import Number, Text
from sailenv_ros.scene.fields import Direction

__all__ = ["UniformMovement", "uniform_movement_random_bounce"]

Vector = NDArray[np.float64]

SCATTER = 0.5
"""Length of the random vector that is added to the unit vector of a reflected direction."""


class UniformMovement(BehaviourParameters):
    """Parameters of `uniform_movement_random_bounce`."""

    start_direction: Direction | None = Field(
        default=None, description="where it goes first, world frame; random if left out"
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
        """How far away from the viewer it may be [m]."""
        return self.view_distance


@behaviour("uniform_movement_random_bounce", UniformMovement)
def uniform_movement_random_bounce(
    parameters: UniformMovement,
    time_s: float,
    body: BodyState,
    memory: dict[str, Any],
    rng: np.random.Generator,
) -> Action:
    """Move straight on at a constant speed and bounce off what is met."""
    if "direction" not in memory:
        memory["direction"] = _first_direction(parameters, rng)
        memory["axis"] = random_direction(rng)
    else:
        _bounce(memory, _impact(memory["direction"], parameters.speed, body), rng)
    for normal in _left_behind(body):
        _bounce(memory, normal, rng)
    spin = memory["axis"] * math.radians(parameters.angular_speed)
    return Action(
        linear_velocity=vector3(memory["direction"] * parameters.speed),
        angular_velocity=vector3(spin),
    )


def _first_direction(parameters: UniformMovement, rng: np.random.Generator) -> Vector:
    if parameters.start_direction is None or not any(parameters.start_direction):
        return random_direction(rng)
    given = np.asarray(parameters.start_direction)
    return np.asarray(given / np.linalg.norm(given))


def _impact(direction: Vector, speed: float, body: BodyState) -> Vector | None:
    """Return the normal of what was hit in the last step: an impact changes speed along it."""
    change = body.linear_velocity - direction * speed
    size = float(np.linalg.norm(change))
    return None if size < 0.2 * speed else change / size


def _left_behind(body: BodyState) -> list[Vector]:
    """Return the normals of the planes that the body is to be in front of and is not."""
    planes = body.frustum_planes
    behind = planes[:, :3] @ np.asarray(body.pose.position_m) + planes[:, 3] < 0.0
    return list(planes[behind, :3])


def _bounce(memory: dict[str, Any], normal: Vector | None, rng: np.random.Generator) -> None:
    """Reflect the direction off a plane, scattered at random, unless it leads away already."""
    if normal is None or memory["direction"] @ normal >= 0.0:
        return
    direction = memory["direction"]
    reflected = direction - 2.0 * (direction @ normal) * normal
    scattered = reflected + SCATTER * random_direction(rng)
    away = scattered @ normal
    if away < 0.1:
        scattered = scattered + (0.1 - away) * normal
    memory["direction"] = scattered / np.linalg.norm(scattered)
    memory["axis"] = random_direction(rng)
