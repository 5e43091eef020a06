"""A person who sits down, gets up, and sits down elsewhere."""

from __future__ import annotations

from typing import Any

import numpy as np
from pydantic import Field

from sailenv_ros.behaviours.base import Action, BodyState, behaviour
from sailenv_ros.behaviours.person import (
    ASK_AGAIN_S,
    PersonParameters,
    Seconds,
    pause_between,
    waits,
)

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
    if person is None or time_s < 0.0:
        return Action()
    if person.activity == "seated":
        low, high = parameters.sitting
        until = memory.setdefault("up_s", time_s + float(rng.uniform(low, max(low, high))))
        if time_s >= until:
            person.get_up()
        return Action()
    if person.activity != "standing":
        return Action()
    if memory.pop("up_s", None) is not None:
        return pause_between(parameters, memory, time_s, rng)
    if waits(memory, time_s):
        return Action()
    free = person.seats()
    wanted = [name for name in parameters.seats or free if name in free]
    for place in rng.permutation(len(wanted)).tolist():
        if person.sit_on(wanted[place]):
            return Action()
    memory["until_s"] = time_s + ASK_AGAIN_S
    return Action()
