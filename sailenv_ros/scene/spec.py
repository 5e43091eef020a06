"""Contents of a scene file: `SceneSpec`, validated and immutable.

Data type that leaves `scene/`: the description that the world is built from. Units in a file are
metres, kilograms, seconds and degrees; colours are ``#rrggbb`` (sRGB) or linear numbers; they are
kept linear.
"""

from __future__ import annotations

import colorsys
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from sailenv_ros.scene.field_types import Number, Switch, Text, optional
from sailenv_ros.scene.fields import Acceleration, Name, Rule, SceneModel
from sailenv_ros.scene.lesson_rules import pupils_exist, stays_its_lesson, visitors_stand_alone
from sailenv_ros.scene.randomise.random_rules import random_targets_exist
from sailenv_ros.scene.randomise.thing_table import RandomThing
from sailenv_ros.scene.room_rules import names_beside_room
from sailenv_ros.scene.rules import (
    at_most_one,
    carriers_exist,
    distinct,
    movers_exist,
    not_unlabelled,
    parents_exist,
    walls_need_a_room,
)
from sailenv_ros.scene.spec_body import BodySpec
from sailenv_ros.scene.spec_cameras import AgentSpecModel, MoverSpec, WaypointSpec
from sailenv_ros.scene.spec_joints import JointSpec, joints_hold
from sailenv_ros.scene.spec_lessons import LessonSpec, LessonsSpec
from sailenv_ros.scene.spec_look_at import LookAtSpec, faced_objects_exist
from sailenv_ros.scene.spec_objects import BehaviourSpec, ObjectSpec
from sailenv_ros.scene.spec_picture import PictureSpec
from sailenv_ros.scene.spec_robots import RobotSpec, robots_stand
from sailenv_ros.scene.spec_room import RoomSpec
from sailenv_ros.scene.spec_surroundings import (
    AreaLightSpec,
    DirectionalLightSpec,
    EnvironmentSpec,
    LightSpec,
    PointLightSpec,
    SpotLightSpec,
)
from sailenv_ros.types.labels import MAX_CATEGORY_ID, Category

__all__ = [
    "FIRST_SCENE_CATEGORY_ID",
    "AgentSpecModel",
    "AreaLightSpec",
    "BehaviourSpec",
    "BodySpec",
    "CategorySpec",
    "DirectionalLightSpec",
    "EnvironmentSpec",
    "LessonSpec",
    "LessonsSpec",
    "JointSpec",
    "LightSpec",
    "LookAtSpec",
    "MoverSpec",
    "ObjectSpec",
    "PictureSpec",
    "PointLightSpec",
    "RobotSpec",
    "RoomSpec",
    "SceneSpec",
    "SpotLightSpec",
    "WaypointSpec",
]

FIRST_SCENE_CATEGORY_ID = 200
"""Ids from here on, but 255, belong to scenes and packs, the others to `config/categories.yaml`."""


class CategorySpec(SceneModel):
    """A category that the fixed table lacks."""

    rules: ClassVar[tuple[Rule, ...]] = (not_unlabelled,)

    name: Annotated[
        str,
        Text(r"[a-z0-9][a-z0-9 _-]{0,62}", "lower-case letters, digits and spaces, at most 63"),
    ] = Field(description="not the name of another category")
    id: Annotated[int, Number(least=FIRST_SCENE_CATEGORY_ID, most=MAX_CATEGORY_ID, whole=True)] = (
        Field(description="value of its pixels, not 255; above 255 the category view has 16 bits")
    )
    colour: (
        Annotated[str, Text("#[0-9a-fA-F]{6}", "a colour such as '#ff8800' (quoted)")] | None
    ) = optional("of its pictures (sRGB); chosen by the id if left out")

    def to_category(self) -> Category:
        """Return the data type that labels take."""
        if self.colour is not None:
            red, green, blue = bytes.fromhex(self.colour[1:])
            return Category(id=self.id, name=self.name, colour=(red, green, blue))
        # Steps of the golden angle keep the hues of neighbouring ids far apart.
        shares = colorsys.hsv_to_rgb(self.id * 0.618034 % 1.0, 0.55, 0.9)
        red, green, blue = (round(255 * share) for share in shares)
        return Category(id=self.id, name=self.name, colour=(red, green, blue))


class SceneSpec(SceneModel):
    """A scene: its surroundings, lights, objects, movers and agents."""

    rules: ClassVar[tuple[Rule, ...]] = (
        at_most_one("mover", "movers"),
        distinct(
            "name", "lights", "objects", "robots", "movers", "agents", "categories", "randomise"
        ),
        random_targets_exist,
        distinct("id", "categories"),
        movers_exist,
        faced_objects_exist,
        carriers_exist,
        parents_exist,
        joints_hold,
        robots_stand,
        walls_need_a_room,
        names_beside_room,
        pupils_exist,
        stays_its_lesson,
        visitors_stand_alone,
    )

    version: Annotated[Literal[1], Number(least=1, most=1, whole=True)] = Field(
        description="of this format; 1"
    )
    name: Name = Field(
        default="scene", description="the file's name without .yaml, which is the default"
    )
    title: str = Field(default="", max_length=200, description="one line for people")
    description: str = Field(default="", max_length=10000, description="what the scene is for")
    gravity: Acceleration = Field(
        default=(0.0, 0.0, -9.81), description="acceleration of what falls [m/s2]"
    )
    settled: Annotated[bool, Switch()] = Field(
        default=True,
        description="true: objects that nearly stand begin at rest; false: all begin exactly "
        "where the file says",
    )
    environment: EnvironmentSpec = Field(
        default_factory=EnvironmentSpec, description="ambient light, sky, exposure"
    )
    lights: tuple[LightSpec, ...] = Field(
        default=(), max_length=64, description="lights, besides the environment"
    )
    room: RoomSpec | None = optional("walls, floor and ceiling around the origin, with openings")
    objects: tuple[ObjectSpec, ...] = Field(
        default=(), max_length=10000, description="objects of the scene"
    )
    robots: tuple[RobotSpec, ...] = Field(
        default=(), max_length=16, description="robots of URDF and MJCF files"
    )
    mover: MoverSpec | None = optional("the track that agents follow")
    movers: tuple[MoverSpec, ...] = Field(
        default=(), max_length=16, description="several tracks, instead of mover"
    )
    agents: tuple[AgentSpecModel, ...] = Field(
        default=(), max_length=16, description="cameras that the scene brings along"
    )
    randomise: tuple[RandomThing, ...] = Field(
        default=(), max_length=1000, description="what is drawn at random, by its seed"
    )
    lessons: LessonsSpec | None = optional("objects that come and go one after another, in laps")
    categories: tuple[CategorySpec, ...] = Field(
        default=(), max_length=10000, description="categories that the fixed table lacks"
    )

    @property
    def all_movers(self) -> tuple[MoverSpec, ...]:
        """The movers, at least one: the first is the one that agents follow by default."""
        if self.movers:
            return self.movers
        return (self.mover or MoverSpec(),)

    @property
    def lesson_objects(self) -> frozenset[str]:
        """Names of the objects that come and go with lessons."""
        return frozenset() if self.lessons is None else self.lessons.names

    @property
    def transient_objects(self) -> frozenset[str]:
        """Names of the objects that are not there all the time."""
        passing = (e.name for e in self.objects if e.appear or e.leave is not None)
        return self.lesson_objects.union(passing)
