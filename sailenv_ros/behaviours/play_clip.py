"""A person who moves as a clip of recorded motion says."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from sailenv_ros.assets.motions import find_clip
from sailenv_ros.behaviours.person import ClipPlay, Person, PersonParameters, person_behaviour
from sailenv_ros.errors import AssetError
from sailenv_ros.scene.field_types import Number, Text, field_error, optional

__all__ = ["PlayClip", "play_clip"]


@dataclass(frozen=True, slots=True)
class _Clip(Text):
    """The name of a clip that can be read."""

    def check(self, value: object) -> str:
        """Return the name, or raise a `field_error`."""
        name = Text.check(self, value)
        try:
            find_clip(name)
        except AssetError as problem:
            raise field_error(f"must be a clip that can be read: {problem}") from None
        return name


class PlayClip(PersonParameters):
    """Parameters of `play_clip`."""

    clip: Annotated[str, _Clip(r"[^\x00-\x1f]{1,300}", "the name of a clip")] = Field(
        description="a BVH file of yours, or PACKAGE:path of a Python package"
    )
    place: tuple[float, float] | None = optional("where it begins [m]; left out: here")
    facing: Annotated[float, Number(least=-360.0, most=360.0, unit="deg")] | None = optional(
        "about the vertical, at the beginning [deg]; left out: any"
    )
    times: Annotated[int, Number(least=1, most=1000, whole=True)] = Field(
        default=1, description="each from where the last one ended"
    )
    speed: Annotated[float, Number(least=0.1, most=4.0)] = Field(
        default=1.0, description="1 as it was recorded"
    )


@person_behaviour("play_clip", PlayClip)
def play_clip(
    parameters: PlayClip,
    time_s: float,
    person: Person,
    memory: dict[str, Any],
    rng: np.random.Generator,
) -> bool:
    """Walk to a place, play a clip there, pause, and begin again."""
    return person.play(
        ClipPlay(
            *(parameters.clip, parameters.times, parameters.speed),
            *(parameters.place, parameters.facing),
        )
    )
