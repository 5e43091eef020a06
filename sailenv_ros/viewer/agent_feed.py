"""One agent's frames for all clients that watch it: one thread takes, encodes and sends them.

A `FrameStream` in, messages out. A frame is encoded once, however many are sent it; while nobody is
ready for another, nothing is rendered.
"""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Iterable, Sequence

from sailenv_ros.errors import DeadlineExceeded, SailenvError
from sailenv_ros.frame.frame import Frame
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.frame_stream import FrameStream
from sailenv_ros.types.views import VIEWS, checked_views
from sailenv_ros.viewer.debug_agent import NAME, DebugAgent
from sailenv_ros.viewer.encoding import FrameMessages
from sailenv_ros.viewer.view_subscription import PROBED_VIEWS, STALLED_S, ViewSubscription

__all__ = ["AgentFeeds"]

_log = logging.getLogger(__name__)

_CLOSE_TIMEOUT_S = 5.0

WAIT_S = 0.1
"""Interval at which changes are looked for while time stands still [s of wall time]."""


class AgentFeeds:
    """The feeds of one server, each from its agent's first watcher to its last.

    Parameters
    ----------
    simulation : Simulation
    debug_agent : DebugAgent
    touched : callable
        Gives how many requests there were that may have changed what is seen.
    """

    def __init__(
        self, simulation: Simulation, debug_agent: DebugAgent, touched: Callable[[], int]
    ) -> None:
        self._simulation = simulation
        self._debug_agent = debug_agent
        self._touched = touched
        self._guard = threading.Lock()
        self._feeds: dict[str, _AgentFeed] = {}
        self._ending: list[_AgentFeed] = []

    @property
    def rendered_views(self) -> frozenset[str]:
        """Views that are rendered for somebody now; none for those that stall."""
        with self._guard:
            return frozenset(view for feed in self._feeds.values() for view in feed.rendered_views)

    def checked(self, views: Sequence[str]) -> tuple[str, ...]:
        """Return views that can be shown.

        Raises
        ------
        UnknownName, InvalidRequest
            If there is no such view, or the renderer cannot make it.
        """
        return checked_views(views, supported=self._simulation.supported_views)

    def watch(
        self,
        agent: str,
        views: Sequence[str],
        *,
        send: Callable[[bytes], None],
        ended: Callable[[str], None],
        first_number: int,
    ) -> ViewSubscription:
        """Begin to send an agent's frames; see `ViewSubscription`.

        Raises
        ------
        UnknownName, InvalidRequest
            If there is no such view, or the renderer cannot make it.
        """
        checked = self.checked(views)
        with self._guard:
            while True:
                feed = self._feeds.get(agent)
                if feed is None:
                    feed = self._feeds[agent] = _AgentFeed(
                        self._simulation, self._debug_agent, agent, self._touched
                    )
                watcher = ViewSubscription(
                    agent, checked, feed.changed, send=send, ended=ended, first_number=first_number
                )
                if feed.join(watcher):
                    return watcher
                # It ends just now.
                self._ending = [old for old in self._ending if old.running]
                self._ending.append(self._feeds.pop(agent))

    def close(self) -> None:
        """End all feeds, and wait for that: the agent of this server is gone then."""
        with self._guard:
            feeds = [*self._feeds.values(), *self._ending]
        for feed in feeds:
            feed.close()

    def leave(self, watcher: ViewSubscription) -> None:
        """Send nothing more."""
        with self._guard:
            feed = self._feeds.get(watcher.agent)
            if feed is not None and feed.changed is watcher.changed:
                feed.leave(watcher)


class _AgentFeed:
    """The thread of one agent's frames; begins with its first watcher and ends with its last."""

    def __init__(
        self,
        simulation: Simulation,
        debug_agent: DebugAgent,
        agent: str,
        touched: Callable[[], int],
    ) -> None:
        self.changed = threading.Condition()
        self._simulation = simulation
        self._debug_agent = debug_agent
        self._agent = agent
        self._touched = touched
        self._watchers: list[ViewSubscription] = []
        self._ended = False
        self._stream: FrameStream | None = None
        self._newest: FrameMessages | None = None
        self._thread = threading.Thread(target=self._run, name="sailenv-viewer-feed", daemon=True)

    @property
    def rendered_views(self) -> tuple[str, ...]:
        """Views that are rendered for it now."""
        stream = self._stream
        return () if stream is None or stream.closed else stream.views

    def join(self, watcher: ViewSubscription) -> bool:
        """Begin to send frames to one more; False if this has ended."""
        with self.changed:
            if self._ended:
                return False
            if not self._watchers:
                self._thread.start()
            self._watchers.append(watcher)
            self.changed.notify_all()
            return True

    def leave(self, watcher: ViewSubscription) -> None:
        """Send nothing more to one."""
        with self.changed:
            if watcher in self._watchers:
                self._watchers.remove(watcher)
                self._ended = not self._watchers
                self.changed.notify_all()

    @property
    def running(self) -> bool:
        """True until its thread has ended."""
        return self._thread.is_alive()

    def close(self) -> None:
        """Send nothing more to anybody, and wait for the thread to end."""
        with self.changed:
            self._ended = True
            self._watchers.clear()
            self.changed.notify_all()
        self._thread.join(_CLOSE_TIMEOUT_S)
        if self.running:
            _log.warning("frames of agent %r have not ended in time", self._agent)

    # -- in the thread ---------------------------------------------------------------------

    def _run(self) -> None:
        own, why = self._agent == NAME, ""
        try:
            if own:
                self._debug_agent.begin()
            try:
                with self._simulation.stream(self._agent, ()) as stream:
                    self._stream = stream
                    self._pump(stream)
            finally:
                if own:
                    self._debug_agent.end()
        except SailenvError as error:
            why = str(error)
        except Exception:
            _log.exception("a viewer's frames end because of an internal error")
            why = "of an internal error, which the simulator's log shows"
        with self.changed:
            self._ended = True
            left, self._watchers = self._watchers, []
        for watcher in left:
            watcher.ended(why)

    def _pump(self, stream: FrameStream) -> None:
        while wanted := self._awaited_views(stream):
            stream.set_views(wanted)
            states = {watcher: self._state_of(watcher) for watcher in self._ready()}
            takers = None
            try:
                frame = stream.get(WAIT_S)
            except DeadlineExceeded:
                takers = self._stale(states)
                if not takers:
                    continue  # slow, or nothing moves
                frame = self._simulation.capture(wanted, agent=self._agent)
            # Where time stands, a frame that waited in the stream may be of an earlier instant.
            age_ns = self._simulation.sim_time_ns - frame.stamp_ns
            if age_ns <= frame.camera.picture.delay_ns(frame.camera.intrinsics.height) or (
                not self._stands()
            ):
                for watcher, state in states.items():
                    watcher.seen = state
            self._deliver(frame, takers)

    def _awaited_views(self, stream: FrameStream) -> tuple[str, ...]:
        """Wait until somebody can take a frame; return what to render, nothing if all have left."""
        while True:
            self._deliver_late()
            with self.changed:
                if not self._watchers:
                    return ()
                if any(watcher.has_turn for watcher in self._watchers):
                    return _rendered(w.views for w in self._watchers if not w.stalls)
                if all(watcher.stalls for watcher in self._watchers):
                    stream.set_views(())
                    stream.discard()
                    self._newest = None
                    self.changed.wait()
                else:
                    self.changed.wait(STALLED_S)

    def _deliver_late(self) -> None:
        """Send the newest frame to those who were not ready for it when it came."""
        newest = self._newest
        if newest is not None and newest.frame.epoch == self._simulation.info.epoch:
            for watcher in self._all():
                if watcher.lacks(newest.frame):
                    watcher.deliver(newest)

    def _deliver(self, frame: Frame, takers: Iterable[ViewSubscription] | None) -> None:
        info = self._simulation.info
        ranges = (spec.depth_range_m for spec in info.agents if spec.name == frame.agent)
        self._newest = FrameMessages(
            frame, categories=info.categories, depth_range_m=next(ranges, 10.0)
        )
        for watcher in self._all() if takers is None else takers:
            watcher.deliver(self._newest)

    def _stale(self, states: dict[ViewSubscription, object]) -> list[ViewSubscription]:
        """Return who should see something new though time stands still, so that no frame falls due.

        Of the web viewer's own agent alone: a capture counts among an agent's frames.
        """
        if self._agent != NAME or not self._stands():
            return []
        return [watcher for watcher, state in states.items() if state != watcher.seen]

    def _stands(self) -> bool:
        info = self._simulation.info
        return info.paused or info.mode == "lockstep"

    def _state_of(self, watcher: ViewSubscription) -> object:
        """Return what is another value after each change of what one sees."""
        return self._simulation.info.revision, self._touched(), watcher.views, watcher.selected

    def _ready(self) -> list[ViewSubscription]:
        return [watcher for watcher in self._all() if watcher.has_turn]

    def _all(self) -> list[ViewSubscription]:
        with self.changed:
            return list(self._watchers)


def _rendered(shown: Iterable[tuple[str, ...]]) -> tuple[str, ...]:
    wanted = {view for views in shown for view in views}
    return tuple(view for view in VIEWS if view in {*wanted, *PROBED_VIEWS})
