"""Companions of an agent's image topics: pictures for RViz and rqt, compressed images.

`Frame` → `<view>/color` (rgb8 pictures of numbers and ids) and `<view>/compressed` (jpeg of the
picture, lossless png of ids), each made only while somebody subscribes. Knows no simulation.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from rclpy.publisher import Publisher
from sensor_msgs.msg import CompressedImage, Image
from std_msgs.msg import Header

from sailenv_msgs_py.images import picture_to_image
from sailenv_ros.frame import VIEWS, Frame
from sailenv_ros.labels import CategoryTable
from sailenv_ros.pictures.colours import view_picture

__all__ = ["COLOUR_VIEWS", "COMPRESSED_VIEWS", "Companions", "compressed_view"]

COLOUR_VIEWS = ("depth", "category", "instance", "flow")

COMPRESSED_VIEWS: Mapping[str, str] = {"rgb": "jpeg", "category": "png", "instance": "png"}
"""Which views are compressed, and how: a picture may lose something, ids may not."""

JPEG_QUALITY = 90


class Companions:
    """Publishes what people look at.

    Parameters
    ----------
    make_publisher : callable
        ``make_publisher(kind, topic)`` makes a publisher below the agent's name.
    depth_range_m : float
        Depth that is shown as black [m].
    categories : callable
        Gives the table of categories as it is now.
    """

    def __init__(
        self,
        make_publisher: Callable[[type, str], Publisher],
        *,
        depth_range_m: float,
        categories: Callable[[], CategoryTable],
    ) -> None:
        self._depth_range_m = depth_range_m
        self._categories = categories
        self._colour = {view: make_publisher(Image, f"{view}/color") for view in COLOUR_VIEWS}
        self._compressed = {
            view: make_publisher(CompressedImage, f"{view}/compressed") for view in COMPRESSED_VIEWS
        }

    @property
    def publishers(self) -> tuple[Publisher, ...]:
        """All of them, for whoever ends them."""
        return (*self._colour.values(), *self._compressed.values())

    def wanted_views(self) -> frozenset[str]:
        """Give the views that somebody subscribes to a companion of."""
        topics = (*self._colour.items(), *self._compressed.items())
        return frozenset(view for view, topic in topics if topic.get_subscription_count())

    def publish(self, frame: Frame, header: Header) -> None:
        """Publish what is subscribed to of the views that the frame has."""
        for view, topic in self._colour.items():
            if view in frame.views and topic.get_subscription_count():
                picture = view_picture(
                    view,
                    frame[view],
                    table=self._categories(),
                    near_m=frame.camera.intrinsics.near_m,
                    depth_range_m=self._depth_range_m,
                )
                topic.publish(picture_to_image(picture, header))
        for view, topic in self._compressed.items():
            if view in frame.views and topic.get_subscription_count():
                topic.publish(compressed_view(view, frame[view], header))


def compressed_view(view: str, values: NDArray[Any], header: Header) -> CompressedImage:
    """Make the compressed image of a view, with a format as image_transport writes it.

    Parameters
    ----------
    view : str
        One of `COMPRESSED_VIEWS`.
    values : (H, W) or (H, W, 3) array
        As `sailenv_ros.frame.VIEWS` says.
    header : Header
        Kept, not copied.
    """
    codec, encoding = COMPRESSED_VIEWS[view], VIEWS[view].encoding
    if codec == "jpeg":
        settings, target = [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY], "bgr8"
        values = np.ascontiguousarray(values[..., ::-1])
    else:
        # Level 1 is five times as fast as the default and hardly larger for areas of one id.
        settings, target = [cv2.IMWRITE_PNG_COMPRESSION, 1], ""
    _, data = cv2.imencode(f".{codec}", values, settings)
    message = CompressedImage(header=header, format=f"{encoding}; {codec} compressed {target}")
    message.data.frombytes(data.tobytes())
    return message
