"""A person who sits down, gets up, and sits down elsewhere; an animal that sits on the floor."""

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

__all__ = ["Sit", "sit"]


class Sit(PersonParameters):
    """Parameters of `sit`."""

    legs: ClassVar[tuple[int, ...]] = (2, 4)

    seats: tuple[str, ...] = Field(
        default=(), max_length=64, description="names of the seats; none: whatever one can sit on"
    )
    sitting: tuple[Seconds, Seconds] = Field(
        default=(8.0, 30.0), description="shortest and longest time on a seat [s]"
    )


@resting_behaviour("sit", Sit)
def sit(parameters: Sit, person: Person) -> Rest:
    """Walk to a seat, sit for a while, get up, and go to the next."""
    return Rest("seated", parameters.sitting, parameters.seats, person.seats, person.sit_on)
