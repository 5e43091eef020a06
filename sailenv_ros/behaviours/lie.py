"""A person who lies down, gets up, and lies down elsewhere."""

from __future__ import annotations

from typing import Any

import numpy as np
from pydantic import Field

from sailenv_ros.behaviours.base import Action, BodyState, behaviour
from sailenv_ros.behaviours.person import PersonParameters, Rest, Seconds, rest_somewhere

__all__ = ["Lie", "lie"]


class Lie(PersonParameters):
    """Parameters of `lie`."""

    beds: tuple[str, ...] = Field(
        default=(), max_length=64, description="names of the beds; none: whatever one can lie on"
    )
    lying: tuple[Seconds, Seconds] = Field(
        default=(20.0, 60.0), description="shortest and longest time in a bed [s]"
    )


@behaviour("lie", Lie)
def lie(
    parameters: Lie,
    time_s: float,
    body: BodyState,
    memory: dict[str, Any],
    rng: np.random.Generator,
) -> Action:
    """Walk to a bed or a couch, lie for a while, get up, and go to the next."""
    person = body.person
    if person is not None and time_s >= 0.0:
        rest = Rest("lying", parameters.lying, parameters.beds, person.beds, person.lie_on)
        rest_somewhere(parameters, rest, time_s, person, memory, rng)
    return Action()
