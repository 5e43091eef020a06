"""Motions of joints: to a position within a time, and back and forth.

Both ask for the velocity that brings the joint to where it should be at the end of the step, so
what was held up catches up as far as the joint's effort lets it.
"""

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
    RunningBehaviour,
    behaviour,
)
from sailenv_ros.scene.field_types import Number, optional
from sailenv_ros.scene.fields import JointLimits

__all__ = ["JointMotion", "OpenAndClose", "joint_motion", "open_and_close", "running_motion"]

ARRIVED = 1e-3
"""Distance from its goal at which a motion ends; the joint is then set to the goal [rad] or [m]."""

CATCHES_UP = 2.0
"""Greatest speed of a joint that was held up, as a multiple of the motion's greatest speed."""


class JointMotion(BehaviourParameters):
    """Parameters of a motion to a position."""

    first: float
    position: float
    seconds: float

    @property
    def duration_s(self) -> float | None:
        """Time until it ends [s]."""
        return self.seconds


class OpenAndClose(BehaviourParameters):
    """Parameters of `open_and_close`."""

    period: Annotated[float, Number(least=0.1, most=1e4, unit="s")] = Field(
        default=8.0, description="time to open and close once [s]"
    )
    limits: JointLimits | None = optional(
        "between which positions [rad] or [m]; the joint's own limits if left out"
    )

    @property
    def needs_joint(self) -> bool:
        """True: it moves nothing but joints."""
        return True


@behaviour("joint_motion", JointMotion, joint_alone=True)
def joint_motion(
    parameters: JointMotion,
    time_s: float,
    body: BodyState,
    memory: dict[str, Any],
    rng: np.random.Generator,
) -> Action:
    """Move a joint to a position with the least jerk.

    The share of the way is 10 s³ - 15 s⁴ + 6 s⁵ of the share s of the time (Flash and Hogan 1985).
    """
    if time_s > parameters.seconds - 0.5 * STEP_S:
        arrived = abs(body.joint_position - parameters.position) <= ARRIVED
        end = parameters.position if arrived else None
        return Action(joint_position=end, idle_until_s=math.inf)
    share = min(1.0, (time_s + STEP_S) / parameters.seconds)
    way = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
    span = parameters.position - parameters.first
    # The greatest speed of the motion is 15/8 of the mean.
    fastest = max(CATCHES_UP * 1.875 * abs(span) / parameters.seconds, ARRIVED / STEP_S)
    return Action(joint_velocity=_towards(parameters.first + span * way, body, fastest))


@behaviour("open_and_close", OpenAndClose, joint_alone=True)
def open_and_close(
    parameters: OpenAndClose,
    time_s: float,
    body: BodyState,
    memory: dict[str, Any],
    rng: np.random.Generator,
) -> Action:
    """Open and close a joint again and again, between its limits."""
    low, high = parameters.limits or body.joint_limits
    low, high = max(low, body.joint_limits[0]), min(high, body.joint_limits[1])
    if not (math.isfinite(low) and math.isfinite(high)) or low >= high:
        return Action(idle_until_s=math.inf)  # no joint, or one without an end
    if "phase" not in memory:
        # It begins where the joint is.
        share = min(max((body.joint_position - low) / (high - low), 0.0), 1.0)
        memory["phase"] = math.acos(1.0 - 2.0 * share)
    rate = 2.0 * math.pi / parameters.period
    angle = memory["phase"] + rate * (time_s + STEP_S)
    aim = low + (high - low) * (1.0 - math.cos(angle)) / 2.0
    fastest = CATCHES_UP * rate * (high - low) / 2.0
    return Action(joint_velocity=_towards(aim, body, fastest))


def running_motion(parameters: JointMotion, start_s: float) -> RunningBehaviour:
    """Return a motion that begins at a simulated time [s]; it uses no random numbers."""
    return RunningBehaviour(
        kind=joint_motion,
        parameters=parameters,
        rng=np.random.default_rng(0),
        start_s=start_s,
    )


def _towards(aim: float, body: BodyState, fastest: float) -> float:
    wanted = (aim - body.joint_position) / STEP_S
    return min(max(wanted, -fastest), fastest)
