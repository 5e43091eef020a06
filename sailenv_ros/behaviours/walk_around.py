"""A person who walks from place to place."""

from __future__ import annotations

from typing import Any

import numpy as np

from sailenv_ros.behaviours.base import Action, BodyState, behaviour
from sailenv_ros.behaviours.person import ASK_AGAIN_S, PersonParameters, free_person

__all__ = ["WalkAround", "walk_around"]


class WalkAround(PersonParameters):
    """Parameters of `walk_around`."""


@behaviour("walk_around", WalkAround)
def walk_around(
    parameters: WalkAround,
    time_s: float,
    body: BodyState,
    memory: dict[str, Any],
    rng: np.random.Generator,
) -> Action:
    """Walk to random free places, with pauses."""
    person = free_person(parameters, time_s, body, memory, rng)
    if person is None:
        return Action()
    place = person.random_place(rng)
    if place is None or not person.walk_to(place):
        memory["until_s"] = time_s + ASK_AGAIN_S
    return Action()
