"""Padding is zero whatever lay in memory, and nothing else is changed."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import CameraInfo

from sailenv_msgs.msg import FrameInfo, SceneInfo
from sailenv_ros.recording.cdr_padding import message_layout, without_padding_garbage


def filled(kind: Any, text: str, count: int) -> Any:
    """Return a message whose texts and lists are filled, so that padding falls everywhere."""
    message = kind()
    for name, slot in zip(kind.get_fields_and_field_types(), kind.SLOT_TYPES, strict=True):
        value = getattr(message, name)
        sort = type(slot).__name__
        if isinstance(value, str):
            setattr(message, name, text)
        elif sort == "UnboundedSequence" and type(slot.value_type).__name__ == "UnboundedString":
            setattr(message, name, [text * k for k in range(count)])
        elif sort == "UnboundedSequence" and type(slot.value_type).__name__ == "BasicType":
            setattr(message, name, [k % 2 for k in range(count)])
    return message


@pytest.mark.parametrize("kind", [SceneInfo, FrameInfo, CameraInfo])
@given(text=st.text("ab", max_size=9), count=st.integers(0, 9))
def test_bytes_depend_on_the_message_alone(kind: Any, text: str, count: int) -> None:
    """What is no padding stays, and cleaning once is enough."""
    message = filled(kind, text, count)
    data = serialize_message(message)
    clean = without_padding_garbage(data, kind)
    assert deserialize_message(clean, kind) == message
    assert len(clean) == len(data)
    assert without_padding_garbage(data, kind) == clean
    assert without_padding_garbage(clean, kind) == clean


def test_padding_is_found_where_it_is() -> None:
    """Bytes that may be anything without changing the message become zero, and only those."""
    message = FrameInfo()
    message.header.frame_id = "abc"
    data = serialize_message(message)
    assert message_layout(FrameInfo)[0][0] == "message"
    clean = without_padding_garbage(data, FrameInfo)
    # Header: two numbers of 4 bytes, the length of the text, the text: 16 bytes behind the 4.
    assert clean[: 4 + 16] == data[: 4 + 16]
    changed = 0
    for at in range(4, len(clean)):
        trial = bytearray(clean)
        trial[at] ^= 0xFF
        try:
            cleaned = without_padding_garbage(bytes(trial), FrameInfo)
        except Exception:  # a length that is no longer one
            continue
        if cleaned == clean:
            changed += 1
            assert deserialize_message(bytes(trial), FrameInfo) == message
    assert changed > 0
