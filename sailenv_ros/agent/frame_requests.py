"""How a user gets frames: one rendered now, or one after another at a rate. Part of `Agent`."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from sailenv_msgs.srv import Capture, SetRate
from sailenv_ros.agent.connection import Connection
from sailenv_ros.agent.frame_sync import Bundle
from sailenv_ros.agent.received import frame_of_bundle
from sailenv_ros.agent.topics import AgentTopics
from sailenv_ros.agents import MAX_RATE_HZ, AgentSpec
from sailenv_ros.errors import DeadlineExceeded, InvalidRequest
from sailenv_ros.frame import checked_views
from sailenv_ros.scene_info import SceneInfo

__all__ = ["FrameRequests"]

QUIET_S = 1.0
"""A sent frame of which nothing more arrives for so long is given up and asked for anew [s].

Our transport profiles mend a loss in some 30 ms, but a user's own may take 3 s for it.
"""


class FrameRequests:
    """Requests for an agent's frames; see `Agent`.

    Attributes
    ----------
    recaptured : int
        How often a frame was asked for anew because images did not arrive.
    """

    recaptured: int

    _connection: Connection
    _lock: threading.RLock
    _spec: AgentSpec
    _timeout_s: float
    _topics: AgentTopics | None

    @property
    def _own_topics(self) -> AgentTopics:
        """The agent's topics; `SimulationClosed` after it was deleted."""
        raise NotImplementedError

    def _call_own(self, srv_type: Any, service: str, request: Any) -> Any:
        """Ask a service of this agent; give its answer, which says success."""
        raise NotImplementedError

    def _await_info(self, condition: Callable[[SceneInfo], bool], what: str) -> None:
        """Wait until the simulator has announced something."""
        raise NotImplementedError

    def get_frame(
        self, views: Sequence[str] = (), *, timeout_s: float | None = None
    ) -> dict[str, Any]:
        """Have one frame rendered now and give it.

        It shows the world after everything that this agent asked for before.

        Parameters
        ----------
        views : sequence of str
            More views than the agent's own, by their names in `sailenv_ros.frame.VIEWS`; rendered
            for this frame alone.
        timeout_s : float or None
            Deadline [s]; None means the agent's own.

        Returns
        -------
        frame : dict
            See `sailenv_ros.agent.frame_dict.frame_dict`; every array is the caller's own.

        Raises
        ------
        SimulatorLost
            If the simulator has ended.
        DeadlineExceeded
            If no complete frame arrived in time; `recaptured` counts the attempts that were
            repeated because images did not arrive.
        """
        self._connection.check_process()
        wanted = checked_views([*self._spec.views, *views]) if views else self._spec.views
        limit_s = self._timeout_s if timeout_s is None else timeout_s
        deadline = time.monotonic() + limit_s
        with self._lock:
            while (left_s := deadline - time.monotonic()) > 0.0:
                frame = self._capture(wanted, left_s)
                if frame is not None:
                    return frame
                self.recaptured += 1
        raise DeadlineExceeded(f"the images of a frame of agent {self._spec.name!r}", limit_s)

    def frames(
        self, rate_hz: float = 30.0, *, timeout_s: float | None = None
    ) -> Iterator[dict[str, Any]]:
        """Give frame after frame at a rate of simulated time, the newest each time.

        Whoever is slower than the rate passes frames over, which shows in their `sequence`. The
        rate ends with the iteration; a view asked of `get_frame` before is in these frames too.

        Parameters
        ----------
        rate_hz : float
            Frames per simulated second, above 0 and up to 240.
        timeout_s : float or None
            Deadline of each frame [s]; None means the agent's own.

        Yields
        ------
        frame : dict
            As of `get_frame`.

        Raises
        ------
        SimulatorLost, DeadlineExceeded
            If no frame came in time.
        """
        if isinstance(rate_hz, bool) or not isinstance(rate_hz, int | float) or not rate_hz > 0.0:
            raise InvalidRequest("rate_hz", rate_hz, f"above 0 and at most {MAX_RATE_HZ:g} [Hz]")
        limit_s = self._timeout_s if timeout_s is None else timeout_s
        self._set_rate(float(rate_hz))
        try:
            sequence = 0
            while True:
                bundle = self._own_topics.take_newer(sequence, self._spec.views, limit_s)
                sequence = bundle.sequence
                yield self._frame_of(bundle)
        finally:
            if self._topics is not None and self._connection.simulator_lives():
                self._set_rate(0.0)

    def _set_rate(self, rate_hz: float) -> None:
        self._call_own(SetRate, "set_rate", SetRate.Request(rate_hz=rate_hz))

    def _capture(self, views: tuple[str, ...], timeout_s: float) -> dict[str, Any] | None:
        """Have a frame rendered and sent; give None if images of it were lost."""
        deadline = time.monotonic() + timeout_s
        topics = self._own_topics
        if topics.add_views(views):
            topics.await_publishers(timeout_s)
        topics.clear()
        request = Capture.Request(views=list(views))
        service = f"{self._spec.name}/capture"
        answer = self._connection.call(Capture, service, request, timeout_s)
        left_s = max(0.0, deadline - time.monotonic())
        bundle = topics.take(answer.sequence, left_s, QUIET_S)
        if bundle is None or set(bundle.images) != set(views):
            return None
        return self._frame_of(bundle)

    def _frame_of(self, bundle: Bundle) -> dict[str, Any]:
        # The ids of a frame are to be found in `instances` from now on.
        revision = bundle.info.revision
        self._await_info(lambda info: info.revision >= revision, "what the frame shows")
        return frame_of_bundle(bundle, self._spec.intrinsics)
