"""A person who opens doors and drawers by hand, and closes them."""

from __future__ import annotations

from typing import Any

import numpy as np
from pydantic import Field

from sailenv_ros.behaviours.base import Action, BodyState, behaviour
from sailenv_ros.behaviours.person import ASK_AGAIN_S, PersonParameters, free_person

__all__ = ["OpenByHand", "open_by_hand"]


class OpenByHand(PersonParameters):
    """Parameters of `open_by_hand`."""

    joints: tuple[str, ...] = Field(
        min_length=1, max_length=64, description="names of doors and drawers, in turn"
    )


@behaviour("open_by_hand", OpenByHand)
def open_by_hand(
    parameters: OpenByHand,
    time_s: float,
    body: BodyState,
    memory: dict[str, Any],
    rng: np.random.Generator,
) -> Action:
    """Walk to a door or a drawer and open it by hand, or close it if it is open."""
    person = free_person(parameters, time_s, body, memory, rng)
    if person is None:
        return Action()
    number = int(memory.get("number", -1)) + 1
    memory["number"] = number
    if not person.open(parameters.joints[number % len(parameters.joints)]):
        memory["until_s"] = time_s + ASK_AGAIN_S
    return Action()
