"""Topics derived from an agent's image topics: pictures for RViz and rqt, compressed images.

`Frame` → `<view>/color` (rgb8 pictures of numbers and ids), `<view>/compressed` (jpeg of the
picture, lossless png of ids) and `<view>/compressedDepth`, each made only while somebody
subscribes. Knows no simulation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from numpy.typing import NDArray
from rclpy.publisher import Publisher
from sensor_msgs.msg import CompressedImage, Image
from std_msgs.msg import Header

from sailenv_msgs_py.images import picture_to_image
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.pictures.codecs import encode_inverse_depth, encode_jpeg, encode_png
from sailenv_ros.frame.pictures.colours import view_picture
from sailenv_ros.types.labels import CategoryTable
from sailenv_ros.types.views import VIEWS, view_spec

__all__ = ["DerivedTopics", "compressed_view"]

JPEG_QUALITY = 90


class DerivedTopics:
    """Publishes what people look at.

    Parameters
    ----------
    make_publisher : callable
        ``make_publisher(kind, topic)`` makes a publisher below the agent's name.
    views : iterable of str
        Views that the renderer can make; `VIEWS` says which topics are derived from each.
    depth_range_m : float
        Depth that is shown as black [m].
    categories : callable
        Gives the table of categories as it is now.
    """

    def __init__(
        self,
        make_publisher: Callable[[type, str], Publisher],
        views: Iterable[str],
        *,
        depth_range_m: float,
        categories: Callable[[], CategoryTable],
    ) -> None:
        self._depth_range_m = depth_range_m
        self._categories = categories
        specs = [view_spec(view) for view in views]
        self._colour = {
            spec.name: make_publisher(Image, f"{spec.name}/color")
            for spec in specs
            if spec.color_topic
        }
        self._compressed = {
            spec.name: make_publisher(CompressedImage, spec.compressed_name)
            for spec in specs
            if spec.compressed_topic
        }

    @property
    def publishers(self) -> tuple[Publisher, ...]:
        """All of them, to be ended together."""
        return (*self._colour.values(), *self._compressed.values())

    def wanted_views(self) -> frozenset[str]:
        """Return the views that somebody subscribes to a derived topic of."""
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
        One that has a `compressed_topic` in `VIEWS`.
    values : (H, W) or (H, W, 3) array
        As `sailenv_ros.types.views.VIEWS` says.
    header : Header
        Kept, not copied.

    Raises
    ------
    InvalidRequest
        If that view is not compressed.
    """
    spec = view_spec(view)
    codec, encoding = spec.compressed_topic, spec.encoding_of(values.dtype)
    if codec is None:
        compressed = ", ".join(name for name, spec in VIEWS.items() if spec.compressed_topic)
        raise InvalidRequest("view to compress", view, f"one of: {compressed}")
    if codec == "jpeg":
        data, kind = encode_jpeg(values, JPEG_QUALITY), "jpeg compressed bgr8"
    elif codec == "png":
        data, kind = encode_png(values, "quick"), "png compressed "
    else:
        data, kind = encode_inverse_depth(values), "compressedDepth png"
    message = CompressedImage(header=header, format=f"{encoding}; {kind}")
    message.data.frombytes(data)
    return message
