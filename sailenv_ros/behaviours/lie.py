"""People who lie down, get up, and lie down elsewhere; animals that lie, cats on furniture."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from sailenv_ros.behaviours.person import (
    Person,
    PersonParameters,
    Rest,
    Seconds,
    resting_behaviour,
)

__all__ = ["Lie", "lie"]


class Lie(PersonParameters):
    """Parameters of `lie`."""

    legs: ClassVar[tuple[int, ...]] = (2, 4)

    beds: tuple[str, ...] = Field(
        default=(), max_length=64, description="names of the beds; none: whatever one can lie on"
    )
    lying: tuple[Seconds, Seconds] = Field(
        default=(20.0, 60.0), description="shortest and longest time in a bed [s]"
    )


@resting_behaviour("lie", Lie)
def lie(parameters: Lie, person: Person) -> Rest:
    """Walk to a bed or a couch, lie for a while, get up, and go to the next."""
    return Rest("lying", parameters.lying, parameters.beds, person.beds, person.lie_on)
