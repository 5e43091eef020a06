"""How objects move of themselves: small pure functions of time, state and a seeded generator."""

from sailenv_ros.behaviours.base import (
    Action,
    BehaviourKind,
    BehaviourParameters,
    BodyState,
    RunningBehaviour,
    behaviour,
)
from sailenv_ros.behaviours.registry import behaviour_faults, behaviour_kinds, start_behaviour

__all__ = [
    "Action",
    "BehaviourKind",
    "BehaviourParameters",
    "BodyState",
    "RunningBehaviour",
    "behaviour",
    "behaviour_faults",
    "behaviour_kinds",
    "start_behaviour",
]
