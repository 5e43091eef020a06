"""The topics of one agent as its client reads them: whole frames, by number.

Messages arrive in the connection's thread and are matched there; the Agent takes the frame that
it asked for. Subscribes before the agent exists, so that its publishers find their readers at once.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.qos import QoSProfile
from sensor_msgs.msg import Image

from sailenv_msgs.msg import FrameInfo
from sailenv_msgs_py.stamps import ns_from_stamp
from sailenv_ros.errors import DeadlineExceeded, SimulatorLost
from sailenv_ros.ros.client.connection import Connection
from sailenv_ros.ros.client.frame_sync import Bundle, FrameSync

__all__ = ["AgentTopics"]

_QOS = QoSProfile(depth=3)


class AgentTopics:
    """Subscriptions to an agent's frame_info and to those views of it that are wanted.

    Parameters
    ----------
    connection : Connection
    agent : str
        Its name; it need not exist yet.
    views : tuple of str
    """

    def __init__(self, connection: Connection, agent: str, views: tuple[str, ...]) -> None:
        self._connection = connection
        self._agent = agent
        self._sync = FrameSync()
        self._changed = threading.Condition()
        self._newest: Bundle | None = None
        self._last_arrival_s = 0.0
        self._first_revision: int | None = None
        self._subscriptions: dict[str, Any] = {}
        # rclpy's groups refer to all that they ever had, and the node's own one stays.
        self._group = MutuallyExclusiveCallbackGroup()
        self._subscribe("frame_info", FrameInfo, self._take_info)
        self.add_views(views)

    @property
    def incomplete(self) -> int:
        """Number of frames given up because one of their images never arrived."""
        return self._sync.incomplete

    @property
    def subscribed(self) -> tuple[str, ...]:
        """Names of the topics that are read."""
        return tuple(self._subscriptions)

    def add_views(self, views: tuple[str, ...]) -> bool:
        """Subscribe to more views; say whether there were any."""
        more = [view for view in views if view not in self._subscriptions]
        for view in more:
            self._subscribe(view, Image, self._taker(view))
        return bool(more)

    def begin(self, revision: int) -> None:
        """Take what was sent at that revision of the scene or later.

        It has the agent; what came before is of one that had its name.
        """
        with self._changed:
            self._first_revision = revision
        self.clear()

    def await_publishers(self, timeout_s: float) -> None:
        """Wait until every topic has a publisher."""
        topics = self._subscriptions.values()
        self._connection.wait_until(
            lambda: all(topic.get_publisher_count() for topic in topics),
            f"the topics of agent {self._agent!r}",
            timeout_s,
        )

    def clear(self) -> None:
        """Forget what came so far."""
        with self._changed:
            self._sync.clear()
            self._newest = None

    def take(self, sequence: int, timeout_s: float, quiet_s: float) -> Bundle | None:
        """Wait for the frame of that number.

        Parameters
        ----------
        sequence : int
        timeout_s : float
            Deadline [s].
        quiet_s : float
            None is given if nothing at all arrives for so long [s]: what is missing was lost.

        Raises
        ------
        SimulatorLost, DeadlineExceeded
            If it did not come.
        """
        taken: list[Bundle | None] = []
        self._last_arrival_s = time.monotonic()

        def met(interval_s: float) -> bool:
            with self._changed:
                if self._newest is None or self._newest.sequence != sequence:
                    self._changed.wait(min(interval_s, quiet_s))
                if self._newest is not None and self._newest.sequence == sequence:
                    taken.append(self._newest)
                    self._newest = None
                elif time.monotonic() - self._last_arrival_s >= quiet_s:
                    taken.append(None)
            return bool(taken)

        self._connection.wait_for(met, f"frame {sequence} of agent {self._agent!r}", timeout_s)
        return taken[0]

    def take_newer(self, sequence: int, views: tuple[str, ...], timeout_s: float) -> Bundle:
        """Wait for the newest frame with all of these views and a number above the given one.

        Raises
        ------
        SimulatorLost, DeadlineExceeded
            If none came.
        """
        taken: list[Bundle] = []

        def met(interval_s: float) -> bool:
            with self._changed:
                if not self._has_newer(sequence, views):
                    self._changed.wait(interval_s)
                if self._newest is not None and self._has_newer(sequence, views):
                    taken.append(self._newest)
                    self._newest = None
            return bool(taken)

        what = f"a frame of agent {self._agent!r}"
        try:
            self._connection.wait_for(met, what, timeout_s)
        except SimulatorLost:
            raise
        except DeadlineExceeded:
            info = self._connection.info
            if info.mode != "lockstep" and not info.paused:
                raise
            why = "none is made while simulated time stands still"
            raise DeadlineExceeded(f"{what} ({why})", timeout_s) from None
        return taken[0]

    def _has_newer(self, sequence: int, views: tuple[str, ...]) -> bool:
        newest = self._newest
        return (
            newest is not None and newest.sequence > sequence and newest.images.keys() >= {*views}
        )

    def close(self) -> None:
        """End the subscriptions."""
        for subscription in self._subscriptions.values():
            self._connection.node.destroy_subscription(subscription)
        self._subscriptions.clear()

    def _subscribe(self, topic: str, kind: type, callback: Any) -> None:
        self._subscriptions[topic] = self._connection.node.create_subscription(
            kind, f"{self._agent}/{topic}", callback, _QOS, callback_group=self._group
        )

    def _taker(self, view: str) -> Callable[[Image, Any], None]:
        def take(msg: Image, about: Any) -> None:
            stamp_ns = ns_from_stamp(msg.header.stamp)
            with self._changed:
                self._deliver(self._sync.add_image(view, stamp_ns, about["source_timestamp"], msg))

        return take

    def _take_info(self, msg: FrameInfo, about: Any) -> None:
        stamp_ns = ns_from_stamp(msg.header.stamp)
        views = tuple(msg.views)
        with self._changed:
            if self._first_revision is None or msg.revision < self._first_revision:
                return
            sent_ns = about["source_timestamp"]
            self._deliver(self._sync.add_info(msg.sequence, stamp_ns, views, sent_ns, msg))

    def _deliver(self, bundle: Bundle | None) -> None:
        self._last_arrival_s = time.monotonic()
        if bundle is not None:
            self._newest = bundle
            self._changed.notify_all()
