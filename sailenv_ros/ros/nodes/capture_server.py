"""Captured frames for Agents of this machine, through shared memory instead of topics.

An Agent hands over a segment of memory and asks for views; it gets the frame_info, or the refusal
that the service gives, and finds the arrays in its memory. Other subscribers of the agent's
topics get the frame there, as from the service. One thread for each Agent.
"""

from __future__ import annotations

import contextlib
import logging
import mmap
import os
import socket
import threading
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from rclpy.serialization import serialize_message

from sailenv_msgs.srv import Capture
from sailenv_msgs_py.error_codes import error_to_response
from sailenv_msgs_py.frame_info import frame_info_to_msg, header_of_frame
from sailenv_ros.errors import InternalFault, InvalidRequest, SailenvError
from sailenv_ros.frame.frame import Frame
from sailenv_ros.ros.nodes.publishers import AgentPublisher
from sailenv_ros.simulation import Simulation
from sailenv_ros.system.frame_memory import SEGMENTS, map_segment, padded, view_of
from sailenv_ros.system.frame_socket import is_wanted, listen, peer_is_same_user, receive, send

__all__ = ["CaptureServer"]

_log = logging.getLogger(__name__)


class CaptureServer:
    """Serves the Agents of this machine and user.

    Parameters
    ----------
    simulation : Simulation
    domain_id : int
    namespace : str
    publisher_of : callable
        Returns the publisher of an agent; None if it has none yet.
    """

    def __init__(
        self,
        simulation: Simulation,
        domain_id: int,
        namespace: str,
        publisher_of: Callable[[str], AgentPublisher | None],
    ) -> None:
        self._simulation = simulation
        self._publisher_of = publisher_of
        self._sockets: set[socket.socket] = set()
        self._closed = False
        self._listener: socket.socket | None = None
        if not is_wanted():
            return
        try:
            self._listener, self._path = listen(domain_id, namespace)
        except (OSError, InvalidRequest) as problem:
            _log.info("Agents of this machine get frames by topics alone: %s", problem)
            return
        threading.Thread(target=self._accept, name="frames-listener", daemon=True).start()

    def close(self) -> None:
        """Close all connections; a second call does nothing."""
        if self._closed or self._listener is None:
            return
        self._closed = True
        with contextlib.suppress(OSError):
            self._path.unlink()
        for sock in (self._listener, *self._sockets):
            with contextlib.suppress(OSError):
                sock.shutdown(socket.SHUT_RDWR)  # wakes the thread that waits there
        self._listener.close()

    def _accept(self) -> None:
        assert self._listener is not None
        while not self._closed:
            try:
                sock, _ = self._listener.accept()
            except OSError:
                return
            if not peer_is_same_user(sock):
                sock.close()
                continue
            self._sockets.add(sock)
            threading.Thread(
                target=self._serve, args=(sock,), name="direct-frames", daemon=True
            ).start()

    def _serve(self, sock: socket.socket) -> None:
        segments: dict[int, mmap.mmap] = {}
        try:
            while not self._closed and self._answer(sock, segments):
                pass
        except (OSError, SailenvError, KeyError, TypeError, ValueError) as problem:
            if not self._closed:
                _log.info("an Agent's socket for frames was closed: %r", problem)
        finally:
            self._sockets.discard(sock)
            sock.close()

    def _answer(self, sock: socket.socket, segments: dict[int, mmap.mmap]) -> bool:
        """Answer one request; False at the end of the connection."""
        received = receive(sock)
        if received is None:
            return False
        request, _, descriptors = received
        try:
            number = int(request["segment"])
            if descriptors:
                if not 0 <= number < SEGMENTS:
                    raise InvalidRequest("segment", number, f"0 to {SEGMENTS - 1}")
                segments[number] = map_segment(descriptors[0])
        finally:
            for fd in descriptors:
                os.close(fd)
        header, parts = self._captured(request, segments[number])
        send(sock, header, parts)
        return True

    def _captured(
        self, request: Mapping[str, Any], memory: mmap.mmap
    ) -> tuple[dict[str, Any], list[bytes]]:
        """Have frames rendered, written and published; return what is answered."""
        try:
            agent, views = str(request["agent"]), [*map(str, request["views"])]
            subscribed = {str(name): topics for name, topics in request["subscribed"].items()}
            if request.get("rig"):
                frames = [*self._simulation.capture_rig(views or None, agent=agent).values()]
            else:
                frames = [self._simulation.capture(views, agent=agent)]
            for frame in frames:
                publisher = self._publisher_of(frame.agent)
                if publisher is not None:
                    beside = frozenset(map(str, subscribed.get(frame.agent, ())))
                    publisher.publish(frame, beside=beside)
        except SailenvError as error:
            return _refused(error)
        except Exception as error:
            _log.exception("a frame could not be made because of an internal error")
            return _refused(InternalFault.of(error))
        infos = [
            frame_info_to_msg(
                frame, header_of_frame(frame), views=frame.views, depth_range_m=frame.depth_range_m
            )
            for frame in frames
        ]
        return {"frames": _written(frames, memory)}, [serialize_message(info) for info in infos]


def _refused(error: SailenvError) -> tuple[dict[str, Any], list[bytes]]:
    response = Capture.Response()
    error_to_response(error, response)
    return {"refused": True}, [serialize_message(response)]


def _written(frames: Sequence[Frame], memory: mmap.mmap) -> list[dict[str, Any]] | None:
    """Write frames into a segment and say where each array begins [B]; None if they do not fit."""
    arrays = [values for frame in frames for values in frame.views.values()]
    if sum(padded(values.nbytes) for values in arrays) > len(memory):
        return None
    whole = np.frombuffer(memory, np.uint8)
    written, begin = [], 0
    for frame in frames:
        lens, places = frame.camera.intrinsics, {}
        for view, values in frame.views.items():
            np.copyto(view_of(whole, begin, values.dtype, values.shape), values)
            places[view] = begin
            begin += padded(values.nbytes)
        types = {view: values.dtype.str for view, values in frame.views.items()}
        size = {"height": lens.height, "width": lens.width}
        written.append({"places": places, "types": types, **size})
    return written
