"""Newest-wins mailboxes between the simulation's loop and those who look at frames.

The loop puts, a consumer takes; a slow consumer loses frames, which are counted, and never holds
up the loop or another consumer.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Collection

from sailenv_ros.errors import DeadlineExceeded, SimulationClosed
from sailenv_ros.frame.frame import Frame
from sailenv_ros.system.own_process import OwnProcess, StaysInProcess
from sailenv_ros.types.listed_views import Views, listed_views
from sailenv_ros.types.views import checked_views

__all__ = ["FrameStream"]


class FrameStream(StaysInProcess):
    """One consumer of one agent's frames at the agent's rate; a context manager.

    Parameters
    ----------
    agent : str
    views : str or iterable of str
        Views wanted; none at all means that nothing is rendered for this stream.
    supported : collection of str
        Views that the renderer can make.
    on_change : callable
        Called after the wanted views changed or the stream was closed.

    Raises
    ------
    UnknownName, InvalidRequest
        If there is no such view, or the renderer cannot make it.
    """

    def __init__(
        self,
        agent: str,
        views: Views,
        on_change: Callable[[FrameStream], None],
        *,
        supported: Collection[str],
    ) -> None:
        self.agent = agent
        self._process = OwnProcess("FrameStream")
        self._on_change = on_change
        self._ready = threading.Condition()
        self._frame: Frame | None = None
        self._ended = ""
        self._delivered = 0
        self._dropped = 0
        self._supported = supported
        self._views = self._checked(views)

    @property
    def views(self) -> tuple[str, ...]:
        """Views wanted now."""
        return self._views

    @property
    def delivered(self) -> int:
        """Number of frames that were taken out."""
        return self._delivered

    @property
    def dropped(self) -> int:
        """Number of frames replaced by newer ones before they were taken."""
        return self._dropped

    @property
    def closed(self) -> bool:
        """True once no more frames will come."""
        return bool(self._ended)

    def set_views(self, views: Views) -> None:
        """Change what is rendered for this stream, from the next frame on.

        Raises
        ------
        UnknownName, InvalidRequest
            If there is no such view, or the renderer cannot make it; nothing is changed then.
        """
        wanted = self._checked(views)
        if wanted != self._views:
            self._views = wanted
            self._on_change(self)

    def get(self, timeout_s: float) -> Frame:
        """Wait for a frame that was not taken before.

        Parameters
        ----------
        timeout_s : float
            Deadline [s of wall time].

        Raises
        ------
        DeadlineExceeded
            If none came in time.
        SimulationClosed
            If none will come: the agent was deleted, or the simulation or this stream closed, or
            it is another process's.
        """
        self._process.require()
        deadline = time.monotonic() + timeout_s
        with self._ready:
            while self._frame is None:
                if self._ended:
                    raise SimulationClosed(self._ended)
                remaining = deadline - time.monotonic()
                if remaining <= 0.0:
                    raise DeadlineExceeded(f"a frame of agent {self.agent!r}", timeout_s)
                self._ready.wait(remaining)
            frame, self._frame = self._frame, None
            self._delivered += 1
        return frame

    def put(self, frame: Frame) -> None:
        """Return the newest frame; called by the loop."""
        with self._ready:
            if self._ended:
                return
            if self._frame is not None:
                self._dropped += 1
            self._frame = frame
            self._ready.notify_all()

    def discard(self) -> None:
        """Drop a frame that was not taken yet: its world is no more; called by the loop."""
        with self._ready:
            if self._frame is not None:
                self._dropped += 1
                self._frame = None

    def end(self, why: str) -> None:
        """Announce that no more frames will come; called by the loop."""
        with self._ready:
            self._ended = self._ended or why
            self._ready.notify_all()

    def close(self) -> None:
        """Stop taking frames; a second call does nothing."""
        if not self._ended and not self._process.is_inherited:
            self.end("the stream was closed")
            self._views = ()
            self._on_change(self)

    def __enter__(self) -> FrameStream:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    def _checked(self, views: Views) -> tuple[str, ...]:
        # Here, not when a frame is due: there is nobody then to whom it could be refused.
        names = listed_views(views)
        return checked_views(names, supported=self._supported) if names else ()
