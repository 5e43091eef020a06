"""Operations on lessons: objects that come and go one after another, in laps."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.scene.entries import read_document
from sailenv_ros.simulation.operations.operation import Caller, operation
from sailenv_ros.simulation.operations.targets import HasLessons
from sailenv_ros.types.lessons import LessonState

__all__ = ["LessonOperations"]


def _lessons(what: str, value: object) -> Any:
    if isinstance(value, str):
        value = read_document(value)
    if value is not None and not isinstance(value, Mapping):
        raise InvalidRequest(what, value, "a mapping, as under lessons in a scene file")
    return value


class LessonOperations(Caller):
    """Lessons of a scene; every frame tells which one it is of, as `lesson`."""

    @operation(deadline_s=60.0, lessons=_lessons)
    @staticmethod
    def start_lessons(
        core: HasLessons, lessons: Mapping[str, Any] | str | None = None
    ) -> LessonState:
        """Begin lessons now, in the present world.

        Their objects leave, and come again with their lessons: where they stood at the start of
        the scene, and with behaviours that begin again. A reset begins those of the scene's file.

        Parameters
        ----------
        lessons : mapping, str or None
            ``sequence``, ``laps``, ``after``, ``pause``, ``shuffled``, ``varied``, ``seed`` as
            under `lessons` in a scene file, or its YAML or JSON text; None takes those of the
            scene.

        Returns
        -------
        state : LessonState
            As the first lesson begins.

        Raises
        ------
        InvalidState
            If the scene has no lessons and none are given.
        InvalidEntry
            If they cannot be held, for example because one has no end; nothing has changed then.

        >>> agent.start_lessons({"sequence": [{"objects": ["ball"]}]})  # doctest: +SKIP
        """
        core.orchestrator.start(lessons)
        state = core.orchestrator.state
        assert state is not None
        return state

    @operation()
    @staticmethod
    def stop_lessons(core: HasLessons) -> None:
        """Stop the lessons: what is there stays, what waits stays away.

        Raises
        ------
        InvalidState
            If none are going on.
        """
        core.orchestrator.stop()

    @operation()
    @staticmethod
    def get_lesson(core: HasLessons) -> LessonState | None:
        """Return where the lessons are; None if the scene has none."""
        return core.orchestrator.state
