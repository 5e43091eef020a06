"""What a behaviour is: a parameter model and one function from a body's state to an action.

The function sees time, the body's state, a memory of its own and a seeded generator; it returns
what the engine shall do during the next physics step. It knows no engine, so it can be tested
with plain numbers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict

from sailenv_ros.geometry import Pose

__all__ = [
    "Action",
    "BehaviourKind",
    "BehaviourParameters",
    "BodyState",
    "RunningBehaviour",
    "behaviour",
]

Vector3 = tuple[float, float, float]


class BehaviourParameters(BaseModel):
    """Base of every behaviour's parameters: unknown keys are faults, numbers are finite."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyState:
    """A body's motion at one instant, in the world frame.

    Attributes
    ----------
    pose : Pose
    linear_velocity : (3,) float64
        [m/s]
    angular_velocity : (3,) float64
        [rad/s]
    mass_kg : float
    """

    pose: Pose
    linear_velocity: NDArray[np.float64]
    angular_velocity: NDArray[np.float64]
    mass_kg: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Action:
    """What the engine does to the body during the next step; ``None`` leaves it alone.

    Attributes
    ----------
    force_n, torque_nm : (3,) tuple of float or None
        Applied at the centre of mass, world frame [N], [N m].
    linear_velocity : (3,) tuple of float or None
        Set before the step, world frame [m/s].
    angular_velocity : (3,) tuple of float or None
        Set before the step, world frame [rad/s].
    """

    force_n: Vector3 | None = None
    torque_nm: Vector3 | None = None
    linear_velocity: Vector3 | None = None
    angular_velocity: Vector3 | None = None


ParametersType: TypeAlias = type[BehaviourParameters]

BehaviourFunction = Callable[[Any, float, BodyState, dict[str, Any], np.random.Generator], Action]


@dataclass(frozen=True, slots=True, kw_only=True)
class BehaviourKind:
    """One kind of behaviour.

    Attributes
    ----------
    type : str
        The word in YAML.
    parameters : type
        Model of its parameters.
    function : callable
        ``function(parameters, time_s, body, memory, rng) -> Action``; `time_s` counts from the
        behaviour's start, `memory` is a dict that lasts as long as the behaviour.
    """

    type: str
    parameters: ParametersType
    function: BehaviourFunction

    @property
    def summary(self) -> str:
        """The first line of the function's docstring."""
        return (self.function.__doc__ or "").strip().partition("\n")[0]


@dataclass(slots=True, kw_only=True)
class RunningBehaviour:
    """A behaviour attached to one body: its parameters, memory, generator and start."""

    kind: BehaviourKind
    parameters: BehaviourParameters
    rng: np.random.Generator
    start_s: float = 0.0
    memory: dict[str, Any] = field(default_factory=dict)

    def act(self, time_s: float, body: BodyState) -> Action:
        """Ask for the action of the step that begins at `time_s` [s of simulated time]."""
        return self.kind.function(
            self.parameters, time_s - self.start_s, body, self.memory, self.rng
        )


def behaviour(
    type_: str, parameters: type[BehaviourParameters]
) -> Callable[[BehaviourFunction], BehaviourKind]:
    """Turn a function into a behaviour kind of that name; used as a decorator."""

    def decorate(function: BehaviourFunction) -> BehaviourKind:
        return BehaviourKind(type=type_, parameters=parameters, function=function)

    return decorate
