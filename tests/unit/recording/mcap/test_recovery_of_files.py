"""Restoring cut-off files, against what the format's own library still reads of them."""

from __future__ import annotations

import io
import struct

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap.records import Message
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType, Writer

from sailenv_ros.recording.mcap.recovery import recover_file


def written(chunk_size: int, *, chunked: bool) -> bytes:
    stream = io.BytesIO()
    writer = Writer(
        stream, chunk_size=chunk_size, compression=CompressionType.LZ4, use_chunking=chunked
    )
    writer.start()
    schema = writer.register_schema("pkg/msg/A", "ros2msg", b"int8 a\n")
    channel = writer.register_channel("/t", "cdr", schema)
    for number in range(30):
        writer.add_message(channel, number, bytes([number]) * number, number, number)
    writer.finish()
    return stream.getvalue()


def readable(data: bytes) -> list[int]:
    """Return the numbers of the whole messages that the library reads until it gives up."""
    read = []
    try:
        for record in StreamReader(io.BytesIO(data), validate_crcs=True).records:
            # Bytes that are missing at the end of the last one are no error to it.
            if isinstance(record, Message) and len(record.data) == record.sequence:
                read.append(record.sequence)
    except (McapError, ValueError, RuntimeError, struct.error):
        pass
    return read


@settings(max_examples=80, deadline=None)
@given(chunk_size=st.sampled_from([1, 100, 300]), chunked=st.booleans(), share=st.floats(0.0, 1.0))
def test_a_cut_file_keeps_all_that_the_library_reads_of_it(
    tmp_path_factory: pytest.TempPathFactory, chunk_size: int, chunked: bool, share: float
) -> None:
    """And is a whole file afterwards, which the library reads by its index."""
    folder = tmp_path_factory.mktemp("mcap")
    data = written(chunk_size, chunked=chunked)
    cut = data[: 8 + round(share * (len(data) - 8))]
    (folder / "cut.mcap").write_bytes(cut)
    done = recover_file(folder / "cut.mcap", folder / "whole.mcap")
    with (folder / "whole.mcap").open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        summary = reader.get_summary()
        read = [(m.sequence, m.data) for _, _, m in reader.iter_messages()]
    assert summary is not None
    assert read == [(number, bytes([number]) * number) for number in range(len(read))]
    assert [number for number, _ in read] == readable(cut)
    assert done.messages == len(read)
    assert done.kept is None
