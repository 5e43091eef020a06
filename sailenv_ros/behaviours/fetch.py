"""A person who takes things and puts them elsewhere."""

from __future__ import annotations

from typing import Any

import numpy as np
from pydantic import Field

from sailenv_ros.behaviours.base import Action, BodyState, behaviour
from sailenv_ros.behaviours.person import (
    ASK_AGAIN_S,
    PersonParameters,
    free_person,
    pause_between,
)

__all__ = ["Fetch", "fetch"]


class Fetch(PersonParameters):
    """Parameters of `fetch`."""

    objects: tuple[str, ...] = Field(
        min_length=1, max_length=64, description="names of things, in turn"
    )
    to: tuple[str, ...] = Field(
        min_length=1, max_length=64, description="names of furniture, in turn"
    )
    times: int = Field(default=1, ge=1, le=100_000, description="how many things are carried")


@behaviour("fetch", Fetch)
def fetch(
    parameters: Fetch,
    time_s: float,
    body: BodyState,
    memory: dict[str, Any],
    rng: np.random.Generator,
) -> Action:
    """Walk to a thing, take it, carry it to a piece of furniture, and put it down."""
    person = free_person(parameters, time_s, body, memory, rng)
    done = int(memory.get("done", 0))
    if person is None or done >= parameters.times:
        return Action()
    if memory.get("takes") and person.holds == parameters.objects[done % len(parameters.objects)]:
        memory["takes"], memory["puts"] = False, True
    elif memory.get("puts") and not person.holds:
        memory["puts"] = False
        memory["done"] = done + 1
        return pause_between(parameters, memory, time_s, rng)
    if memory.get("puts"):
        goes = person.put_on(parameters.to[done % len(parameters.to)])
    else:
        goes = memory["takes"] = person.take(parameters.objects[done % len(parameters.objects)])
    if not goes:
        memory["until_s"] = time_s + ASK_AGAIN_S
    return Action()
