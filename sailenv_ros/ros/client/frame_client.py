"""Fetches an agent's frames: one captured now, or the newest of a stream at a given rate.

Captured ones come through shared memory where the simulator is on this machine and of this user;
else, and at a rate, by topics.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Mapping
from functools import partial
from typing import Any

from numpy.typing import NDArray

from sailenv_msgs.msg import FrameInfo
from sailenv_msgs.srv import Capture
from sailenv_msgs_py.error_codes import error_from_response
from sailenv_msgs_py.images import view_from_image
from sailenv_msgs_py.services import SERVICES
from sailenv_ros.errors import DeadlineExceeded
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.recording.frames import frame_of_info
from sailenv_ros.ros.client.direct_frames import DirectFrames, Disconnected, WantedFrame
from sailenv_ros.ros.client.frame_sync import Bundle
from sailenv_ros.ros.client.frame_topics import AgentTopics
from sailenv_ros.ros.client.remote import RemoteSimulator
from sailenv_ros.simulation.operations import Operations
from sailenv_ros.system.memory import keep_freed_memory
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["FrameClient"]

_log = logging.getLogger(__name__)

QUIET_S = 1.0
"""A sent frame of which nothing more arrives for so long is given up and asked for again [s].

Our transport profiles repair a loss in some 30 ms, but a user's own may take 3 s for it.
"""

RESEND_S = 2.0
"""A capture by service that is unanswered for so long is asked for once more [s]."""


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
        How often a frame was asked for again because images did not arrive.
    """

    def __init__(self, remote: RemoteSimulator, spec: AgentSpec) -> None:
        # A frame's bytes are received into arrays of megabytes: their memory serves the next ones.
        keep_freed_memory()
        self._remote = remote
        self._spec = spec
        # Readers first: the agent's publishers then know them from their first message on.
        self._topics = AgentTopics(remote.connection, spec.name, spec.views)
        self._direct: DirectFrames | None = None
        self._matched = False
        self._by_topics_alone = False
        self._last_captured = 0
        self.recaptured = 0

    def begin(self, spec: AgentSpec, timeout_s: float) -> None:
        """Wait for the topics of the agent, which has been registered."""
        self._spec = spec
        self._topics.begin(self._remote.revision)
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
        while time.monotonic() < deadline:
            if self.needs_topics(wanted) or self._by_topics_alone:
                frame = self._captured_by_topics(wanted, deadline)
            else:
                frame = self._captured_directly(wanted, deadline)
            if frame is not None:
                return frame
            self.recaptured += 1
        raise DeadlineExceeded(f"the images of a frame of agent {self._spec.name!r}", timeout_s)

    def newer(self, sequence: int, timeout_s: float) -> Frame:
        """Wait for the newest streamed frame with a number above the given one."""
        deadline = time.monotonic() + timeout_s
        left_s = timeout_s
        # Captured frames come by the topics too where others subscribe to them.
        after = max(sequence, self._last_captured)
        while True:
            bundle = self._topics.take_newer(after, self._spec.views, left_s)
            frame = self._frame_of_bundle(bundle, deadline)
            if frame is not None:
                return frame
            left_s = max(0.0, deadline - time.monotonic())

    def close(self) -> None:
        """End the subscriptions, and the socket of direct frames."""
        self._disconnect()
        self._topics.close()

    # -- one of several that are captured together ---------------------------------------------

    def needs_topics(self, views: tuple[str, ...]) -> bool:
        """Subscribe to these views; say if a frame has to come by topics now.

        Of each topic the first comes by it: then the simulator knows who reads it.
        """
        return self._topics.add_views(views) or not self._matched

    def wanted(self, views: tuple[str, ...]) -> WantedFrame:
        """Return a frame of this agent as it is asked for directly."""
        return WantedFrame(
            agent=self._spec.name,
            views=views,
            subscribed=self._topics.subscribed,
            intrinsics=self._intrinsics(self._remote.info),
        )

    def await_topics(self, deadline: float) -> None:
        """Wait for the publishers of all topics, and forget what came so far."""
        self._topics.await_publishers(_left_s(deadline))
        self._topics.clear()

    def sent(self, sequence: int, views: tuple[str, ...], deadline: float) -> Frame | None:
        """Return a captured frame that comes by topics; None if a part of it was lost."""
        bundle = self._topics.take(sequence, _left_s(deadline), QUIET_S)
        if bundle is None or set(bundle.images) != set(views):
            return None
        frame = self._frame_of_bundle(bundle, deadline)
        self._matched = self._matched or frame is not None
        return frame

    def handed_over(
        self, info: FrameInfo, arrays: Mapping[str, NDArray[Any]], deadline: float
    ) -> Frame | None:
        """Return a frame that came directly; None if the scene of its instant was lost."""
        self._last_captured = info.sequence
        return self._frame_of(info, arrays, deadline)

    # -- through shared memory ---------------------------------------------------------------

    def _captured_directly(self, views: tuple[str, ...], deadline: float) -> Frame | None:
        """Have a frame rendered and handed over; return None if a part of it was lost."""
        if self._direct is None:
            self._direct = DirectFrames.open(self._remote.connection)
        if self._direct is None:
            self._by_topics_alone = True
            return self._captured_by_topics(views, deadline)
        try:
            captured = self._direct.capture(
                self._spec.name, views, [self.wanted(views)], _left_s(deadline)
            )
        except Disconnected as problem:
            _log.info("frames come by topics from now on: %s", problem)
            self._disconnect()
            self._by_topics_alone = True
            return self._captured_by_topics(views, deadline)
        except DeadlineExceeded:
            self._disconnect()  # its late answer must not be taken for that of the next request
            raise
        if captured is None:
            return None
        ((info, arrays),) = captured
        return self.handed_over(info, arrays, deadline)

    def _disconnect(self) -> None:
        if self._direct is not None:
            self._direct.close()
            self._direct = None

    # -- by topics ---------------------------------------------------------------------------

    def _captured_by_topics(self, views: tuple[str, ...], deadline: float) -> Frame | None:
        """Have a frame rendered and sent; return None if a part of it was lost."""
        self.await_topics(deadline)
        request = Capture.Request(views=list(views))
        service = f"{self._spec.name}/capture"
        response = self._remote.connection.call(
            Capture, service, request, _left_s(deadline), RESEND_S
        )
        if not response.success:
            raise error_from_response(response)
        return self.sent(response.sequence, views, deadline)

    def _frame_of_bundle(self, bundle: Bundle, deadline: float) -> Frame | None:
        # The arrays lie on the messages' bytes; nobody else has them.
        views = {view: view_from_image(view, image) for view, image in bundle.images.items()}
        return self._frame_of(bundle.info, views, deadline)

    # -- both --------------------------------------------------------------------------------

    def _frame_of(
        self, info: FrameInfo, views: Mapping[str, NDArray[Any]], deadline: float
    ) -> Frame | None:
        """Make a frame with the scene of its own instant; None if that was lost on the way."""
        scene = self._remote.connection.await_revision(info.revision, _left_s(deadline))
        if scene is None:
            return None
        draw = partial(self._amodal_masks, info.sequence)
        return frame_of_info(info, views, self._intrinsics(scene), scene, draw)

    def _amodal_masks(self, sequence: int, only: int = 0) -> AmodalMasks:
        """Have the objects of a frame drawn alone, which must be the agent's last."""
        operation = Operations.get_amodal_masks
        arguments = operation.signature.bind(sequence=sequence, agent=self._spec.name)
        masks = self._remote.call(SERVICES[operation.name], arguments, operation.deadline_s)
        assert isinstance(masks, AmodalMasks)
        return masks

    def _intrinsics(self, scene: SceneInfo) -> CameraIntrinsics:
        specs = {spec.name: spec for spec in scene.agents}
        return specs.get(self._spec.name, self._spec).intrinsics


def _left_s(deadline: float) -> float:
    return max(0.0, deadline - time.monotonic())
