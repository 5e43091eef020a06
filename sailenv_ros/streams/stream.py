"""A stream as a sequence: frames by number, slices, iteration, worker processes, test sets."""

from __future__ import annotations

import os
import threading
import weakref
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, overload

from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.streams.course import MOST_FRAMES, Course, load_course
from sailenv_ros.streams.labels import PixelLabel, pixel_labels
from sailenv_ros.streams.plan import StreamPlan
from sailenv_ros.streams.player import Player
from sailenv_ros.streams.state import DriftRecord
from sailenv_ros.types.validation import checked_integer
from sailenv_ros.types.views import checked_views

__all__ = ["VIEWS", "Stream", "StreamFrame", "open"]

VIEWS = ("rgb", "category", "instance", "flow")
"""Views of a frame unless others are asked for."""

_MOST_SEED = 2**63 - 1


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class StreamFrame:
    """A frame of a stream.

    Attributes
    ----------
    number : int
    room : str
        Name of its scene.
    episode : int
        The room began again with it. Its first frame has no flow: there is none before.
    habit : str
        How the camera goes: ``walk``, ``carry``, ``fixate`` or ``stand``.
    drift : mapping of str to DriftRecord
    frame : Frame
        Views, camera, ids and all that other frames have.
    """

    number: int
    room: str
    episode: int
    habit: str
    drift: Mapping[str, DriftRecord]
    frame: Frame

    @property
    def views(self) -> Mapping[str, NDArray[Any]]:
        """Its views by name, read-only."""
        return self.frame.views

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Return a view by its name."""
        return self.frame.views[name]

    def labels(self, count: int = 1, *, seed: int = 0) -> tuple[PixelLabel, ...]:
        """Return labels of random pixels; see `pixel_labels`."""
        return pixel_labels(self.views, self.number, seed=seed, count=count)

    def arrays(self) -> dict[str, Any]:
        """Return number and views as what a `torch` collate function takes."""
        return {"number": self.number, **{name: view.copy() for name, view in self.views.items()}}


def open(
    course: str | Path | Course = "home",
    *,
    seed: int = 0,
    views: Sequence[str] = VIEWS,
    length: int = MOST_FRAMES,
    format: str = "frame",
) -> Stream:
    """Open a stream. Nothing is made before a frame is asked for.

    Parameters
    ----------
    course : str, Path or Course
        One of `courses`, a file, or what was loaded.
    seed : int
        0 to 2**63 - 1; the same course, seed and views give the same bytes.
    views : sequence of str
    length : int
        Frames, 1 to 10,000,000.
    format : {'frame', 'arrays'}
        Whether frames are `StreamFrame` or dicts of arrays, as a `DataLoader` takes them.

    Raises
    ------
    UnknownName, InvalidRequest, SceneError
        If an argument, or the course, is not accepted.
    """
    loaded = course if isinstance(course, Course) else load_course(course)
    if format not in ("frame", "arrays"):
        raise InvalidRequest("format", format, "'frame' or 'arrays'")
    return Stream(
        loaded,
        seed=checked_integer("seed", seed, 0, _MOST_SEED),
        views=checked_views(views),
        frames=range(checked_integer("length", length, 1, MOST_FRAMES)),
        as_arrays=format == "arrays",
    )


class _Players:
    """Players of a stream and of its parts: one in each thread that asks for frames."""

    def __init__(self) -> None:
        self._players: dict[tuple[int, int], Player] = {}
        weakref.finalize(self, _close, self._players).atexit = False

    @property
    def current(self) -> Player | None:
        """That of this thread of this process; the setter takes one that was made."""
        return self._players.get((os.getpid(), threading.get_ident()))

    @current.setter
    def current(self, player: Player) -> None:
        self._players[os.getpid(), threading.get_ident()] = player

    def close(self) -> None:
        """Free their simulations."""
        _close(self._players)


def _close(players: dict[tuple[int, int], Player]) -> None:
    """Close those of this process; others belong to the one that this was forked from."""
    while players:
        (process, _), player = players.popitem()
        if process == os.getpid():
            player.close()


class Stream(Sequence[Any]):
    """Frames by their numbers; see `open`.

    A thread, or a process that was forked or to which it was sent, makes a simulation of its own;
    parts of a stream share that of the stream. Going ahead is cheap, going back begins an episode
    again.
    """

    def __init__(
        self,
        course: Course,
        *,
        seed: int,
        views: tuple[str, ...],
        frames: range,
        as_arrays: bool,
        variant: str = "",
        drift_at: int | None = None,
        players: _Players | None = None,
    ) -> None:
        self._course, self._seed, self._views = course, seed, views
        self._frames, self._as_arrays = frames, as_arrays
        self._variant, self._drift_at = variant, drift_at
        self._plan = StreamPlan(course, seed, variant)
        self._players = players or _Players()

    @property
    def course(self) -> Course:
        """The course that it follows."""
        return self._course

    @property
    def rooms(self) -> tuple[str, ...]:
        """Names of the rooms that it visits."""
        return self._plan.rooms

    def __len__(self) -> int:
        """Return the number of frames."""
        return len(self._frames)

    @overload
    def __getitem__(self, place: int) -> Any: ...

    @overload
    def __getitem__(self, place: slice) -> Stream: ...

    def __getitem__(self, place: int | slice) -> Any:
        """Return a frame by its place, or a part of the stream as a stream.

        Raises
        ------
        IndexError
            If there is no such frame.
        SailenvError
            If its room cannot be made or built.
        """
        if isinstance(place, slice):
            return self._other(frames=self._frames[place], players=self._players)
        return self._made(self._frames[place])

    def __iter__(self) -> Iterator[Any]:
        """Yield all frames in their order."""
        for number in self._frames:
            yield self._made(number)

    def as_frames(self) -> Iterator[StreamFrame]:
        """Yield all frames in their order as `StreamFrame`, whatever the stream's format."""
        for number in self._frames:
            yield self._frame(number)

    def drift(self, place: int) -> Mapping[str, DriftRecord]:
        """Return what drifts do to a frame, without making it."""
        number = self._frames[place] if self._drift_at is None else self._drift_at
        return self._course.state(number, self._seed)[1]

    def test_set(self, at: int, frames: int, *, rooms: str = "same") -> Stream:
        """Return frames that are not in the stream, with its world as it is at a frame.

        Parameters
        ----------
        at : int
            The checkpoint: the number of a frame.
        frames : int
            How many; they are spread over episodes of their own.
        rooms : {'same', 'other'}
            Whether they are of the stream's rooms, at another time, or of rooms that it never
            visits.

        Raises
        ------
        InvalidRequest
            If an argument is not accepted, or other rooms are asked for where none are generated.
        """
        at = checked_integer("at", at, 0, MOST_FRAMES - 1)
        frames = checked_integer("frames", frames, 1, MOST_FRAMES)
        if rooms not in ("same", "other"):
            raise InvalidRequest("rooms", rooms, "'same' or 'other'")
        if rooms == "other" and not self._course.rooms.kinds:
            raise InvalidRequest("rooms", rooms, "'same', as the course generates no rooms")
        # A visit is as long as a test: each room gives as many frames as it can.
        variant = f"{'rooms' if rooms == 'other' else 'time'} {at}"
        spread = self._course.episode * self._course.visit
        step = max(1, spread * len(self._plan.rooms) // frames)
        return self._other(
            frames=range(1, min(MOST_FRAMES, 1 + step * frames), step),
            variant=variant,
            drift_at=at,
        )

    def close(self) -> None:
        """Free its simulation, which its parts share; the next frame makes another."""
        self._players.close()

    def __enter__(self) -> Stream:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    def __getstate__(self) -> dict[str, Any]:
        """Leave the simulation behind."""
        return {
            "course": self._course, "seed": self._seed, "views": self._views,
            "frames": self._frames, "as_arrays": self._as_arrays, "variant": self._variant,
            "drift_at": self._drift_at,
        }  # fmt: skip

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__init__(**state)  # type: ignore[misc]  # made of the same arguments again

    # -- inside ----------------------------------------------------------------------------

    def _other(self, **changes: Any) -> Stream:
        return Stream(**{**self.__getstate__(), **changes})

    def _made(self, number: int) -> Any:
        made = self._frame(number)
        return made.arrays() if self._as_arrays else made

    def _frame(self, number: int) -> StreamFrame:
        place = self._plan.place(number)
        player = self._players.current
        if player is None:
            player = Player(self._course, self._plan, self._seed, self._views, self._drift_at)
            self._players.current = player
        frame, drift = player.frame(place)
        return StreamFrame(
            number=number,
            room=place.room,
            episode=place.episode,
            habit=place.habit,
            drift=drift,
            frame=frame,
        )
