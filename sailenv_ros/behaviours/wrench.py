"""`wrench`: a force and a torque act upon an object for a while."""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from sailenv_ros.behaviours.base import (
    STEP_S,
    Action,
    BehaviourParameters,
    BodyState,
    behaviour,
)
from sailenv_ros.behaviours.steering import vector3
from sailenv_ros.scene.field_types import Number, optional
from sailenv_ros.scene.fields import Force, Position, Torque

__all__ = ["Wrench", "wrench"]


class Wrench(BehaviourParameters):
    """Parameters of `wrench`."""

    force: Force = Field(default=(0.0, 0.0, 0.0), description="world frame [N]")
    torque: Torque = Field(default=(0.0, 0.0, 0.0), description="world frame [N m]")
    point: Position | None = optional(
        "where the force acts, in the object's own frame, its scale applied [m]; left "
        "out: at the centre of mass"
    )
    duration: Annotated[float, Number(above=0.0, most=1e6, unit="s")] | None = optional(
        "how long it acts [s], at least one step; left out: forever"
    )

    @property
    def duration_s(self) -> float | None:
        """Time until it ends [s]; None if it acts forever."""
        return self.duration

    @property
    def steps(self) -> float:
        """For how many physics steps it acts."""
        return math.inf if self.duration is None else max(1, round(self.duration / STEP_S))


@behaviour("wrench", Wrench)
def wrench(
    parameters: Wrench,
    time_s: float,
    body: BodyState,
    memory: dict[str, Any],
    rng: np.random.Generator,
) -> Action:
    """Push with a force and twist with a torque for some time."""
    if time_s > (parameters.steps - 0.5) * STEP_S:
        return Action(idle_until_s=math.inf)
    force, torque = np.asarray(parameters.force), np.asarray(parameters.torque)
    if parameters.point is not None:
        arm = body.pose.matrix()[:3, :3] @ (np.asarray(parameters.point) - body.centre_of_mass_m)
        torque = torque + np.cross(arm, force)
    return Action(force_n=vector3(force), torque_nm=vector3(torque))
