"""Topics of what is known of a frame's objects, and its point cloud.

`Frame` → `objects`, `objects/amodal`, `points`, `detections_2d`, `detections_3d` and `skeletons`;
each made only while somebody subscribes. Knows no simulation.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from rclpy.publisher import Publisher
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import Header
from vision_msgs.msg import Detection2DArray, Detection3DArray
from visualization_msgs.msg import MarkerArray

from sailenv_msgs.msg import Objects
from sailenv_msgs_py.object_truth_msgs import objects_to_msg
from sailenv_msgs_py.point_clouds import point_cloud_to_msg
from sailenv_msgs_py.skeleton_markers import skeleton_markers_to_msg
from sailenv_msgs_py.vision_detections import detections_2d_to_msg, detections_3d_to_msg
from sailenv_ros.errors import SailenvError, SimulationClosed
from sailenv_ros.frame.frame import Frame

__all__ = ["ObjectTopics"]

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class _Topic:
    publisher: Publisher
    views: tuple[str, ...]
    make: Callable[[Frame, Header], Any]


class ObjectTopics:
    """Publishes what is known of objects, and points.

    Parameters
    ----------
    make_publisher : callable
        ``make_publisher(kind, topic)`` makes a publisher below the agent's name.
    """

    def __init__(self, make_publisher: Callable[[type, str], Publisher]) -> None:
        self._topics = [
            _Topic(make_publisher(Objects, "objects"), ("depth", "instance"), objects_to_msg),
            _Topic(
                make_publisher(Objects, "objects/amodal"),
                ("depth", "instance"),
                lambda frame, header: objects_to_msg(frame, header, frame.amodal),
            ),
            _Topic(
                make_publisher(PointCloud2, "points"),
                ("rgb", "depth", "category", "instance"),
                point_cloud_to_msg,
            ),
            _Topic(
                make_publisher(Detection2DArray, "detections_2d"),
                ("instance",),
                detections_2d_to_msg,
            ),
            _Topic(
                make_publisher(Detection3DArray, "detections_3d"),
                ("instance",),
                detections_3d_to_msg,
            ),
            _Topic(
                make_publisher(MarkerArray, "skeletons"),
                ("depth", "instance"),
                skeleton_markers_to_msg,
            ),
        ]

    @property
    def publishers(self) -> tuple[Publisher, ...]:
        """All of them, to be ended together."""
        return tuple(topic.publisher for topic in self._topics)

    def wanted_views(self) -> frozenset[str]:
        """Return the views that the topics that somebody subscribes to are made of."""
        return frozenset(
            view
            for topic in self._topics
            if topic.publisher.get_subscription_count()
            for view in topic.views
        )

    def publish(self, frame: Frame, header: Header) -> None:
        """Publish what is subscribed to, of a frame that has the views that it is made of."""
        for topic in self._topics:
            if not topic.publisher.get_subscription_count():
                continue
            if not set(topic.views) <= frame.views.keys():
                continue  # somebody captured other views
            try:
                topic.publisher.publish(topic.make(frame, header))
            except SimulationClosed:
                return
            except SailenvError as problem:
                _log.warning("%s is not published: %s", topic.publisher.topic_name, problem)
