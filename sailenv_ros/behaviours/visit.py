"""A person who goes to things and looks at them."""

from __future__ import annotations

from typing import Any

import numpy as np
from pydantic import Field

from sailenv_ros.behaviours.base import Action, BodyState, behaviour
from sailenv_ros.behaviours.person import ASK_AGAIN_S, PersonParameters, free_person

__all__ = ["Visit", "visit"]


class Visit(PersonParameters):
    """Parameters of `visit`."""

    objects: tuple[str, ...] = Field(
        default=(), max_length=64, description="names of what is visited in turn; none: at random"
    )


@behaviour("visit", Visit)
def visit(
    parameters: Visit,
    time_s: float,
    body: BodyState,
    memory: dict[str, Any],
    rng: np.random.Generator,
) -> Action:
    """Walk to one object after another, and look at each."""
    person = free_person(parameters, time_s, body, memory, rng)
    if person is None:
        return Action()
    names = parameters.objects or person.things()
    if names:
        number = int(memory.get("number", -1)) + 1
        if not parameters.objects:
            number = int(rng.integers(len(names)))
        memory["number"] = number
        name = names[number % len(names)]
        if person.walk_near(name):
            person.look_at(name)
            return Action()
    memory["until_s"] = time_s + ASK_AGAIN_S
    return Action()
