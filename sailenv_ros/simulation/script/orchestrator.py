"""Lets objects come and go as the scene says: by their own times, and in lessons.

A world and its description in; at the physics steps at which something is due, the world is changed
and described again. Counts steps, knows no clock.
"""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from sailenv_ros.errors import InvalidState
from sailenv_ros.scene.entries import checked_lessons, read_document
from sailenv_ros.scene.spec import LessonsSpec, ObjectSpec
from sailenv_ros.simulation.clock import Clock
from sailenv_ros.simulation.live_scene import LiveScene
from sailenv_ros.simulation.script.lesson_plan import LessonPlan, ScheduledLesson, steps_of
from sailenv_ros.types.lessons import LessonState
from sailenv_ros.world.bullet import sim_time_ns

__all__ = ["Orchestrator"]


class Orchestrator:
    """Schedule of appearing and leaving objects in one simulation; used by one thread alone.

    Parameters
    ----------
    scene : LiveScene
    clock : Clock
        Stopped as lessons end, where it runs by itself.
    on_enter : callable
        Told the instance id of each object that has just come.
    """

    def __init__(
        self, scene: LiveScene, clock: Clock, on_enter: Callable[[int], None] = lambda id_: None
    ) -> None:
        self._scene = scene
        self._clock = clock
        self._on_enter = on_enter
        self._order = itertools.count()
        self._events: list[tuple[int, int, Callable[[], None]]] = []
        self._lesson_events: list[tuple[int, int, Callable[[], None]]] = []
        self._plan: LessonPlan | None = None
        self._turns: Iterator[ScheduledLesson] = iter(())
        self._turn: ScheduledLesson | None = None
        self._ids: dict[str, int] = {}
        self._state: LessonState | None = None

    # -- what is read ----------------------------------------------------------------------

    @property
    def state(self) -> LessonState | None:
        """State of the lessons; None while there are none."""
        return self._state

    @property
    def next_step(self) -> int | None:
        """The physics step at which something is due next; None if nothing is."""
        ahead = [events[0][0] for events in (self._events, self._lesson_events) if events]
        return min(ahead, default=None)

    # -- what is done ----------------------------------------------------------------------

    def begin(self) -> None:
        """Begin with a world that has just been built."""
        world, described = self._scene.world, self._scene.world.described
        self._events, self._lesson_events = [], []
        self._plan, self._turn, self._state, self._ids = None, None, None, {}
        if described is None:
            return
        ids = self._all_ids()
        lesson_objects = described.lesson_objects
        for entry in described.objects:
            id_ = ids.get(entry.name)
            if id_ is None or entry.name in lesson_objects:
                continue  # drawn away, or it comes with a lesson
            if entry.appear:
                self._at(self._events, steps_of(entry.appear), partial(self._come, entry.name, id_))
            if entry.leave is not None:
                leaves = max(1, steps_of(entry.leave))
                self._at(self._events, leaves, partial(self._go, entry.name, id_))
        if described.lessons is not None:
            objects = {entry.name: entry for entry in described.objects}
            self._start(described.lessons, objects, ids, at_step=world.step_count)
        self.act()

    def act(self) -> None:
        """Do what is due at the present step."""
        step = self._scene.world.step_count
        due = self.next_step
        if due is None or due > step:
            return
        with self._scene.announce.once():
            for events in (self._events, self._lesson_events):
                # What a lesson does may end with the beginning of the next one.
                while events and events[0][0] <= step:
                    heapq.heappop(events)[2]()
            self._scene.announce()

    def start(self, lessons: Mapping[str, Any] | str | None) -> None:
        """Begin lessons now, in the present world; see the operation `start_lessons`."""
        world = self._scene.world
        assert world.described is not None
        objects, of_scene = self._present_entries(), world.described.lessons
        if isinstance(lessons, str):
            lessons = read_document(lessons)
        if lessons is None and of_scene is None:
            raise InvalidState("the scene has no lessons; say by lessons what comes when")
        if lessons is None and of_scene is not None:
            lessons = of_scene.model_dump(mode="json", exclude_unset=True)
        knowledge = self._scene.library.knowledge_of(world.scene)
        spec = checked_lessons(lessons, objects.values(), knowledge)
        ids = self._all_ids()
        for name in sorted(spec.names):
            world.require_free(ids[name])
        before = frozenset(self._ids)
        world.described = world.described.model_copy(update={"lessons": spec})
        with self._scene.announce.once():
            for name in sorted(before | spec.names):
                self._leave(ids[name])
            self._start(spec, objects, ids, at_step=world.step_count)
            self.act()
            self._scene.announce()

    def stop(self) -> None:
        """Let lessons come to no end: what is there stays, what waits stays away."""
        if self._state is None or self._state.phase in ("stopped", "ended"):
            raise InvalidState("there are no lessons that could be stopped")
        self._lesson_events = []
        self._state = replace(self._state, phase="stopped", ends_ns=0)
        self._scene.announce()

    # -- inside ----------------------------------------------------------------------------

    def _start(
        self,
        spec: LessonsSpec,
        objects: Mapping[str, ObjectSpec],
        ids: Mapping[str, int],
        *,
        at_step: int,
    ) -> None:
        self._plan = LessonPlan(spec, objects, self._scene.seed)
        self._ids = {name: ids[name] for name in spec.names if name in ids}
        self._turns, self._lesson_events = self._plan.turns(), []
        self._at(self._lesson_events, at_step, self._next_turn)

    def _next_turn(self) -> None:
        now = self._scene.world.step_count
        turn = next(self._turns, None)
        if turn is None:
            assert self._state is not None
            self._state = replace(self._state, phase="ended")
            if self._clock.runs_by_itself:
                self._clock.set_paused(True)
            return
        self._turn = turn
        lesson = turn.lesson
        ends = None if turn.endless or lesson.steps is None else now + lesson.steps
        for presence in lesson.presences:
            id_ = self._ids.get(presence.name)
            if id_ is None:
                continue  # drawn away at random
            if ends is not None and now + presence.enters >= ends:
                continue
            self._at_lesson(now + presence.enters, partial(self._enter, id_, turn.draw))
            if presence.leaves is not None and (ends is None or now + presence.leaves < ends):
                self._at_lesson(now + presence.leaves, partial(self._leave, id_))
        if ends is not None:
            self._at_lesson(ends, self._end_turn)
            self._at_lesson(ends + lesson.pause_steps, self._next_turn)
        assert self._plan is not None
        self._state = LessonState(
            phase="lesson",
            lap=turn.lap,
            laps=self._plan.spec.laps or 0,
            number=turn.number,
            count=self._plan.count,
            name=lesson.name,
            objects=lesson.objects,
            begins_ns=sim_time_ns(now),
            ends_ns=0 if ends is None else sim_time_ns(ends),
        )

    def _end_turn(self) -> None:
        assert self._turn is not None
        assert self._state is not None
        for name in self._turn.lesson.objects:
            if name in self._ids:
                self._leave(self._ids[name])
        self._state = replace(self._state, phase="pause")

    def _come(self, name: str, instance_id: int) -> None:
        if name not in self._ids:  # lessons that were begun since have it otherwise
            self._enter(instance_id, 1)

    def _go(self, name: str, instance_id: int) -> None:
        if name not in self._ids:
            self._leave(instance_id)

    def _enter(self, instance_id: int, draw: int) -> None:
        scene, world = self._scene, self._scene.world
        if instance_id in world.waiting:
            seed = scene.seed if self._plan is None else self._plan.seed_of(draw, scene.seed)
            world.enter(instance_id, seed=seed)
            self._on_enter(instance_id)

    def _leave(self, instance_id: int) -> None:
        if instance_id in self._scene.world.bodies_by_id:
            self._scene.world.leave(instance_id)

    def _at_lesson(self, step: int, do: Callable[[], None]) -> None:
        self._at(self._lesson_events, step, do)

    def _at(
        self, events: list[tuple[int, int, Callable[[], None]]], step: int, do: Callable[[], None]
    ) -> None:
        heapq.heappush(events, (step, next(self._order), do))

    def _all_ids(self) -> dict[str, int]:
        world = self._scene.world
        there = {body.placement.name: id_ for id_, body in world.numbered_bodies}
        return {**there, **world.waiting.names()}

    def _present_entries(self) -> dict[str, ObjectSpec]:
        """Return what a scene file says of each object, also of those that wait."""
        world = self._scene.world
        there = [body.placement for body in world.bodies]
        waiting = [world.waiting[id_] for id_ in world.waiting]
        return {p.name: p.entry for p in (*there, *waiting) if p.entry is not None}
