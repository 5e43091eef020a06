"""A person or an animal that walks from place to place."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from sailenv_ros.behaviours.person import Person, PersonParameters, person_behaviour

__all__ = ["WalkAround", "walk_around"]


class WalkAround(PersonParameters):
    """Parameters of `walk_around`."""

    legs: ClassVar[tuple[int, ...]] = (2, 4)


@person_behaviour("walk_around", WalkAround)
def walk_around(
    parameters: WalkAround,
    time_s: float,
    person: Person,
    memory: dict[str, Any],
    rng: np.random.Generator,
) -> bool:
    """Walk to random free places, with pauses."""
    place = person.random_place(rng)
    return place is not None and person.walk_to(place)
