"""A person who opens doors and drawers by hand, and closes them."""

from __future__ import annotations

from typing import Any

import numpy as np
from pydantic import Field

from sailenv_ros.behaviours.person import Person, PersonParameters, in_turn, person_behaviour

__all__ = ["OpenByHand", "open_by_hand"]


class OpenByHand(PersonParameters):
    """Parameters of `open_by_hand`."""

    joints: tuple[str, ...] = Field(
        min_length=1, max_length=64, description="names of doors and drawers, in turn"
    )


@person_behaviour("open_by_hand", OpenByHand)
def open_by_hand(
    parameters: OpenByHand,
    time_s: float,
    person: Person,
    memory: dict[str, Any],
    rng: np.random.Generator,
) -> bool:
    """Walk to a door or a drawer and open it by hand, or close it if it is open."""
    return person.open(in_turn(parameters.joints, memory))
