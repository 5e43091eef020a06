"""A person or an animal that goes to things and looks at them."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from pydantic import Field

from sailenv_ros.behaviours.person import Person, PersonParameters, in_turn, person_behaviour

__all__ = ["Visit", "visit"]


class Visit(PersonParameters):
    """Parameters of `visit`."""

    legs: ClassVar[tuple[int, ...]] = (2, 4)

    objects: tuple[str, ...] = Field(
        default=(), max_length=64, description="names of what is visited in turn; none: at random"
    )


@person_behaviour("visit", Visit)
def visit(
    parameters: Visit,
    time_s: float,
    person: Person,
    memory: dict[str, Any],
    rng: np.random.Generator,
) -> bool:
    """Walk to one object after another, and look at each."""
    if parameters.objects:
        name = in_turn(parameters.objects, memory)
    else:
        seen = person.things()
        if not seen:
            return False
        name = seen[int(rng.integers(len(seen)))]
    if not person.walk_near(name):
        return False
    person.look_at(name)
    return True
