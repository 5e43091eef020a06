"""One client's view of one agent: a thread that takes frames, encodes them and sends them.

A `FrameStream` in, messages out, never more on their way than the page has said to have shown. A
page that shows nothing more lets nothing be rendered for it.
"""

from __future__ import annotations

import collections
import logging
import threading
from collections.abc import Callable, Sequence

from sailenv_ros.errors import DeadlineExceeded, InvalidRequest, SailenvError
from sailenv_ros.frame import FIVE_VIEWS, VIEWS, Frame, checked_views
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.stream import FrameStream
from sailenv_ros.validation import is_integer
from sailenv_ros.viewer.debug_agent import NAME, DebugAgent
from sailenv_ros.viewer.encoding import packed_frame

__all__ = ["PROBED_VIEWS", "ViewSubscription"]

_log = logging.getLogger(__name__)

PROBED_VIEWS = tuple(view for view in FIVE_VIEWS if VIEWS[view].source != "lighting")
"""Rendered whatever is shown: their values are told of any pixel."""

IN_FLIGHT = 2
"""Frames on their way to a page: one is shown while the next one travels."""

KEPT = 6
"""Frames whose values may still be asked for."""

WAIT_S = 0.1
"""Between two looks at whether anything has changed while time stands still [s of wall time]."""

STALLED_S = 0.5
"""Who has shown nothing for so long gets nothing rendered until it has [s of wall time]."""


class ViewSubscription:
    """Frames of one agent for one client, from its making until `close`.

    Parameters
    ----------
    simulation : Simulation
    debug_agent : DebugAgent
    agent : str
    views : sequence of str
        What is shown; see `sailenv_ros.frame.VIEWS`.
    send : callable
        Called in this thread with each message.
    changes : callable
        Gives what is another value after each request that may have changed what is seen.
    ended : callable
        Called in this thread with the reason, if no more frames come although nobody closed it.
    first_number : int
        Of its first frame.
    """

    def __init__(
        self,
        simulation: Simulation,
        debug_agent: DebugAgent,
        *,
        agent: str,
        views: Sequence[str],
        send: Callable[[bytes], None],
        ended: Callable[[str], None],
        changes: Callable[[], object],
        first_number: int = 1,
    ) -> None:
        self.agent = agent
        self.selected = 0
        self._simulation = simulation
        self._debug_agent = debug_agent
        self._views = checked_views(views, supported=simulation.supported_views)
        self._send, self._ended, self._changes = send, ended, changes
        self._seen: object = None
        self._number = first_number - 1
        self._shown = self._number
        self._turn = threading.Condition()
        self._closed = False
        self._stream: FrameStream | None = None
        self._frames: collections.OrderedDict[int, Frame] = collections.OrderedDict()
        self._thread = threading.Thread(target=self._run, name="sailenv-viewer-watch", daemon=True)
        self._thread.start()

    @property
    def next_number(self) -> int:
        """Number of the frame after the last one."""
        return self._number + 1

    @property
    def rendered_views(self) -> tuple[str, ...]:
        """Views that are rendered for it now; none while its page stalls."""
        stream = self._stream
        return () if stream is None or stream.closed else stream.views

    def show(self, views: Sequence[str]) -> None:
        """Change what is shown, from the next frame on.

        Raises
        ------
        UnknownName, InvalidRequest
            If there is no such view, or the renderer cannot make it; nothing is changed then.
        """
        wanted = checked_views(views, supported=self._simulation.supported_views)
        with self._turn:
            self._views = wanted
            self._turn.notify_all()

    def shown(self, number: object) -> None:
        """Take note that the page has shown a frame.

        Raises
        ------
        InvalidRequest
            If no such frame was sent.
        """
        with self._turn:
            if not is_integer(number):
                raise InvalidRequest("number of the frame", number, "an integer")
            if number > self._number:
                raise InvalidRequest("number of the frame", number, f"at most {self._number}")
            self._shown = max(self._shown, number)
            self._turn.notify_all()

    def frame(self, number: object = None) -> Frame:
        """Return a frame that was sent lately; None means the last one.

        Raises
        ------
        InvalidRequest
            If it is kept no longer, or was never sent.
        """
        with self._turn:
            if number is None and self._frames:
                return self._frames[self._number]
            if not isinstance(number, int) or number not in self._frames:
                accepted = f"one of the last {KEPT} that were sent"
                raise InvalidRequest("number of the frame", number, accepted)
            return self._frames[number]

    def close(self) -> None:
        """End; does not wait for the thread, which ends by itself."""
        with self._turn:
            self._closed = True
            self._turn.notify_all()

    # -- in the thread ---------------------------------------------------------------------

    def _run(self) -> None:
        own = self.agent == NAME
        try:
            if own:
                self._debug_agent.begin()
            try:
                with self._simulation.stream(self.agent, self._rendered()) as stream:
                    self._stream = stream
                    self._pump(stream)
            finally:
                if own:
                    self._debug_agent.end()
        except SailenvError as error:
            if not self._closed:
                self._ended(str(error))
        except Exception:
            _log.exception("a viewer's frames end because of an internal error")
            self._ended("of an internal error, which the simulator's log shows")

    def _pump(self, stream: FrameStream) -> None:
        while self._may_send(stream):
            stream.set_views(self._rendered())
            seen = (self._changes(), self._views, self.selected)
            try:
                frame = stream.get(WAIT_S)
            except DeadlineExceeded:
                if not self._is_stale(seen):
                    continue  # slow, or nothing moves
                frame = self._simulation.capture(self._rendered(), agent=self.agent)
            self._seen = seen
            views = [view for view in self._views if view in frame.views]
            if views:
                self._deliver(frame, views)

    def _is_stale(self, seen: object) -> bool:
        """Say if time stands still, so that no frame will fall due, and something has changed.

        Of the web viewer's own agent alone: a capture counts among an agent's frames.
        """
        info = self._simulation.info
        stands = info.paused or info.mode == "lockstep"
        return stands and self.agent == NAME and seen != self._seen

    def _may_send(self, stream: FrameStream) -> bool:
        """Wait for the page; False if this was closed."""
        with self._turn:
            if not self._turn.wait_for(self._has_turn, STALLED_S):
                stream.set_views(())
                stream.discard()
                self._turn.wait_for(self._has_turn)
            return not self._closed

    def _has_turn(self) -> bool:
        return self._closed or self._number - self._shown < IN_FLIGHT

    def _deliver(self, frame: Frame, views: Sequence[str]) -> None:
        info = self._simulation.info
        ranges = (spec.depth_range_m for spec in info.agents if spec.name == frame.agent)
        message = packed_frame(
            frame,
            views,
            number=self._number + 1,
            categories=info.categories,
            depth_range_m=next(ranges, 10.0),
            selected=self.selected,
        )
        with self._turn:
            self._number += 1
            self._frames[self._number] = frame
            while len(self._frames) > KEPT:
                self._frames.popitem(last=False)
        self._send(message)

    def _rendered(self) -> tuple[str, ...]:
        return tuple(view for view in VIEWS if view in {*self._views, *PROBED_VIEWS})
