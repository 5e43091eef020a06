"""Lessons of a scene file: which objects come when, for how long, and how often."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, TypeAlias, get_args

from pydantic import Field

from sailenv_ros.scene.field_types import Choice, Number, Switch, optional
from sailenv_ros.scene.fields import Name, Rule, SceneModel
from sailenv_ros.scene.lesson_rules import after_needs_laps
from sailenv_ros.scene.rules import distinct, distinct_values

__all__ = ["LessonSpec", "LessonsSpec"]

After: TypeAlias = Literal["end", "loop", "go_on"]

_Pause: TypeAlias = Annotated[float, Number(least=0.0, most=1e6, unit="s")]


class LessonSpec(SceneModel):
    """One lesson: some objects come, move for a time, and leave."""

    rules: ClassVar[tuple[Rule, ...]] = (distinct_values("objects"),)

    name: Name | None = optional("those of its objects if left out")
    objects: tuple[Name, ...] = Field(
        min_length=1,
        max_length=1000,
        description="its objects, absent outside of their lessons",
    )
    duration: Annotated[float, Number(above=0.0, most=1e6, unit="s")] | None = optional(
        "[s]; default: until its objects rest"
    )
    pause: _Pause | None = optional(
        "after it, without its objects [s]; that of the lessons if left out"
    )


class LessonsSpec(SceneModel):
    """Lessons one after another, in laps."""

    rules: ClassVar[tuple[Rule, ...]] = (after_needs_laps, distinct("name", "sequence"))

    sequence: tuple[LessonSpec, ...] = Field(
        min_length=1, max_length=1000, description="the lessons of a lap"
    )
    laps: Annotated[int, Number(least=1, most=1_000_000, whole=True)] | None = optional(
        "default: unlimited"
    )
    after: Annotated[After, Choice(get_args(After))] = Field(
        default="end",
        description="after the last lap. end: the objects stay away, realtime is paused; "
        "loop: the laps begin again; go_on: the last lesson does not end",
    )
    pause: _Pause = Field(default=0.0, description="after each lesson, without its objects [s]")
    shuffled: Annotated[bool, Switch()] = Field(
        default=False, description="true: their order is drawn for each lap"
    )
    varied: Annotated[bool, Switch()] = Field(
        default=False,
        description="true: behaviours draw other random numbers in each lap",
    )
    seed: Annotated[int, Number(least=0, most=2**63 - 1, whole=True)] | None = optional(
        "of orders and varied laps, instead of the simulation's"
    )

    @property
    def names(self) -> frozenset[str]:
        """Names of all objects that come and go with lessons."""
        return frozenset(name for lesson in self.sequence for name in lesson.objects)
