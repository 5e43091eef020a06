"""Lessons as a plan in physics steps: who comes when, who goes when, in which order.

`LessonsSpec` and the objects' entries in, `ScheduledLesson`s out. Pure arithmetic and seeded
generators; the same lessons and seed give the same plan.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from sailenv_ros.behaviours.durations import presence_s
from sailenv_ros.scene.spec import LessonSpec, LessonsSpec, ObjectSpec
from sailenv_ros.world.bullet import STEPS_PER_SECOND

__all__ = ["Lesson", "LessonPlan", "Presence", "ScheduledLesson", "steps_of"]

_ORDERS, _BEHAVIOURS = 1, 2
"""Purposes of a lap's generators: the order of the lessons, the behaviours of their objects."""


def steps_of(time_s: float) -> int:
    """Return the number of physics steps that is nearest to a time [s]."""
    return round(time_s * STEPS_PER_SECOND)


@dataclass(frozen=True, slots=True, kw_only=True)
class Presence:
    """When an object is there, in steps since the beginning of its lesson.

    Attributes
    ----------
    name : str
    enters : int
    leaves : int or None
        None: as the lesson ends.
    """

    name: str
    enters: int
    leaves: int | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Lesson:
    """One lesson.

    Attributes
    ----------
    name : str
    presences : tuple of Presence
    steps : int or None
        How long it takes; None without end.
    pause_steps : int
        After it.
    """

    name: str
    presences: tuple[Presence, ...]
    steps: int | None
    pause_steps: int

    @property
    def objects(self) -> tuple[str, ...]:
        """Names of its objects."""
        return tuple(presence.name for presence in self.presences)


@dataclass(frozen=True, slots=True, kw_only=True)
class ScheduledLesson:
    """A lesson in its lap.

    Attributes
    ----------
    lap, number : int
        From 1.
    lesson : Lesson
    endless : bool
        True if nothing ends it.
    draw : int
        Which lap's random numbers it has, from 1.
    """

    lap: int
    number: int
    lesson: Lesson
    endless: bool
    draw: int


class LessonPlan:
    """The turns of some lessons.

    Parameters
    ----------
    spec : LessonsSpec
        Checked by `behaviours.durations.lesson_errors`.
    objects : mapping of str to ObjectSpec
        All that lessons name, by their names.
    seed : int
        Of the simulation.
    """

    def __init__(self, spec: LessonsSpec, objects: Mapping[str, ObjectSpec], seed: int) -> None:
        self.spec = spec
        self.lessons = tuple(_lesson(entry, spec, objects) for entry in spec.sequence)
        self._seed = seed if spec.seed is None else spec.seed

    @property
    def count(self) -> int:
        """Lessons in a lap."""
        return len(self.lessons)

    def order(self, draw: int) -> tuple[int, ...]:
        """Return the order of a lap's lessons."""
        if not self.spec.shuffled:
            return tuple(range(self.count))
        order = self._generator(draw, _ORDERS).permutation(self.count)
        return tuple(int(number) for number in order)

    def seed_of(self, draw: int, seed: int) -> int:
        """Return the seed of the behaviours of a lap; the simulation's own in the first one."""
        if draw == 1 or not self.spec.varied:
            return seed
        return int(self._generator(draw, _BEHAVIOURS).integers(2**63))

    def turns(self) -> Iterator[ScheduledLesson]:
        """Yield one turn after another; they end only where the lessons do."""
        laps = self.spec.laps
        for lap in itertools.count(1):
            draw = lap if laps is None else (lap - 1) % laps + 1
            for number, place in enumerate(self.order(draw), start=1):
                last = lap == laps and number == self.count
                lesson = self.lessons[place]
                endless = lesson.steps is None or (last and self.spec.after == "go_on")
                yield ScheduledLesson(
                    lap=lap, number=number, lesson=lesson, endless=endless, draw=draw
                )
                if endless:
                    return
            if lap == laps and self.spec.after == "end":
                return

    def _generator(self, draw: int, purpose: int) -> np.random.Generator:
        entropy = [self._seed & 0xFFFFFFFF, self._seed >> 32, draw, purpose]
        return np.random.default_rng(np.random.SeedSequence(entropy))


def _lesson(entry: LessonSpec, spec: LessonsSpec, objects: Mapping[str, ObjectSpec]) -> Lesson:
    scheduled_objects = [objects[name] for name in entry.objects]
    pause_s = spec.pause if entry.pause is None else entry.pause
    return Lesson(
        name=entry.name or ", ".join(entry.objects)[:200],
        presences=tuple(
            Presence(
                name=scheduled.name,
                enters=steps_of(scheduled.appear),
                leaves=None if scheduled.leave is None else max(1, steps_of(scheduled.leave)),
            )
            for scheduled in scheduled_objects
        ),
        steps=_steps(entry, scheduled_objects),
        pause_steps=steps_of(pause_s),
    )


def _steps(entry: LessonSpec, scheduled_objects: list[ObjectSpec]) -> int | None:
    if entry.duration is not None:
        return max(1, steps_of(entry.duration))
    times = [
        presence_s(scheduled.model_dump(mode="json", exclude_unset=True))
        for scheduled in scheduled_objects
    ]
    known = [time_s for time_s in times if time_s is not None]
    return max(1, steps_of(max(known))) if len(known) == len(times) else None
