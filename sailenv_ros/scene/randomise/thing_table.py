"""All that can be drawn at random: a new thing is one file in `things` and one entry here."""

from __future__ import annotations

from typing import Annotated, TypeAlias

from pydantic import Field

from sailenv_ros.scene.randomise.things.random_behaviour import RandomBehaviour
from sailenv_ros.scene.randomise.things.random_camera import RandomCamera
from sailenv_ros.scene.randomise.things.random_distractors import RandomDistractors
from sailenv_ros.scene.randomise.things.random_environment import RandomEnvironment
from sailenv_ros.scene.randomise.things.random_light import RandomLight
from sailenv_ros.scene.randomise.things.random_material import RandomMaterial
from sailenv_ros.scene.randomise.things.random_object import RandomObject
from sailenv_ros.scene.randomise.things.random_people import RandomPeople
from sailenv_ros.scene.randomise.things.random_spawn import RandomSpawn

__all__ = ["RandomThing"]

RandomThing: TypeAlias = Annotated[
    RandomObject
    | RandomMaterial
    | RandomLight
    | RandomEnvironment
    | RandomCamera
    | RandomDistractors
    | RandomSpawn
    | RandomPeople
    | RandomBehaviour,
    Field(discriminator="type"),
]
