"""Chunks and files against the readers of the format's own library."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.records import Channel, Schema

from sailenv_ros.errors import RecordingError
from sailenv_ros.recording.mcap.chunks import ChunkBuilder, records_in, unpacked
from sailenv_ros.recording.mcap.file_writer import McapFile
from tests.support.recordings import file_size_limit

COMPRESSIONS = ("zstd", "lz4", "none")

message = st.tuples(
    st.integers(1, 3),
    st.integers(0, 2**32 - 1),
    st.integers(0, 2**62),
    st.integers(0, 2**62),
    st.lists(st.binary(max_size=200), max_size=4),
)


def write_file(path: Path, compression: str, chunks: list[list[tuple[object, ...]]]) -> None:
    file = McapFile(path)
    file.add_schema(Schema(id=1, name="pkg/msg/A", encoding="ros2msg", data=b"int8 a\n"))
    for number in (1, 2, 3):
        channel = Channel(
            id=number, topic=f"/t{number}", message_encoding="cdr", metadata={}, schema_id=1
        )
        file.add_channel(channel)
    builder = ChunkBuilder(compression)  # type: ignore[arg-type]  # a name from the list above
    for messages in chunks:
        for entry in messages:
            builder.add(*entry)  # type: ignore[arg-type]  # drawn in this order
        file.add_chunk(builder.seal())
    assert file.finish() == 0


@settings(max_examples=60, deadline=None)
@given(
    compression=st.sampled_from(COMPRESSIONS),
    chunks=st.lists(st.lists(message, min_size=1, max_size=6), max_size=4),
)
def test_what_is_written_is_read_by_the_formats_library(
    tmp_path_factory: pytest.TempPathFactory,
    compression: str,
    chunks: list[list[tuple[object, ...]]],
) -> None:
    """Every message comes back whole, by the indexes, with every check sum right."""
    path = tmp_path_factory.mktemp("mcap") / "a.mcap"
    write_file(path, compression, chunks)
    written = sorted(
        (log, channel, sequence, sent, b"".join(parts))  # type: ignore[misc, call-overload]
        for messages in chunks
        for channel, sequence, log, sent, parts in messages
    )
    with path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        assert reader.get_header().profile == "ros2"
        summary = reader.get_summary()
        read = [
            (m.log_time, m.channel_id, m.sequence, m.publish_time, m.data)
            for _, _, m in reader.iter_messages()
        ]
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_count == len(written)
    assert summary.statistics.chunk_count == len(chunks)
    assert [entry[0] for entry in read] == sorted(entry[0] for entry in read)
    assert sorted(read) == written


@pytest.mark.parametrize("size", [2**31 + 1, 2**62, 2**63, 2**64 - 1])
@pytest.mark.parametrize("compression", ["zstd", "lz4", ""])
def test_a_chunk_larger_than_memory_is_refused(size: int, compression: str) -> None:
    """Nothing is set aside for what a chunk says of itself: found by fuzzing as OverflowError."""
    kind = compression.encode()
    head = struct.pack("<QQQI", 0, 0, size, 0) + len(kind).to_bytes(4, "little") + kind
    with pytest.raises(RecordingError, match="says that it holds"):
        unpacked(head + bytes(8))


def test_a_record_that_is_cut_off_is_told() -> None:
    """Records that end beyond their chunk are an error, not an endless walk."""
    for data in (b"\x05", b"\x05\x09\0\0\0\0\0\0\0xx"):
        with pytest.raises(RecordingError, match="cut off"):
            list(records_in(data))


@pytest.mark.parametrize("room", [40_000, 60_000, 100_000])
def test_a_full_disk_leaves_a_file_of_whole_chunks(tmp_path: Path, room: int) -> None:
    """When there is no room the file is finished with what fits, its summary included."""
    path = tmp_path / "a.mcap"
    kept = 0
    with file_size_limit(room):
        file = McapFile(path)
        file.add_schema(Schema(id=1, name="pkg/msg/A", encoding="ros2msg", data=b"int8 a\n"))
        file.add_channel(
            Channel(id=1, topic="/t", message_encoding="cdr", metadata={}, schema_id=1)
        )
        builder = ChunkBuilder("none")
        with pytest.raises(RecordingError, match=r"disk is full.*is kept"):  # noqa: PT012
            while True:
                builder.add(1, kept, kept, kept, (bytes(3000),))
                file.add_chunk(builder.seal())
                kept += 1
        lost = file.finish()
    with path.open("rb") as stream:
        read = [m.sequence for _, _, m in make_reader(stream, validate_crcs=True).iter_messages()]
    assert read == list(range(kept - lost))
    assert lost <= 1
    assert kept > 5
    assert path.stat().st_size <= room
