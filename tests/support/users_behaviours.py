"""A module as a user writes one: a behaviour that scene files name as ``module:name``."""

from __future__ import annotations

from typing import Any

import numpy as np

from sailenv_ros.behaviours import Action, BehaviourParameters, BodyState, behaviour


class Drift(BehaviourParameters):
    """Parameters of `drift`."""

    speed: float = 0.5


@behaviour("drift", Drift)
def drift(
    parameters: Drift,
    time_s: float,
    body: BodyState,
    memory: dict[str, Any],
    rng: np.random.Generator,
) -> Action:
    """Drift along the world's x axis."""
    return Action(linear_velocity=(parameters.speed, 0.0, 0.0))
