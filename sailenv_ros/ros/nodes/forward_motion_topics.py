"""Topics of views that are known once the next frame is: `flow_forward` and `scene_flow`.

Frames in their order in; images out one frame late, with the stamp of the frame that they are of.
Nothing is computed that nobody subscribes to.
"""

from __future__ import annotations

from collections.abc import Callable

from rclpy.publisher import Publisher
from sensor_msgs.msg import Image

from sailenv_msgs_py.frame_info import header_of_frame
from sailenv_msgs_py.images import image_from_view
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.motion import FORWARD_VIEWS, forward_views

__all__ = ["ForwardMotionTopics"]

_NEEDED = ("depth", "instance")


class ForwardMotionTopics:
    """Publishes the motion from each of an agent's frames to its next one.

    Parameters
    ----------
    make_publisher : callable
        ``make_publisher(kind, topic)`` makes a publisher below the agent's name.
    """

    def __init__(self, make_publisher: Callable[[type, str], Publisher]) -> None:
        self._topics = {view: make_publisher(Image, view) for view in FORWARD_VIEWS}
        self._last: Frame | None = None

    @property
    def publishers(self) -> tuple[Publisher, ...]:
        """All of them, to be ended together."""
        return tuple(self._topics.values())

    def wanted_views(self) -> frozenset[str]:
        """Return the views that frames must have for what is subscribed to."""
        return frozenset(_NEEDED if self._subscribed() else ())

    def publish(self, frame: Frame) -> None:
        """Take the next frame, and publish the motion to it from the one before."""
        views = self._subscribed()
        if not views or not {*_NEEDED} <= frame.views.keys():
            self._last = None
            return
        last, self._last = self._last, frame
        if last is None or (last.scene, last.epoch) != (frame.scene, frame.epoch):
            return
        if last.stamp_ns >= frame.stamp_ns:
            # Frames of one instant: what comes next is not known yet.
            return
        header = header_of_frame(last)
        for view, values in forward_views(last, frame, views).items():
            self._topics[view].publish(image_from_view(view, values, header, copy=False))

    def _subscribed(self) -> list[str]:
        return [view for view, topic in self._topics.items() if topic.get_subscription_count()]
