"""Definition of a behaviour: a parameter model and a function from a body's state to an action.

The function sees time, the body's state, a memory of its own and a seeded generator; it returns
what the engine, which it does not know, shall do during the next physics step.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from sailenv_ros.scene.field_types import Number, optional
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.rigid_body import STEPS_PER_SECOND

__all__ = [
    "MAX_SPEED_M_S",
    "STEP_S",
    "Action",
    "Actions",
    "BehaviourKind",
    "BehaviourParameters",
    "BodyState",
    "BodyStates",
    "RunningBehaviour",
    "batch_behaviour",
    "behaviour",
]

Vector3 = tuple[float, float, float]

MAX_VIEW_DISTANCE_M = 10.0
STEP_S = 1.0 / STEPS_PER_SECOND
"""Simulated time that an action lasts: one physics step."""

MAX_SPEED_M_S = 10.0
"""No behaviour drives a body faster: in one step it then covers less than half a thin wall."""


# Made once and read-only: of a joint a state is asked for in each step.
_UNIT_INERTIA, _IN_ORIGIN = np.broadcast_to(1.0, 3), np.broadcast_to(0.0, 3)
_NO_PLANES = np.zeros((0, 4))


class BehaviourParameters(BaseModel):
    """Base of every behaviour's parameters: unknown keys are errors, numbers are finite."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    legs: ClassVar[tuple[int, ...]] = ()
    """Numbers of legs of those that it moves alone; empty if it moves other things."""

    start: Annotated[float, Number(least=0.0, most=1e6, unit="s")] = Field(
        default=0.0, description="time after the object's appearance at which it begins [s]"
    )
    seed: Annotated[int, Number(least=0, most=2**63 - 1, whole=True)] | None = optional(
        "of its random numbers, instead of the simulation's"
    )

    def to_json(self) -> dict[str, Any]:
        """Return the parameters as a scene file would write them, defaults too."""
        return self.model_dump(exclude_none=True, exclude=None if self.start else {"start"})

    @property
    def duration_s(self) -> float | None:
        """Time from its beginning to its end [s]; None if it never ends."""
        return None

    @property
    def needs_joint(self) -> bool:
        """True if it moves nothing but joints."""
        return False

    @property
    def viewer(self) -> str:
        """Name of the agent in whose view the object is kept; empty for none."""
        return ""

    @property
    def view_distance_m(self) -> float:
        """Greatest distance from the viewer [m]."""
        return MAX_VIEW_DISTANCE_M


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
    inertia_kg_m2 : (3,) float64
        Moments of inertia about the body's own axes.
    frustum_planes : (N, 4) float64
        Planes (a, b, c, d) that it is kept in front of: a x + b y + c z + d > 0 [m], with a unit
        normal (a, b, c). None at all unless its parameters name a viewer.
    centre_of_mass_m : (3,) float64
        In the body frame, scale included.
    joint_position, joint_velocity : float
        Of the joint that it is on [rad, rad/s] or [m, m/s]; 0 where there is none.
    joint_limits : (2,) tuple of float
        Least and greatest position of the joint; both 0 where there is none.
    person : Person or None
        Of a person, who is told where to go; see `behaviours.person`.
    """

    pose: Pose
    linear_velocity: NDArray[np.float64]
    angular_velocity: NDArray[np.float64]
    mass_kg: float
    inertia_kg_m2: NDArray[np.float64] = field(default_factory=lambda: _UNIT_INERTIA)
    frustum_planes: NDArray[np.float64] = field(default_factory=lambda: _NO_PLANES)
    centre_of_mass_m: NDArray[np.float64] = field(default_factory=lambda: _IN_ORIGIN)
    joint_position: float = 0.0
    joint_velocity: float = 0.0
    joint_limits: tuple[float, float] = (0.0, 0.0)
    person: Any = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Action:
    """Commands to the physics engine for one body and the next step; ``None`` changes nothing.

    Velocities of an object on a joint count along the joint.

    Attributes
    ----------
    force_n, torque_nm : (3,) tuple of float or None
        Applied at the centre of mass, world frame [N], [N m].
    linear_velocity : (3,) tuple of float or None
        Set before the step, world frame [m/s].
    angular_velocity : (3,) tuple of float or None
        Set before the step, world frame [rad/s].
    joint_velocity : float or None
        With which the joint that it is on is moved during the step, as far as the joint's effort
        suffices [rad/s] or [m/s].
    joint_position : float or None
        Of that joint, set before the step [rad] or [m].
    idle_until_s : float or None
        Time on the behaviour's clock before which it need not be asked again [s].
    """

    force_n: Vector3 | None = None
    torque_nm: Vector3 | None = None
    linear_velocity: Vector3 | None = None
    angular_velocity: Vector3 | None = None
    joint_velocity: float | None = None
    joint_position: float | None = None
    idle_until_s: float | None = None

    @property
    def acts(self) -> bool:
        """True if the engine has anything to do."""
        done = (self.force_n, self.torque_nm, self.linear_velocity, self.angular_velocity)
        joint = (self.joint_velocity, self.joint_position)
        return any(part is not None for part in (*done, *joint))


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyStates:
    """The motion of N bodies at one instant, in the world frame; see `BodyState`.

    Attributes
    ----------
    positions_m, linear_velocities, angular_velocities, inertias_kg_m2 : (N, 3) float64
        Positions are those of the body frames.
    orientations : (N, 4) float64
        Unit quaternions x, y, z, w.
    masses_kg : (N,) float64
    frustum_planes : tuple of (M, 4) float64
        Of each body.
    """

    positions_m: NDArray[np.float64]
    orientations: NDArray[np.float64]
    linear_velocities: NDArray[np.float64]
    angular_velocities: NDArray[np.float64]
    masses_kg: NDArray[np.float64]
    inertias_kg_m2: NDArray[np.float64]
    frustum_planes: tuple[NDArray[np.float64], ...]

    @classmethod
    def of(cls, body: BodyState) -> BodyStates:
        """Return the states of one body alone."""
        return cls(
            positions_m=np.array([body.pose.position_m]),
            orientations=np.array([body.pose.orientation_xyzw]),
            linear_velocities=np.array([body.linear_velocity]),
            angular_velocities=np.array([body.angular_velocity]),
            masses_kg=np.array([body.mass_kg]),
            inertias_kg_m2=np.array([body.inertia_kg_m2]),
            frustum_planes=(body.frustum_planes,),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Actions:
    """Commands to the physics engine for N bodies and the next step; see `Action`.

    Attributes
    ----------
    acts : (N,) bool
        False leaves a body alone, whatever the other rows say.
    forces_n, torques_nm, linear_velocities, angular_velocities : (N, 3) float64 or None
        None leaves that part alone for all of them.
    idle_until_s : (N,) float64 or None
        Times on the behaviours' clocks before which they need not be asked again [s].
    """

    acts: NDArray[np.bool_]
    forces_n: NDArray[np.float64] | None = None
    torques_nm: NDArray[np.float64] | None = None
    linear_velocities: NDArray[np.float64] | None = None
    angular_velocities: NDArray[np.float64] | None = None
    idle_until_s: NDArray[np.float64] | None = None

    def row(self, number: int) -> Action:
        """Return the action of one body."""

        def part(values: NDArray[np.float64] | None) -> Vector3 | None:
            if values is None or not self.acts[number]:
                return None
            x, y, z = values[number].tolist()
            return x, y, z

        idle = None if self.idle_until_s is None else float(self.idle_until_s[number])
        return Action(
            force_n=part(self.forces_n),
            torque_nm=part(self.torques_nm),
            linear_velocity=part(self.linear_velocities),
            angular_velocity=part(self.angular_velocities),
            idle_until_s=idle or None,
        )


ParametersType: TypeAlias = type[BehaviourParameters]

BehaviourFunction = Callable[[Any, float, BodyState, dict[str, Any], np.random.Generator], Action]

BatchFunction = Callable[["Sequence[RunningBehaviour]", NDArray[np.float64], BodyStates], Actions]


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
    batch : callable or None
        ``batch(running, times_s, bodies) -> Actions``: the same for N bodies at once, where that
        is faster; what becomes of one body must not depend on the others.
    joint_alone : bool
        True if the function looks at nothing but the joint of an object on one: the rest of the
        state, which costs ten times as much, is that of a body at rest in the origin.
    """

    type: str
    parameters: ParametersType
    function: BehaviourFunction
    batch: BatchFunction | None = None
    joint_alone: bool = False

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
    idle_until_s: float = 0.0

    @property
    def is_over(self) -> bool:
        """True once it never does anything again."""
        return self.idle_until_s == math.inf

    def is_idle(self, time_s: float) -> bool:
        """Return whether nothing is done in the step that begins at `time_s` [simulated s]."""
        return self.own_time_s(time_s) < self.idle_until_s - 1e-9

    def own_time_s(self, time_s: float) -> float:
        """Return the time since its start [s]."""
        return time_s - self.start_s - self.parameters.start

    def act(self, time_s: float, body: BodyState) -> Action:
        """Ask for the action of the step that begins at `time_s` [s of simulated time]."""
        if self.is_idle(time_s):
            return Action()
        own_s = self.own_time_s(time_s)
        action = self.kind.function(self.parameters, own_s, body, self.memory, self.rng)
        self.idle_until_s = action.idle_until_s or 0.0
        return action


def behaviour(
    type_: str, parameters: type[BehaviourParameters], *, joint_alone: bool = False
) -> Callable[[BehaviourFunction], BehaviourKind]:
    """Turn a function into a behaviour kind of that name; used as a decorator."""
    return lambda function: BehaviourKind(
        type=type_, parameters=parameters, function=function, joint_alone=joint_alone
    )


def batch_behaviour(
    type_: str, parameters: type[BehaviourParameters]
) -> Callable[[BatchFunction], BehaviourKind]:
    """Turn a function of many bodies into a behaviour kind of that name; used as a decorator."""

    def decorate(batch: BatchFunction) -> BehaviourKind:
        def alone(
            given: BehaviourParameters,
            time_s: float,
            body: BodyState,
            memory: dict[str, Any],
            rng: np.random.Generator,
        ) -> Action:
            one = RunningBehaviour(kind=kind, parameters=given, rng=rng, memory=memory)
            return batch([one], np.array([time_s]), BodyStates.of(body)).row(0)

        alone.__doc__ = batch.__doc__
        kind = BehaviourKind(type=type_, parameters=parameters, function=alone, batch=batch)
        return kind

    return decorate
