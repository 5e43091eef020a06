"""The client's bytes: read however they are cut, refused where they break the protocol."""

from __future__ import annotations

import contextlib
import struct
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.errors import ProtocolError, UnknownName
from sailenv_ros.gateway.codec import (
    MAX_DOCUMENT_LENGTH,
    MAX_NAME_LENGTH,
    Message,
    MessageReader,
    pack_floats,
    pack_ints,
    pack_string,
    pack_strings,
)
from sailenv_ros.gateway.protocol_commands import commands_of
from sailenv_ros.simulation.models.uploads import MAX_UPLOAD_BYTES
from tests.unit.gateway.wire import hello, messages

PROTOCOLS = st.sampled_from(("0.5", "0.6"))


def begun(protocol: str = "0.5") -> MessageReader:
    """A reader whose registration is behind it."""
    reader = MessageReader(protocol)
    reader.feed(hello())
    assert reader.take() is not None
    return reader


def all_of(reader: MessageReader) -> list[Message]:
    taken = []
    while (message := reader.take()) is not None:
        taken.append(message)
    return taken


@given(data=st.data(), protocol=PROTOCOLS)
def test_messages_come_out_as_they_were_sent(data: st.DataObject, protocol: str) -> None:
    """Any commands, cut into any pieces, give the same messages in the same order."""
    sent = data.draw(st.lists(messages(dict(commands_of(protocol))), max_size=6))
    stream = b"".join(written for written, _, _ in sent)
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=8)))
    reader, came = begun(protocol), []
    for start, end in zip([0, *cuts], [*cuts, len(stream)], strict=True):
        reader.feed(stream[start:end])
        came += all_of(reader)
    assert [(message.name, dict(message.fields)) for message in came] == [
        (name, values) for _, name, values in sent
    ]
    assert reader.is_idle
    assert reader.held_bytes == 0


@given(st.lists(st.binary(max_size=64), max_size=30), PROTOCOLS)
def test_any_bytes_give_messages_or_an_error(pieces: list[bytes], protocol: str) -> None:
    """Whatever a peer sends, there is nothing but messages and ProtocolError."""
    reader = MessageReader(protocol)
    with contextlib.suppress(ProtocolError):
        for piece in pieces:
            reader.feed(piece)
            assert all(isinstance(message, Message) for message in all_of(reader))


def test_half_a_command_is_no_message_yet() -> None:
    """The reader waits for what is missing, and says that it is in the middle of something."""
    reader = begun()
    assert reader.is_idle
    reader.feed(b"\x05" + b"\x00" * 11)
    assert reader.take() is None
    assert not reader.is_idle
    reader.feed(b"\x00")
    assert reader.take() == Message(name="set_position", fields={"position": (0.0, 0.0, 0.0)})


@pytest.mark.parametrize(
    ("sent", "limit"),
    [
        (b"\x02", MAX_NAME_LENGTH),
        (b"\x0c" + struct.pack("<i", 1) + b"a", MAX_UPLOAD_BYTES),
        (b"\x1d", MAX_DOCUMENT_LENGTH),
    ],
)
@pytest.mark.parametrize("length", [-1, -(2**31), 2**31 - 1, "limit"])
def test_a_length_over_its_limit_is_refused_at_once(sent: bytes, limit: int, length: Any) -> None:
    """No memory is taken for what was merely announced."""
    reader = begun("0.6")
    reader.feed(sent + struct.pack("<i", limit + 1 if length == "limit" else length))
    with pytest.raises(ProtocolError, match="must have from 0 to"):
        reader.take()


def test_an_unknown_command_is_refused() -> None:
    """A byte of the later revision is none of the earlier one."""
    reader = begun("0.5")
    reader.feed(b"\x1e")
    with pytest.raises(ProtocolError, match="0x1e is no command"):
        reader.take()


def test_a_text_that_is_not_utf_8_is_refused() -> None:
    """A broken name ends the conversation; nobody knows where the next command begins."""
    reader = begun()
    reader.feed(b"\x02" + struct.pack("<i", 3) + b"a\xff\xfe")
    with pytest.raises(ProtocolError, match="the name of change_scene is not UTF-8"):
        reader.take()


def test_only_known_revisions_can_be_spoken() -> None:
    """The error names those that there are."""
    with pytest.raises(UnknownName, match=r"0\.5, 0\.6"):
        MessageReader("0.7")


def test_answers_are_little_endian_with_lengths_in_bytes() -> None:
    """Byte for byte as the protocol says, unlike the client's own texts."""
    assert pack_ints(1, -2) == b"\x01\0\0\0\xfe\xff\xff\xff"
    assert pack_floats(1.0) == b"\0\0\x80\x3f"
    assert pack_string("Bär") == b"\x04\0\0\0B\xc3\xa4r"
    assert pack_strings(["a", ""]) == b"\x02\0\0\0\x01\0\0\0a\0\0\0\0"
