"""Captured frames of a simulator on this machine, through shared memory instead of topics.

The arrays of a frame lie in a segment of this process that the simulator filled; it is filled
again only when none of them is held any more.
"""

from __future__ import annotations

import math
import select
import socket
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rclpy.serialization import deserialize_message

from sailenv_msgs.msg import FrameInfo
from sailenv_msgs.srv import Capture
from sailenv_msgs_py.error_codes import error_from_response
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.ros.client.connection import Connection
from sailenv_ros.system.frame_memory import Segment, SegmentPool, padded, view_of
from sailenv_ros.system.frame_socket import connect, is_wanted, receive, send
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.views import VIEWS

__all__ = ["DirectFrames", "Disconnected", "WantedFrame"]


class Disconnected(Exception):
    """The simulator ended the connection; frames come by topics from now on."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WantedFrame:
    """One frame that is asked for.

    Attributes
    ----------
    agent : str
        Whose.
    views : tuple of str
    subscribed : tuple of str
        Topics of the agent that this Agent itself reads, and on which it needs no frame now.
    intrinsics : CameraIntrinsics
        That the agent's camera had last, as far as is known.
    """

    agent: str
    views: tuple[str, ...]
    subscribed: tuple[str, ...]
    intrinsics: CameraIntrinsics

    @property
    def size_bytes(self) -> int:
        """Bytes that its arrays take in a segment."""
        height, width = self.intrinsics.height, self.intrinsics.width
        return sum(
            padded(math.prod(VIEWS[view].shape(height, width)) * VIEWS[view].dtypes[-1].itemsize)
            for view in self.views
            if view in VIEWS
        )


class DirectFrames:
    """One Agent's socket to the simulator.

    Parameters
    ----------
    connection : Connection
        Whose waits are used: they fail when the simulator ends.
    sock : socket
        Owned from now on.
    """

    def __init__(self, connection: Connection, sock: socket.socket) -> None:
        self._connection = connection
        self._socket = sock
        self._pool = SegmentPool()
        self._ready = select.poll()
        self._ready.register(sock, select.POLLIN)

    @classmethod
    def open(cls, connection: Connection) -> DirectFrames | None:
        """Connect to the simulator of that connection; None if it is not on this machine."""
        if not is_wanted():
            return None
        sock = connect(connection.domain_id, connection.namespace)
        if sock is None:
            return None
        if not connection.simulator_lives():
            sock.close()  # it was opened by another simulator, which came after the one we know
            return None
        return cls(connection, sock)

    def capture(
        self,
        agent: str,
        views: tuple[str, ...],
        wanted: Sequence[WantedFrame],
        timeout_s: float,
        *,
        rig: bool = False,
    ) -> list[tuple[FrameInfo, dict[str, NDArray[Any]]]] | None:
        """Have one frame rendered now, or with `rig` one of each of a rig's cameras.

        Parameters
        ----------
        agent : str
        views : tuple of str
            Of a rig, none means each camera's own.
        wanted : sequence of WantedFrame
            As far as is known.
        timeout_s : float
            Deadline [s].
        rig : bool

        Returns
        -------
        frames : list of (FrameInfo, dict of str to array)
            The arrays are nobody else's. None if a camera has other intrinsics by now, so that the
            frames did not fit.

        Raises
        ------
        Disconnected
            If the simulator ended the connection.
        SailenvError
            As the operation raised in the simulator.
        SimulatorLost, DeadlineExceeded
            If the simulator has ended, or there was no answer in time.
        """
        try:
            segment = self._pool.take(max(1, sum(one.size_bytes for one in wanted)))
        except OSError as problem:
            raise Disconnected(str(problem)) from None
        if segment is None:
            raise Disconnected("too many frames are held")
        subscribed = {one.agent: one.subscribed for one in wanted}
        try:
            header, parts = self._asked(
                segment,
                {"agent": agent, "views": views, "subscribed": subscribed, "rig": rig},
                f"a frame of agent {agent!r}",
                timeout_s,
            )
        except BaseException:
            # An answer may come yet, and be written into the segment: neither is used again.
            self.close()
            raise
        if "refused" in header or header["frames"] is None:
            self._pool.give_back(segment)
            if "refused" in header:
                raise error_from_response(deserialize_message(parts[0], Capture.Response))
            return None
        whole = self._pool.lend(segment)
        frames = []
        for told, part in zip(header["frames"], parts, strict=True):
            # Of the frame itself: another client may have changed the camera a moment ago.
            height, width = told["height"], told["width"]
            arrays = {
                view: view_of(
                    whole, begin, np.dtype(told["types"][view]), VIEWS[view].shape(height, width)
                )
                for view, begin in told["places"].items()
            }
            if self._pool.is_short:
                # Who keeps many frames keeps them in memory of their own.
                arrays = {view: values.copy() for view, values in arrays.items()}
            frames.append((deserialize_message(part, FrameInfo), arrays))
        return frames

    def close(self) -> None:
        """Disconnect; frames that are held stay as they are."""
        self._socket.close()
        self._pool.close()

    def _asked(
        self, segment: Segment, request: dict[str, Any], what: str, timeout_s: float
    ) -> tuple[dict[str, Any], list[bytes]]:
        answers: list[tuple[dict[str, Any], list[bytes], list[int]] | None] = []

        def met(interval_s: float) -> bool:
            if self._ready.poll(1e3 * interval_s):
                answers.append(receive(self._socket))
            return bool(answers)

        try:
            descriptors = [segment.fd] if segment.fd >= 0 else []
            send(self._socket, {**request, "segment": segment.number}, (), descriptors)
            segment.forget_fd()
            self._connection.wait_for(met, what, timeout_s)
        except (OSError, InvalidRequest) as problem:
            raise Disconnected(str(problem)) from None
        if answers[0] is None:
            raise Disconnected("the simulator ended the connection")
        header, parts, _ = answers[0]
        return header, parts
