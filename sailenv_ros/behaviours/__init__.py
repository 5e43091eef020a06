"""Motion of objects by themselves: pure functions of time, state and a seeded generator."""

from sailenv_ros.behaviours.base import (
    MAX_SPEED_M_S,
    STEP_S,
    Action,
    Actions,
    BehaviourKind,
    BehaviourParameters,
    BodyState,
    BodyStates,
    RunningBehaviour,
    batch_behaviour,
    behaviour,
)
from sailenv_ros.behaviours.joint_motion import JointMotion, running_motion
from sailenv_ros.behaviours.registry import (
    behaviour_errors,
    behaviour_kinds,
    known_behaviour_errors,
    readable_behaviour_errors,
    refusing_behaviour_errors,
    start_behaviour,
)

__all__ = [
    "MAX_SPEED_M_S",
    "STEP_S",
    "Action",
    "Actions",
    "BehaviourKind",
    "BehaviourParameters",
    "BodyState",
    "BodyStates",
    "JointMotion",
    "RunningBehaviour",
    "batch_behaviour",
    "behaviour",
    "behaviour_errors",
    "behaviour_kinds",
    "known_behaviour_errors",
    "readable_behaviour_errors",
    "refusing_behaviour_errors",
    "running_motion",
    "start_behaviour",
]
