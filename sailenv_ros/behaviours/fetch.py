"""A person who takes things and puts them elsewhere."""

from __future__ import annotations

from typing import Any

import numpy as np
from pydantic import Field

from sailenv_ros.behaviours.person import (
    Person,
    PersonParameters,
    pause,
    person_behaviour,
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


@person_behaviour("fetch", Fetch)
def fetch(
    parameters: Fetch,
    time_s: float,
    person: Person,
    memory: dict[str, Any],
    rng: np.random.Generator,
) -> bool:
    """Walk to a thing, take it, carry it to a piece of furniture, and put it down."""
    done = int(memory.get("done", 0))
    if done >= parameters.times:
        return True
    thing = parameters.objects[done % len(parameters.objects)]
    if memory.get("takes") and person.holds == thing:
        memory["takes"], memory["puts"] = False, True
    elif memory.get("puts") and not person.holds:
        memory["puts"], memory["done"] = False, done + 1
        pause(parameters, time_s, memory, rng)
        return True
    if memory.get("puts"):
        return person.put_on(parameters.to[done % len(parameters.to)])
    memory["takes"] = person.take(thing)
    return bool(memory["takes"])
