"""`Frame` → the topics of one agent; renders nothing that nobody subscribes to.

One thread takes the frames that fall due and publishes them; captured frames are published by
the thread that captured them. Holds no simulation logic.
"""

from __future__ import annotations

import logging
import threading
import time
from copy import copy
from dataclasses import replace

from geometry_msgs.msg import PoseStamped
from rclpy.node import Node
from rclpy.publisher import Publisher
from sensor_msgs.msg import CameraInfo, Image

from sailenv_msgs.msg import FrameInfo
from sailenv_msgs_py.camera_info import camera_info_of_frame
from sailenv_msgs_py.frame_info import WORLD_FRAME_ID, frame_info_to_msg, header_of_frame
from sailenv_msgs_py.images import image_from_view
from sailenv_msgs_py.stamps import stamp_from_ns
from sailenv_msgs_py.transforms import pose_stamped_to_msg
from sailenv_ros.errors import DeadlineExceeded, SailenvError, SimulationClosed
from sailenv_ros.frame.frame import Frame
from sailenv_ros.ros.nodes.derived_topics import DerivedTopics
from sailenv_ros.ros.nodes.diagnostics import AgentCounts, FrameCounter
from sailenv_ros.ros.nodes.disparity_topics import DisparityTopics
from sailenv_ros.ros.nodes.forward_motion_topics import ForwardMotionTopics
from sailenv_ros.ros.nodes.object_topics import ObjectTopics
from sailenv_ros.ros.nodes.qos import await_arrival, frame_qos, no_events, overriding
from sailenv_ros.ros.nodes.tf_tree import TfTree
from sailenv_ros.simulation import FrameStream, Simulation
from sailenv_ros.types.agents import AgentPose, AgentSpec
from sailenv_ros.types.views import ALWAYS_MADE

__all__ = ["AgentPublisher"]

_log = logging.getLogger(__name__)

LOOK_INTERVAL_S = 0.05
"""Interval at which subscriptions are checked while nothing is rendered [s]."""

ARRIVAL_S = 1.0
"""Time that the last frame is given to reach all its subscribers, before its topics go [s]."""


class AgentPublisher:
    """Publishes one agent's frames, infos and pose.

    Parameters
    ----------
    node : Node
    simulation : Simulation
    spec : AgentSpec
        As registered.
    tf : TfTree
        Told where the agent is, as the topic `pose` is.
    disparity : DisparityTopics
        Told each frame, as it may be one of a stereo pair's.

    Raises
    ------
    SailenvError
        If the agent is gone already; no topic is left then.
    """

    def __init__(
        self,
        node: Node,
        simulation: Simulation,
        spec: AgentSpec,
        tf: TfTree,
        disparity: DisparityTopics,
    ) -> None:
        self._disparity = disparity
        self._tf = tf
        self._node = node
        self._simulation = simulation
        self._spec = spec
        # First, as it is refused for an agent that is gone, whose topics nobody would remove.
        self._stream = simulation.stream(spec.name, ()) if spec.rate_hz else None
        # A topic that never carries anything would have its subscribers wait for ever.
        views = simulation.supported_views
        self._images = {view: self._publisher(Image, view) for view in views}
        self._camera_info = self._publisher(CameraInfo, "camera_info")
        self._frame_info = self._publisher(FrameInfo, "frame_info")
        self._pose = self._publisher(PoseStamped, "pose")
        self._derived = DerivedTopics(
            self._publisher,
            views,
            depth_range_m=spec.depth_range_m,
            categories=lambda: simulation.info.categories,
        )
        self._late = ForwardMotionTopics(self._publisher)
        self._objects = ObjectTopics(self._publisher)
        self._counter = FrameCounter()
        self._publishing = threading.Lock()
        self._closing = threading.Event()
        self._last_sequence = 0
        self._last_pose: AgentPose | None = None
        self._thread: threading.Thread | None = None
        self.overtaken = 0
        if self._stream is not None:
            self._begin_thread(self._stream)

    def set_rate(self, rate_hz: float) -> None:
        """Take note of a changed rate; 0 ends the stream."""
        self._spec = replace(self._spec, rate_hz=rate_hz)
        if rate_hz and self._stream is None:
            self._stream = self._simulation.stream(self._spec.name, ())
            self._begin_thread(self._stream)

    def counts(self) -> AgentCounts:
        """Return what was published since this was asked before."""
        dropped = self.overtaken + (0 if self._stream is None else self._stream.dropped)
        return self._counter.take(self._spec.name, dropped)

    @property
    def ended(self) -> bool:
        """True once the agent is gone, or this was closed."""
        return self._closing.is_set() or (self._stream is not None and self._stream.closed)

    def subscribed(self, views: tuple[str, ...]) -> bool:
        """Return whether somebody subscribes to every one of these views."""
        topics = [self._images.get(view) for view in views]
        return all(topic is not None and _is_subscribed(topic) for topic in topics)

    def await_subscribed(self, views: tuple[str, ...], timeout_s: float) -> bool:
        """Wait a little for subscribers that are just being matched; say whether all are there."""
        waited_s, interval_s = 0.0, 0.002
        while not self.subscribed(views):
            if waited_s >= timeout_s or self._closing.wait(interval_s):
                return False
            waited_s += interval_s
        return True

    def publish(self, frame: Frame, *, beside: frozenset[str] = frozenset()) -> tuple[str, ...]:
        """Publish a frame on those topics of it that somebody subscribes to.

        Parameters
        ----------
        frame : Frame
        beside : frozenset of str
            Topics with one subscriber that needs no message, as it gets the frame otherwise.

        Returns
        -------
        views : tuple of str
            The views that went out.

        Raises
        ------
        SimulationClosed
            If the agent is gone.
        """
        with self._publishing:
            if self._closing.is_set():
                raise SimulationClosed(f"agent {self._spec.name!r} was deleted")
            self._last_sequence = max(self._last_sequence, frame.sequence)
            return self._publish(frame, beside)

    def close(self) -> None:
        """End the stream and remove the topics; a second call does nothing."""
        if self._closing.is_set():
            return
        self._closing.set()
        if self._stream is not None:
            self._stream.close()
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.join(1.0)
        with self._publishing:
            infos = (self._camera_info, self._frame_info, self._pose)
            publishers = (
                *self._images.values(),
                *infos,
                *self._derived.publishers,
                *self._late.publishers,
                *self._objects.publishers,
            )
            # A reader that hears that a writer is gone drops what it has not looked at yet.
            await_arrival(publishers, ARRIVAL_S)
            for publisher in publishers:
                self._node.destroy_publisher(publisher)

    # -- the thread ------------------------------------------------------------------------

    def _begin_thread(self, stream: FrameStream) -> None:
        self._thread = threading.Thread(
            target=self._follow, args=(stream,), name=f"{self._spec.name}-frames", daemon=True
        )
        self._thread.start()

    def _follow(self, stream: FrameStream) -> None:
        while not self._closing.is_set():
            rate_hz = self._spec.rate_hz
            try:
                stream.set_views(self._wanted_views() if rate_hz else ())
                frame = stream.get(min(LOOK_INTERVAL_S, 1.0 / rate_hz if rate_hz else 1.0))
            except DeadlineExceeded:
                self._pose_alone()
            except SimulationClosed:
                return
            else:
                self._publish_streamed(frame)

    def _wanted_views(self) -> tuple[str, ...]:
        shown = self._derived.wanted_views() | self._late.wanted_views()
        shown |= self._objects.wanted_views() | self._disparity.wanted_views(self._spec.name)
        wanted = tuple(
            view for view, topic in self._images.items() if view in shown or _is_subscribed(topic)
        )
        infos = _is_subscribed(self._camera_info) or _is_subscribed(self._frame_info)
        return wanted or (ALWAYS_MADE if infos else ())

    def _publish_streamed(self, frame: Frame) -> None:
        with self._publishing:
            if self._closing.is_set():
                return
            if frame.sequence <= self._last_sequence:
                # A frame captured on request has overtaken it: stamps never go back on a topic.
                self.overtaken += 1
                return
            self._last_sequence = frame.sequence
            self._publish(frame)

    def _pose_alone(self) -> None:
        """Publish where the agent is while no frames are made."""
        wanted = self._tf.wanted or _is_subscribed(self._pose)
        if self._stream is None or self._stream.views or not wanted:
            return
        try:
            pose = self._simulation.get_agent_pose(agent=self._spec.name)
        except SailenvError:
            return  # the agent or the simulation is gone, which the stream says next
        with self._publishing:
            if pose != self._last_pose and not self._closing.is_set():
                self._last_pose = pose
                stamp = stamp_from_ns(pose.sim_time_ns)
                self._pose.publish(pose_stamped_to_msg(pose.pose, stamp, WORLD_FRAME_ID))
                self._tf.publish(self._spec.name, pose.pose, stamp)

    # -- messages --------------------------------------------------------------------------

    def _publish(self, frame: Frame, beside: frozenset[str] = frozenset()) -> tuple[str, ...]:
        began = time.perf_counter()
        header = header_of_frame(frame)
        sent = []
        for view, topic in self._images.items():
            if view in frame.views and _is_subscribed(topic, beside=view in beside):
                topic.publish(image_from_view(view, frame[view], header, copy=False))
                sent.append(view)
        if _is_subscribed(self._camera_info):
            self._camera_info.publish(camera_info_of_frame(frame, copy(header)))
        if _is_subscribed(self._frame_info, beside="frame_info" in beside):
            self._frame_info.publish(
                frame_info_to_msg(frame, header, views=sent, depth_range_m=self._spec.depth_range_m)
            )
        if _is_subscribed(self._pose):
            pose = frame.camera.pose
            self._pose.publish(pose_stamped_to_msg(pose, header.stamp, WORLD_FRAME_ID))
        self._tf.publish(self._spec.name, frame.camera.pose, header.stamp)
        self._tf.publish_instances(frame, header.stamp)
        # Last, as they take time and nobody waits for them.
        self._derived.publish(frame, header)
        self._late.publish(frame)
        self._objects.publish(frame, header)
        self._disparity.publish(frame)
        self._counter.add(frame, time.perf_counter() - began)
        return tuple(sent)

    def _publisher(self, kind: type, topic: str) -> Publisher:
        name = f"{self._spec.name}/{topic}"
        return self._node.create_publisher(
            kind,
            name,
            frame_qos(),
            event_callbacks=no_events(),
            qos_overriding_options=overriding(self._node, name),
        )


def _is_subscribed(topic: Publisher, *, beside: bool = False) -> bool:
    """Return whether there is a subscriber; with `beside` whether there is another one."""
    return bool(topic.get_subscription_count() > beside)
