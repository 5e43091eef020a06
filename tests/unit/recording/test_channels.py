"""The table of channels against rclpy's own serialization, field by field."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import Image
from std_msgs.msg import Header

from sailenv_msgs_py.images import image_from_view
from sailenv_ros.errors import RecordingError
from sailenv_ros.recording.channels import (
    AGENT_TOPICS,
    IMAGE,
    agent_topics,
    frame_messages,
    message_of,
    topic,
)
from sailenv_ros.recording.schemas import message_class, schema_text, type_hash
from sailenv_ros.types.views import VIEWS
from tests.support.recordings import noise_frame

pytestmark = pytest.mark.ros

ALL = tuple(VIEWS)


def test_images_are_serialized_as_rclpy_does_it() -> None:
    """rclpy reads our messages whole, and would make just as many bytes of them."""
    frame = noise_frame(5, views=ALL)
    for name, parts in frame_messages(frame, 10.0):
        data = b"".join(parts)
        message = deserialize_message(data, message_class(AGENT_TOPICS[name]))
        # Not the same bytes: what rclpy leaves between aligned fields is left to chance.
        assert len(serialize_message(message)) == len(data), name
        if name in ALL:
            assert message == image_from_view(name, frame[name], message.header)


@settings(max_examples=100, deadline=None)
@given(
    frame_id=st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=9),
    encoding=st.sampled_from(["8UC1", "rgb8", "", "x"]),
    pixels=st.binary(max_size=40),
    step=st.integers(0, 2**32 - 1),
    sec=st.integers(-(2**31), 2**31 - 1),
)
def test_any_image_is_read_as_rclpy_reads_it(
    frame_id: str, encoding: str, pixels: bytes, step: int, sec: int
) -> None:
    """The quick way of reading images gives what the slow one gives, whatever the alignment."""
    header = Header(frame_id=frame_id)
    header.stamp.sec = sec
    image = Image(header=header, height=3, width=7, encoding=encoding, step=step, data=pixels)
    data = serialize_message(image)
    read = message_of(IMAGE, data)
    assert bytes(read.data) == pixels
    read.data = bytes(read.data)
    assert read == deserialize_message(data, Image)


def test_an_image_that_was_read_is_its_readers_own() -> None:
    """The pixels can be written to and are not those of the file's bytes."""
    data = bytearray(serialize_message(Image(height=1, width=4, data=b"abcd")))
    read = message_of(IMAGE, data)
    np.frombuffer(read.data, np.uint8)[0] = 7
    assert data.endswith(b"abcd")


@settings(max_examples=60, deadline=None)
@given(cut=st.integers(0, 70))
def test_a_cut_message_is_an_error_of_ours(cut: int) -> None:
    """No prefix of an image is read as one."""
    data = serialize_message(Image(header=Header(frame_id="eye"), encoding="8UC1", data=b"abcdef"))
    with pytest.raises(RecordingError, match="cannot be read"):
        message_of(IMAGE, data[: min(cut, len(data) - 1)])


def test_schemas_hold_everything_they_refer_to() -> None:
    """A definition is followed by those of all its parts, each once, in the usual form."""
    text = schema_text("sailenv_msgs/msg/FrameInfo")
    parts = [line for line in text.splitlines() if line.startswith("MSG: ")]
    assert sorted(parts) == [
        "MSG: builtin_interfaces/Time",
        "MSG: geometry_msgs/Point",
        "MSG: geometry_msgs/Pose",
        "MSG: geometry_msgs/Quaternion",
        "MSG: sailenv_msgs/RowPoses",
        "MSG: sailenv_msgs/Skeleton",
        "MSG: std_msgs/Header",
    ]
    assert text.count("=" * 80 + "\nMSG: ") == len(parts)
    assert type_hash("sensor_msgs/msg/Image").startswith("RIHS01_")


def test_what_is_not_installed_is_named() -> None:
    """An unknown type or package is an error that names it."""
    for call in (schema_text, message_class):
        with pytest.raises(RecordingError, match="no_such_msgs"):
            call("no_such_msgs/msg/Thing")
        with pytest.raises(RecordingError, match="sensor_msgs/msg/Image"):
            call("Thing")
    assert type_hash("no_such_msgs/msg/Thing") == ""


def test_an_agents_topics_are_its_views_and_infos() -> None:
    """Only images are bulky; the latched scene_info says so."""
    topics = {entry.name: entry for entry in agent_topics("/sim", "eye", ("rgb", "flow"))}
    assert set(topics) == {
        f"/sim/eye/{name}" for name in ("rgb", "flow", "camera_info", "frame_info", "pose")
    }
    assert {name for name, entry in topics.items() if entry.bulky} == {
        "/sim/eye/rgb",
        "/sim/eye/flow",
    }
    info = topic("/sim/scene_info", "sailenv_msgs/msg/SceneInfo")
    assert info.qos.durability == "transient_local"
