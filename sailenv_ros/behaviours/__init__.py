"""How objects move of themselves: small pure functions of time, state and a seeded generator."""

from sailenv_ros.behaviours.base import (
    MAX_SPEED_M_S,
    STEP_S,
    Action,
    BehaviourKind,
    BehaviourParameters,
    BodyState,
    RunningBehaviour,
    behaviour,
)
from sailenv_ros.behaviours.registry import (
    behaviour_faults,
    behaviour_kinds,
    known_behaviour_faults,
    start_behaviour,
)

__all__ = [
    "MAX_SPEED_M_S",
    "STEP_S",
    "Action",
    "BehaviourKind",
    "BehaviourParameters",
    "BodyState",
    "RunningBehaviour",
    "behaviour",
    "behaviour_faults",
    "behaviour_kinds",
    "known_behaviour_faults",
    "start_behaviour",
]
