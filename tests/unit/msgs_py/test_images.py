"""Views as image messages: exact both ways, and nothing malformed gets in."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import Image
from std_msgs.msg import Header

from sailenv_msgs_py.images import image_from_view, picture_to_image, view_from_image
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.views import VIEWS

SIZES = st.tuples(st.integers(1, 9), st.integers(1, 9))


@st.composite
def views(draw: st.DrawFn) -> tuple[str, np.ndarray]:
    """A view's name and any array that such a view may be, NaN and infinities included."""
    name = draw(st.sampled_from(sorted(VIEWS)))
    shape = VIEWS[name].shape(*draw(SIZES))
    return name, draw(hnp.arrays(VIEWS[name].dtype, shape))


@given(views())
def test_every_view_survives_the_message_bit_for_bit(view: tuple[str, np.ndarray]) -> None:
    """What is received is what was rendered, every bit of it."""
    name, values = view
    image = image_from_view(name, values, Header(frame_id="a/camera_optical_frame"))
    received = view_from_image(name, image)
    assert received.dtype == values.dtype
    assert received.shape == values.shape
    assert received.tobytes() == values.tobytes()
    assert image.encoding == VIEWS[name].encoding
    assert len(image.data) == image.step * image.height
    assert image.header.frame_id == "a/camera_optical_frame"


@given(views())
def test_arrays_that_are_not_contiguous_are_sent_as_they_look(view: tuple[str, np.ndarray]) -> None:
    """A mirrored picture arrives mirrored."""
    name, values = view
    mirrored = values[:, ::-1]
    received = view_from_image(name, image_from_view(name, mirrored, Header()))
    assert received.tobytes() == np.ascontiguousarray(mirrored).tobytes()


def test_the_private_attribute_that_is_set_is_the_one_that_is_sent() -> None:
    """`image._data` is rclpy's own: should a release keep the bytes elsewhere, this tells it.

    Sending without a copy and reading recordings set it, because the public setter looks at each
    byte.
    """
    image = Image(height=1, width=4, encoding="mono8", step=4)
    assert "_data" in Image.__slots__
    for own in (bytearray(b"abcd"), memoryview(b"efgh")):
        image._data = own
        assert image.data is own
        assert bytes(deserialize_message(serialize_message(image), Image).data) == bytes(own)
    image.data = b"ijkl"
    assert bytes(image._data) == b"ijkl"


@given(views())
def test_what_is_sent_without_a_copy_is_the_same_on_the_wire(view: tuple[str, np.ndarray]) -> None:
    """A message that looks at the array's own memory arrives just the same."""
    name, values = view
    sent = [image_from_view(name, values, Header(), copy=copy) for copy in (True, False)]
    copied, looked_at = (deserialize_message(serialize_message(msg), Image) for msg in sent)
    assert copied == looked_at
    assert view_from_image(name, looked_at).tobytes() == values.tobytes()


def test_truth_values_travel_as_0_and_255() -> None:
    """A mask can be looked at with any tool for 8-bit pictures."""
    image = image_from_view("flow_valid", np.array([[True, False]]), Header())
    assert list(image.data) == [255, 0]


def test_receiving_copies_nothing() -> None:
    """The array lies on the message's own bytes."""
    image = image_from_view("instance", np.array([[1, 2]], np.uint16), Header())
    received = view_from_image("instance", image)
    image.data[0] = 7
    assert received[0, 0] == 7


def test_padded_rows_are_read() -> None:
    """A foreign publisher may pad its rows; the padding is left out."""
    image = image_from_view("instance", np.array([[1, 2], [3, 4]], np.uint16), Header())
    rows = np.frombuffer(image.data, np.uint8).reshape(2, 4)
    image.data = np.pad(rows, ((0, 0), (0, 3))).ravel()
    image.step = 7
    assert view_from_image("instance", image).tolist() == [[1, 2], [3, 4]]


@pytest.mark.parametrize(
    ("field", "value", "words"),
    [
        ("encoding", "mono8", "encoding of the instance image"),
        ("step", 3, "step of the instance image"),
        ("step", 6, "size of the data"),
        ("height", 3, "size of the data"),
        ("is_bigendian", 1, "is_bigendian"),
    ],
)
def test_a_malformed_image_is_refused(field: str, value: object, words: str) -> None:
    """Encoding, byte order, step and size are looked at before the bytes are believed."""
    image = image_from_view("instance", np.array([[1, 2], [3, 4]], np.uint16), Header())
    setattr(image, field, value)
    with pytest.raises(InvalidRequest, match=words):
        view_from_image("instance", image)


@pytest.mark.parametrize(
    "values",
    [np.zeros((2, 2), np.float64), np.zeros((2, 2, 1), np.float32), np.zeros(4, np.float32)],
)
def test_an_array_of_another_kind_is_not_sent(values: np.ndarray) -> None:
    """Only an array of the view's dtype and shape becomes its message."""
    with pytest.raises(InvalidRequest, match="view depth"):
        image_from_view("depth", values, Header())


def test_pictures_are_rgb8() -> None:
    """Coloured views are plain pictures; anything else is refused."""
    picture = np.arange(18, dtype=np.uint8).reshape(2, 3, 3)
    assert bytes(picture_to_image(picture, Header()).data) == picture.tobytes()
    with pytest.raises(InvalidRequest, match="picture"):
        picture_to_image(picture[..., :2], Header())
