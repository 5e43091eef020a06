"""A person who sits down, gets up, and sits down elsewhere."""

from __future__ import annotations

from typing import Any

import numpy as np
from pydantic import Field

from sailenv_ros.behaviours.base import Action, BodyState, behaviour
from sailenv_ros.behaviours.person import PersonParameters, Rest, Seconds, rest_somewhere

__all__ = ["Sit", "sit"]


class Sit(PersonParameters):
    """Parameters of `sit`."""

    seats: tuple[str, ...] = Field(
        default=(), max_length=64, description="names of the seats; none: whatever one can sit on"
    )
    sitting: tuple[Seconds, Seconds] = Field(
        default=(8.0, 30.0), description="shortest and longest time on a seat [s]"
    )


@behaviour("sit", Sit)
def sit(
    parameters: Sit,
    time_s: float,
    body: BodyState,
    memory: dict[str, Any],
    rng: np.random.Generator,
) -> Action:
    """Walk to a seat, sit for a while, get up, and go to the next."""
    person = body.person
    if person is not None and time_s >= 0.0:
        rest = Rest("seated", parameters.sitting, parameters.seats, person.seats, person.sit_on)
        rest_somewhere(parameters, rest, time_s, person, memory, rng)
    return Action()
