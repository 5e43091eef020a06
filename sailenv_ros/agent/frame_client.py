"""How a client gets an agent's frames: one captured now, or the newest of those at a rate."""

from __future__ import annotations

import time

from sailenv_msgs.srv import Capture
from sailenv_msgs_py.error_codes import error_from_response
from sailenv_ros.agent.frame_sync import Bundle
from sailenv_ros.agent.frame_topics import AgentTopics
from sailenv_ros.agent.received import frame_of_bundle
from sailenv_ros.agent.remote import RemoteSimulator
from sailenv_ros.agents import AgentSpec
from sailenv_ros.errors import DeadlineExceeded
from sailenv_ros.frame import Frame

__all__ = ["FrameClient"]

QUIET_S = 1.0
"""A sent frame of which nothing more arrives for so long is given up and asked for anew [s].

Our transport profiles repair a loss in some 30 ms, but a user's own may take 3 s for it.
"""


class FrameClient:
    """Frames of one agent.

    Parameters
    ----------
    remote : RemoteSimulator
    spec : AgentSpec
        As it is wanted; the agent need not exist yet.

    Attributes
    ----------
    recaptured : int
        How often a frame was asked for anew because images did not arrive.
    """

    def __init__(self, remote: RemoteSimulator, spec: AgentSpec) -> None:
        self._remote = remote
        self._spec = spec
        # Readers first: the agent's publishers then know them from their first message on.
        self._topics = AgentTopics(remote.connection, spec.name, spec.views)
        self.recaptured = 0

    def begin(self, spec: AgentSpec, timeout_s: float) -> None:
        """Wait for the topics of the agent, which has been registered."""
        self._spec = spec
        self._topics.await_publishers(timeout_s)

    def capture(self, views: tuple[str, ...] | None, timeout_s: float) -> Frame:
        """Have one frame rendered now; its arrays are nobody else's.

        Raises
        ------
        SimulatorLost
            If the simulator has ended.
        DeadlineExceeded
            If no complete frame arrived in time.
        """
        wanted = self._spec.views if views is None else views
        deadline = time.monotonic() + timeout_s
        while (left_s := deadline - time.monotonic()) > 0.0:
            bundle = self._captured(wanted, left_s)
            frame = None if bundle is None else self._frame_of(bundle, deadline)
            if frame is not None:
                return frame
            self.recaptured += 1
        raise DeadlineExceeded(f"the images of a frame of agent {self._spec.name!r}", timeout_s)

    def newer(self, sequence: int, timeout_s: float) -> Frame:
        """Wait for the newest streamed frame with a number above the given one."""
        deadline = time.monotonic() + timeout_s
        left_s = timeout_s
        while True:
            bundle = self._topics.take_newer(sequence, self._spec.views, left_s)
            frame = self._frame_of(bundle, deadline)
            if frame is not None:
                return frame
            left_s = max(0.0, deadline - time.monotonic())

    def close(self) -> None:
        """End the subscriptions."""
        self._topics.close()

    def _captured(self, views: tuple[str, ...], timeout_s: float) -> Bundle | None:
        """Have a frame rendered and sent; return None if images of it were lost."""
        deadline = time.monotonic() + timeout_s
        if self._topics.add_views(views):
            self._topics.await_publishers(timeout_s)
        self._topics.clear()
        request = Capture.Request(views=list(views))
        service = f"{self._spec.name}/capture"
        response = self._remote.connection.call(Capture, service, request, timeout_s)
        if not response.success:
            raise error_from_response(response)
        left_s = max(0.0, deadline - time.monotonic())
        bundle = self._topics.take(response.sequence, left_s, QUIET_S)
        return bundle if bundle is not None and set(bundle.images) == set(views) else None

    def _frame_of(self, bundle: Bundle, deadline: float) -> Frame | None:
        """Make a frame with the scene of its own instant; None if that was lost on the way."""
        left_s = max(0.0, deadline - time.monotonic())
        info = self._remote.connection.await_revision(bundle.info.revision, left_s)
        if info is None:
            return None
        specs = {spec.name: spec for spec in info.agents}
        spec = specs.get(self._spec.name, self._spec)
        return frame_of_bundle(bundle, spec.intrinsics, info)
