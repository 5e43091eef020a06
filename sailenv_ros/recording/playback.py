"""When which message of a recording is due: rate, pause, start offset, loops.

`RecordingReader` in, numbers of messages and waiting times out. Asks no clock itself: the caller
says what time it is. Knows no ROS.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from sailenv_ros.errors import InvalidRequest, RecordingError
from sailenv_ros.recording.reader import RecordingReader
from sailenv_ros.types.validation import is_finite_number

__all__ = ["PlaybackClock", "Programme", "programme"]

MAX_RATE = 1000.0


@dataclass(slots=True, kw_only=True)
class PlaybackClock:
    """Computes how long to wait for a moment of the recording.

    Attributes
    ----------
    rate : float
        Recorded seconds per second, above 0 and at most 1000.
    start_ns : int
        Log time at which playing begins [ns].

    Raises
    ------
    InvalidRequest
        If the rate is out of its range.
    """

    rate: float = 1.0
    start_ns: int = 0
    _position_ns: float = field(default=0.0, init=False)
    _since_s: float | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        if not 0.0 < self.rate <= MAX_RATE:
            raise InvalidRequest("rate", self.rate, f"above 0 and at most {MAX_RATE:g}")
        self._position_ns = float(self.start_ns)

    @property
    def paused(self) -> bool:
        """True while it stands; it does at first."""
        return self._since_s is None

    def position_ns(self, now_s: float) -> float:
        """Return the log time that is played now [ns]."""
        if self._since_s is None:
            return self._position_ns
        return self._position_ns + (now_s - self._since_s) * self.rate * 1e9

    def resume(self, now_s: float) -> None:
        """Run on; does nothing if it runs."""
        if self._since_s is None:
            self._since_s = now_s

    def pause(self, now_s: float) -> None:
        """Stand; does nothing if it stands."""
        self._position_ns = self.position_ns(now_s)
        self._since_s = None

    def rewind(self, now_s: float) -> None:
        """Go back to the beginning, running or standing as before."""
        self._position_ns = float(self.start_ns)
        if self._since_s is not None:
            self._since_s = now_s

    def wait_s(self, log_ns: int, now_s: float) -> float:
        """Return how long to wait for that log time [s]; infinite while paused, 0 if it is due."""
        left_ns = log_ns - self.position_ns(now_s)
        if left_ns <= 0.0 and not self.paused:
            return 0.0
        return math.inf if self.paused else left_ns * 1e-9 / self.rate


@dataclass(frozen=True, slots=True, kw_only=True)
class Programme:
    """Messages to play, and the time at which playing starts.

    Attributes
    ----------
    rows : tuple of int
        Numbers of the reader's messages, in order of time.
    before : tuple of int
        Those that are sent at once: the last message of each latched topic before the start.
    start_ns, end_ns : int
        Log times of the start and of the last message [ns].
    """

    rows: tuple[int, ...]
    before: tuple[int, ...]
    start_ns: int
    end_ns: int


def programme(reader: RecordingReader, topics: Sequence[str], start_s: float = 0.0) -> Programme:
    """Choose what is played.

    Parameters
    ----------
    reader : RecordingReader
    topics : sequence of str
        Names.
    start_s : float
        Where to start, from the first message that is not latched [s]: a latched one may be much
        older than the recording.

    Raises
    ------
    InvalidRequest
        If the start is no number from 0 on.
    RecordingError
        If there is nothing at or after the start.
    """
    if not (is_finite_number(start_s) and start_s >= 0.0):
        raise InvalidRequest("start", start_s, "0 or more [s]")
    latched = [t for t in topics if reader.topic(t).qos.durability == "transient_local"]
    moving = [t for t in topics if t not in latched] or list(topics)
    firsts = [int(reader.log_ns(reader.rows(t))[0]) for t in moving if len(reader.rows(t))]
    if not firsts:
        raise RecordingError(f"{reader.path} has no message to be played")
    start_ns = min(firsts) + round(start_s * 1e9)
    rows = np.sort(np.concatenate([reader.rows(t) for t in topics]))
    times = reader.log_ns(rows)
    chosen = rows[times >= start_ns]
    if not len(chosen):
        length_s = (int(times[-1]) - min(firsts)) * 1e-9
        raise InvalidRequest("start", start_s, f"from 0 to {length_s:g} [s] in {reader.path}")
    before = []
    for name in latched:
        own = reader.rows(name)
        earlier = own[reader.log_ns(own) < start_ns]
        before += [int(earlier[-1])] if len(earlier) else []
    return Programme(
        rows=tuple(map(int, chosen)),
        before=tuple(before),
        start_ns=start_ns,
        end_ns=int(reader.log_ns(int(chosen[-1]))),
    )
