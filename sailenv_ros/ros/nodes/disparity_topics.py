"""`<agent>/disparity` of a rectified rig.

Frames of both cameras in, `stereo_msgs/DisparityImage` out, made only while somebody subscribes.
"""

from __future__ import annotations

import threading
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from rclpy.node import Node
from rclpy.publisher import Publisher
from sensor_msgs.msg import RegionOfInterest
from std_msgs.msg import Header
from stereo_msgs.msg import DisparityImage

from sailenv_msgs_py.frame_info import header_of_frame
from sailenv_msgs_py.images import image_from_view
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.stereo import Disparity, disparity
from sailenv_ros.ros.nodes.qos import frame_qos, no_events
from sailenv_ros.types.agents import AgentSpec, stereo_baseline_m

__all__ = ["DisparityTopics", "disparity_fields", "stereo_pairs"]

NEEDED = frozenset(("depth", "instance"))

NOT_SEEN = -1.0
"""Disparity of pixels that the right camera does not see [px]: below the least, as of matchers."""


@dataclass(slots=True)
class _Pair:
    left: str
    right: str
    publisher: Publisher
    newest: dict[str, Frame] = field(default_factory=dict)


class DisparityTopics:
    """Publishes the disparity of all rigs; thread-safe.

    Parameters
    ----------
    node : Node
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._lock = threading.Lock()
        self._pairs: dict[str, _Pair] = {}

    def set_agents(self, agents: Iterable[AgentSpec]) -> None:
        """Make the topics that are missing, and remove those of rigs that are gone."""
        wanted = stereo_pairs(agents)
        with self._lock:
            for body, pair in list(self._pairs.items()):
                if wanted.get(body) != (pair.left, pair.right):
                    self._node.destroy_publisher(self._pairs.pop(body).publisher)
            for body, (left, right) in wanted.items():
                if body not in self._pairs:
                    publisher = self._node.create_publisher(
                        DisparityImage,
                        f"{body}/disparity",
                        frame_qos(),
                        event_callbacks=no_events(),
                    )
                    self._pairs[body] = _Pair(left, right, publisher)

    def wanted_views(self, agent: str) -> frozenset[str]:
        """Return the views that a camera's frames need for it; none while nobody subscribes."""
        with self._lock:
            return NEEDED if self._subscribed(agent) else frozenset()

    def publish(self, frame: Frame) -> None:
        """Take a camera's frame; publish the disparity if the other one's is of its instant."""
        if not frame.views.keys() >= NEEDED:
            return
        with self._lock:
            for pair in self._subscribed(frame.agent):
                pair.newest[frame.agent] = frame
                left, right = (pair.newest.get(name) for name in (pair.left, pair.right))
                if left is None or right is None:
                    continue
                if (left.epoch, left.stamp_ns) == (right.epoch, right.stamp_ns):
                    pair.newest.clear()
                    with suppress(InvalidRequest):  # a camera was changed a moment ago
                        found = disparity(left, right)
                        fields = disparity_fields(found, header_of_frame(left))
                        pair.publisher.publish(DisparityImage(**fields))

    def _subscribed(self, agent: str) -> list[_Pair]:
        return [
            pair
            for pair in self._pairs.values()
            if agent in (pair.left, pair.right) and pair.publisher.get_subscription_count()
        ]


def stereo_pairs(agents: Iterable[AgentSpec]) -> dict[str, tuple[str, str]]:
    """Return the left and the right camera of each rig's pair, by the rig's name.

    The left one is the rig's first camera, the right one the first that is straight to its right.
    """
    specs = tuple(agents)
    first: dict[str, AgentSpec] = {}
    pairs: dict[str, tuple[str, str]] = {}
    for spec in specs:
        left = first.setdefault(spec.body, spec)
        alike = spec.intrinsics == left.intrinsics and spec.intrinsics.is_pinhole
        if spec.body and spec.body not in pairs and alike and stereo_baseline_m(spec, specs) > 0.0:
            pairs[spec.body] = (left.name, spec.name)
    return pairs


def disparity_fields(found: Disparity, header: Header) -> dict[str, Any]:
    """Return the fields of a `stereo_msgs/DisparityImage`.

    Pixels that the right camera does not see are `NOT_SEEN`.
    """
    values = np.where(found.visible, found.disparity, np.float32(NOT_SEEN)).astype(np.float32)
    height, width = values.shape
    most = float(values.max(initial=0.0))
    return {
        "header": header,
        "image": image_from_view("depth", values, header),
        "f": found.focal_px,
        "t": found.baseline_m,
        "valid_window": RegionOfInterest(height=height, width=width),
        "min_disparity": 0.0,
        "max_disparity": most,
        "delta_d": float(np.spacing(np.float32(most))),
    }
