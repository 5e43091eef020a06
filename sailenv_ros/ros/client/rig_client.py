"""Fetches the frames of all cameras of a rig, captured at one instant by one request.

As a single agent's, they come through shared memory where the simulator is on this machine and of
this user; else by topics.
"""

from __future__ import annotations

import logging
import time

from sailenv_msgs.srv import CaptureRig
from sailenv_msgs_py.error_codes import error_from_response
from sailenv_ros.errors import DeadlineExceeded
from sailenv_ros.frame.frame import Frame
from sailenv_ros.ros.client.direct_frames import DirectFrames, Disconnected
from sailenv_ros.ros.client.frame_client import RESEND_S, FrameClient
from sailenv_ros.ros.client.remote import RemoteSimulator
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.rigs import camera_of

__all__ = ["RigClient"]

_log = logging.getLogger(__name__)


class RigClient:
    """Frames of the cameras of one rig.

    Parameters
    ----------
    remote : RemoteSimulator
    spec : AgentSpec
        As it is wanted, with its cameras; the agent need not exist yet.

    Attributes
    ----------
    cameras : dict of str to FrameClient
        Frames of a single camera, by the name of its agent.
    """

    def __init__(self, remote: RemoteSimulator, spec: AgentSpec) -> None:
        self._remote = remote
        self._agent = spec.name
        self._specs = {camera.name: camera for camera in spec.camera_specs}
        self.cameras = {name: FrameClient(remote, one) for name, one in self._specs.items()}
        self._direct: DirectFrames | None = None
        self._by_topics_alone = False
        self._recaptured = 0

    @property
    def recaptured(self) -> int:
        """How often frames were asked for again because images did not arrive."""
        return self._recaptured + sum(camera.recaptured for camera in self.cameras.values())

    def begin(self, timeout_s: float) -> None:
        """Wait for the topics of the cameras, which have been registered."""
        deadline = time.monotonic() + timeout_s
        for name, camera in self.cameras.items():
            camera.begin(self._specs[name], _left_s(deadline))

    def capture(self, views: tuple[str, ...] | None, timeout_s: float) -> dict[str, Frame]:
        """Have one frame of each camera rendered now; see `FrameClient.capture` for errors."""
        wanted = {
            name: spec.views if views is None else views for name, spec in self._specs.items()
        }
        deadline = time.monotonic() + timeout_s
        while time.monotonic() < deadline:
            needed = [camera.needs_topics(wanted[name]) for name, camera in self.cameras.items()]
            if any(needed) or self._by_topics_alone:
                frames = self._captured_by_topics(views, wanted, deadline)
            else:
                frames = self._captured_directly(views, wanted, deadline)
            if frames is not None:
                return {camera_of(name): frame for name, frame in frames.items()}
            self._recaptured += 1
        raise DeadlineExceeded(f"the images of a frame of rig {self._agent!r}", timeout_s)

    def close(self) -> None:
        """End the subscriptions, and the socket of direct frames."""
        self._disconnect()
        for camera in self.cameras.values():
            camera.close()

    def _captured_directly(
        self, views: tuple[str, ...] | None, wanted: dict[str, tuple[str, ...]], deadline: float
    ) -> dict[str, Frame] | None:
        """Have frames rendered and handed over; return None if a part of them was lost."""
        if self._direct is None:
            self._direct = DirectFrames.open(self._remote.connection)
        if self._direct is None:
            self._by_topics_alone = True
            return self._captured_by_topics(views, wanted, deadline)
        asked = [camera.wanted(wanted[name]) for name, camera in self.cameras.items()]
        try:
            captured = self._direct.capture(
                self._agent, views or (), asked, _left_s(deadline), rig=True
            )
        except Disconnected as problem:
            _log.info("frames come by topics from now on: %s", problem)
            self._disconnect()
            self._by_topics_alone = True
            return self._captured_by_topics(views, wanted, deadline)
        except DeadlineExceeded:
            self._disconnect()  # its late answer must not be taken for that of the next request
            raise
        frames = {
            info.agent: self.cameras[info.agent].handed_over(info, arrays, deadline)
            for info, arrays in captured or ()
            if info.agent in self.cameras
        }
        return self._whole(frames)

    def _captured_by_topics(
        self, views: tuple[str, ...] | None, wanted: dict[str, tuple[str, ...]], deadline: float
    ) -> dict[str, Frame] | None:
        """Have frames rendered and sent; return None if a part of them was lost."""
        for camera in self.cameras.values():
            camera.await_topics(deadline)
        response = self._remote.connection.call(
            CaptureRig,
            f"{self._agent}/capture_rig",
            CaptureRig.Request(views=list(views or ())),
            _left_s(deadline),
            RESEND_S,
        )
        if not response.success:
            raise error_from_response(response)
        frames = {
            name: self.cameras[name].sent(sequence, wanted[name], deadline)
            for name, sequence in zip(response.cameras, response.sequences, strict=True)
            if name in self.cameras
        }
        return self._whole(frames)

    def _whole(self, frames: dict[str, Frame | None]) -> dict[str, Frame] | None:
        """Return the frames if there is one of each camera that still exists."""
        whole = {name: frame for name, frame in frames.items() if frame is not None}
        return whole if whole and len(whole) == len(frames) else None

    def _disconnect(self) -> None:
        if self._direct is not None:
            self._direct.close()
            self._direct = None


def _left_s(deadline: float) -> float:
    return max(0.0, deadline - time.monotonic())
