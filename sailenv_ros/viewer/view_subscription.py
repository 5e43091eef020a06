"""One client's view of one agent: what it is shown, what is on its way to it, what it was sent.

Frames come from the agent's `AgentFeed`, which encodes them once for all. Never more are on their
way than the page has said to have shown; those that it misses meanwhile are counted.
"""

from __future__ import annotations

import collections
import threading
import time
from collections.abc import Callable

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.types.validation import is_integer
from sailenv_ros.types.views import FIVE_VIEWS, VIEWS
from sailenv_ros.viewer.encoding import FrameMessages

__all__ = ["IN_FLIGHT", "PROBED_VIEWS", "STALLED_S", "ViewSubscription"]

PROBED_VIEWS = tuple(view for view in FIVE_VIEWS if VIEWS[view].source != "lighting")
"""Rendered whatever is shown: their values are told of any pixel."""

IN_FLIGHT = 2
"""Frames on their way to a page: one is shown while the next one travels."""

KEPT = 6
"""Frames whose values may still be asked for."""

STALLED_S = 0.5
"""A client that has shown nothing for this long gets no frames until it has [s of wall time]."""


class ViewSubscription:
    """Frames of one agent for one client; used by the client's thread and the feed's.

    Parameters
    ----------
    agent : str
    views : tuple of str
        What is shown, checked.
    changed : threading.Condition
        The feed's; notified when this may take a frame, or wants another.
    send : callable
        Called in the feed's thread with each message.
    ended : callable
        Called in the feed's thread with the reason, if no more frames come.
    first_number : int
        Of its first frame.
    """

    def __init__(
        self,
        agent: str,
        views: tuple[str, ...],
        changed: threading.Condition,
        *,
        send: Callable[[bytes], None],
        ended: Callable[[str], None],
        first_number: int,
    ) -> None:
        self.agent = agent
        self.selected = 0
        self.dropped = 0
        self.ended = ended
        self.seen: object = None
        self.changed = changed
        self._views = views
        self._send = send
        self._number = first_number - 1
        self._shown = self._number
        self._full_since_s = 0.0
        self._missed: Frame | None = None
        self._frames: collections.OrderedDict[int, Frame] = collections.OrderedDict()

    # -- of the client ---------------------------------------------------------------------

    @property
    def next_number(self) -> int:
        """Number of the frame after the last one."""
        return self._number + 1

    @property
    def views(self) -> tuple[str, ...]:
        """Views that are shown."""
        return self._views

    def show(self, views: tuple[str, ...]) -> None:
        """Change what is shown, from the next frame on."""
        with self.changed:
            self._views = views
            self.changed.notify_all()

    def shown(self, number: object) -> None:
        """Take note that the page has shown a frame.

        Raises
        ------
        InvalidRequest
            If no such frame was sent.
        """
        with self.changed:
            if not is_integer(number):
                raise InvalidRequest("number of the frame", number, "an integer")
            if number > self._number:
                raise InvalidRequest("number of the frame", number, f"at most {self._number}")
            self._shown = max(self._shown, number)
            self.changed.notify_all()

    def frame(self, number: object = None) -> Frame:
        """Return a frame that was sent lately; None means the last one.

        Raises
        ------
        InvalidRequest
            If it is kept no longer, or was never sent.
        """
        with self.changed:
            if number is None and self._frames:
                return self._frames[self._number]
            if not isinstance(number, int) or number not in self._frames:
                accepted = f"one of the last {KEPT} that were sent"
                raise InvalidRequest("number of the frame", number, accepted)
            return self._frames[number]

    # -- of the feed -----------------------------------------------------------------------

    @property
    def has_turn(self) -> bool:
        """True if the page may be sent another frame."""
        return self._number - self._shown < IN_FLIGHT

    @property
    def stalls(self) -> bool:
        """True if the page has shown nothing for so long that nothing is rendered for it."""
        return not self.has_turn and time.monotonic() - self._full_since_s >= STALLED_S

    def lacks(self, frame: Frame) -> bool:
        """Return whether it may be sent a frame now that came while it had no turn."""
        return self.has_turn and self._missed is frame and {*self._views} <= frame.views.keys()

    def deliver(self, messages: FrameMessages) -> None:
        """Send a frame, or keep in mind that it came; one that never goes out is counted."""
        frame = messages.frame
        with self.changed:
            views = [view for view in self._views if view in frame.views]
            if self._missed not in (None, frame):
                self.dropped += 1
            self._missed = None if self.has_turn else frame
            if self._missed is not None or not views:
                return
            self._number += 1
            number = self._number
            self._frames[number] = frame
            while len(self._frames) > KEPT:
                self._frames.popitem(last=False)
            if not self.has_turn:
                self._full_since_s = time.monotonic()
        self._send(
            messages.message(views, number=number, selected=self.selected, dropped=self.dropped)
        )
