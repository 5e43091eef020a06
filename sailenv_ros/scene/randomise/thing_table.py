"""All that can be drawn at random: a new thing is one file in `things` and one entry here."""

from __future__ import annotations

from typing import Annotated, TypeAlias

from pydantic import Field

from sailenv_ros.scene.randomise.things.cameras import RandomCamera
from sailenv_ros.scene.randomise.things.distractors import RandomDistractors
from sailenv_ros.scene.randomise.things.lights import RandomLight
from sailenv_ros.scene.randomise.things.materials import RandomMaterial
from sailenv_ros.scene.randomise.things.objects import RandomObject
from sailenv_ros.scene.randomise.things.surroundings import RandomEnvironment

__all__ = ["RandomThing"]

RandomThing: TypeAlias = Annotated[
    RandomObject
    | RandomMaterial
    | RandomLight
    | RandomEnvironment
    | RandomCamera
    | RandomDistractors,
    Field(discriminator="type"),
]
