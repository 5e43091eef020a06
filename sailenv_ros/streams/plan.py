"""Room, episode and camera of each frame of a stream: numbers alone."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

from sailenv_ros.authoring.room_rules.names import MAX_SEED, PREFIX
from sailenv_ros.authoring.room_rules.random_stream import RandomStream
from sailenv_ros.streams.course import Course

__all__ = ["HABITS", "Place", "StreamPlan"]

HABITS = ("walk", "carry", "fixate", "stand")
"""How the camera goes in an episode."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """Where a frame is in its stream.

    Attributes
    ----------
    frame : int
    episode : int
    offset : int
        Of the frame in its episode.
    room : str
        Name of the scene.
    habit : str
        One of `HABITS`.
    """

    frame: int
    episode: int
    offset: int
    room: str
    habit: str

    @property
    def first(self) -> int:
        """Number of the first frame of its episode."""
        return self.frame - self.offset


class StreamPlan:
    """Finds places.

    Parameters
    ----------
    course : Course
    seed : int
        Of the stream.
    variant : str
        Empty for the stream itself. Other texts stand for other episodes in the same rooms, and
        those that begin with ``rooms`` for episodes in other rooms.
    """

    def __init__(self, course: Course, seed: int, variant: str = "") -> None:
        self._course, self._seed, self._variant = course, seed, variant
        spec = course.rooms
        salt = variant if variant.startswith("rooms") else ""
        dice = RandomStream("rooms", seed, salt)
        generated = [
            f"{PREFIX}{spec.kinds[number % len(spec.kinds)]}:{dice.whole((0, MAX_SEED))}"
            for number in range(spec.count if spec.kinds else 0)
        ]
        self._rooms = (*spec.scenes, *generated)
        self._order = lru_cache(maxsize=8)(self._mixed)
        self._habit = lru_cache(maxsize=8)(self._drawn_habit)

    @property
    def rooms(self) -> tuple[str, ...]:
        """Names of all rooms."""
        return self._rooms

    def place(self, frame: int) -> Place:
        """Return where a frame is."""
        episode, offset = divmod(frame, self._course.episode)
        tour, number = divmod(episode // self._course.visit, len(self._rooms))
        return Place(
            frame=frame,
            episode=episode,
            offset=offset,
            room=self._order(tour)[number],
            habit=self._habit(episode),
        )

    def dice(self, episode: int, purpose: str) -> RandomStream:
        """Return random numbers of an episode, for one purpose."""
        return RandomStream("episode", self._seed, self._variant, episode, purpose)

    def _drawn_habit(self, episode: int) -> str:
        """Return the camera's habit in an episode."""
        weights = [getattr(self._course.eye, habit) for habit in HABITS]
        return self.dice(episode, "habit").weighted(HABITS, weights)

    def _mixed(self, tour: int) -> tuple[str, ...]:
        """Return the order in which all rooms are visited on a tour."""
        return tuple(RandomStream("tour", self._seed, self._variant, tour).mixed(self._rooms))
