"""Progress of an orchestrated stream: the current lesson and lap; sent with each frame.

Made by `simulation/`, goes to frames, messages, recordings and windows.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal, TypeAlias, get_args

from sailenv_ros.errors import InvalidRequest

__all__ = ["LessonPhase", "LessonState"]

LessonPhase: TypeAlias = Literal["lesson", "pause", "ended", "stopped"]


@dataclass(frozen=True, slots=True, kw_only=True)
class LessonState:
    """State of the lessons at an instant.

    Attributes
    ----------
    phase : {'lesson', 'pause', 'ended', 'stopped'}
        ``pause``: the lesson is over, and its objects are gone; ``ended``: the last lap is over;
        ``stopped``: somebody has stopped the lessons.
    lap : int
        Counts from 1; counts on where the laps are run through again.
    laps : int
        How many there are; 0 for no end.
    number : int
        Of the lesson in its lap, from 1.
    count : int
        How many lessons a lap has.
    name : str
        Of the lesson.
    objects : tuple of str
        Names of the objects that it brings.
    begins_ns : int
        Simulated time at which the lesson began [ns].
    ends_ns : int
        Simulated time at which its objects are gone [ns]; 0 for no end.
    """

    phase: LessonPhase
    lap: int
    laps: int
    number: int
    count: int
    name: str
    objects: tuple[str, ...]
    begins_ns: int
    ends_ns: int

    def to_json(self) -> str:
        """Return it as JSON text, by the names above."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> LessonState:
        """Read what `to_json` has written.

        Raises
        ------
        InvalidRequest
            If it is something else.
        """
        try:
            given = json.loads(text)
        except (ValueError, RecursionError):
            given = None
        if not isinstance(given, Mapping) or not _is_state(given):
            raise InvalidRequest("lesson", text[:100], "the JSON text of a LessonState")
        return cls(**{**given, "objects": tuple(given["objects"])})

    def __str__(self) -> str:
        """Return it for people to read: ``lap 2 of 30, lesson 1 of 4: ewer``."""
        laps = f" of {self.laps}" if self.laps else ""
        more = "" if self.phase == "lesson" else f" ({self.phase})"
        return f"lap {self.lap}{laps}, lesson {self.number} of {self.count}: {self.name}{more}"


_NUMBERS = ("lap", "laps", "number", "count", "begins_ns", "ends_ns")


def _is_state(given: Mapping[str, Any]) -> bool:
    return (
        set(given) == {*_NUMBERS, "phase", "name", "objects"}
        and all(type(given[key]) is int and given[key] >= 0 for key in _NUMBERS)
        and given["phase"] in get_args(LessonPhase)
        and isinstance(given["name"], str)
        and isinstance(given["objects"], list)
        and all(isinstance(name, str) for name in given["objects"])
    )
