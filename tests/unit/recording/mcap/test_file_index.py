"""The index of a file against the reader of the format's own library, on files that it wrote."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.opcode import Opcode
from mcap.reader import NonSeekingReader
from mcap.writer import CompressionType, IndexType, Writer

from sailenv_ros.errors import RecordingError
from sailenv_ros.recording.mcap.file_index import FileIndex
from sailenv_ros.recording.mcap.file_writer import MAGIC

MESSAGES = st.lists(
    st.tuples(st.integers(0, 2), st.integers(0, 2**62), st.integers(0, 2**62), st.binary()),
    max_size=12,
)


def write(path: Path, messages: list[tuple[int, int, int, bytes]], **options: object) -> None:
    with path.open("wb") as stream:
        writer = Writer(stream, **options)  # type: ignore[arg-type]  # drawn below
        writer.start(profile="", library="the library itself")
        schema = writer.register_schema("pkg/msg/A", "ros2msg", b"int8 a\n")
        channels = [writer.register_channel(f"/t{i}", "cdr", schema) for i in range(3)]
        for number, (channel, log_ns, publish_ns, data) in enumerate(messages):
            writer.add_message(channels[channel], log_ns, data, publish_ns, number)
        writer.finish()


@settings(max_examples=60, deadline=None)
@given(
    messages=MESSAGES,
    chunk_size=st.sampled_from([1, 60, 2**20]),
    compression=st.sampled_from(list(CompressionType)),
    index_types=st.sampled_from([IndexType.ALL, IndexType.NONE, IndexType.CHUNK]),
    use_chunking=st.booleans(),
    use_statistics=st.booleans(),
    repeat_channels=st.booleans(),
    enable_crcs=st.booleans(),
)
def test_every_message_is_found_where_the_library_finds_it(
    tmp_path_factory: pytest.TempPathFactory,
    messages: list[tuple[int, int, int, bytes]],
    **options: object,
) -> None:
    """However the file was written: with and without chunks, indexes, statistics and sums."""
    path = tmp_path_factory.mktemp("mcap") / "a.mcap"
    write(path, messages, **options)
    index = FileIndex(path)
    try:
        read = []
        for entry in index.entries:
            message = index.message(entry)
            topic = index.channels[int(entry["channel"])].topic
            read.append(
                (message.log_ns, message.sequence, topic, message.publish_ns, bytes(message.data))
            )
    finally:
        index.close()
    with path.open("rb") as stream:
        wanted = [
            (m.log_time, m.sequence, channel.topic, m.publish_time, m.data)
            # The one that needs no index; the other cannot read all that the writer can write.
            for _, channel, m in NonSeekingReader(stream).iter_messages(log_time_order=False)
        ]
    assert sorted(read) == sorted(wanted)
    assert len(read) == len(messages)


def test_chunks_are_unpacked_again_when_the_cache_is_small(tmp_path: Path) -> None:
    """Reading to and fro through more than the cache holds returns the same bytes."""
    path = tmp_path / "a.mcap"
    messages = [(0, number, number, bytes([number]) * 1000) for number in range(20)]
    write(path, messages, chunk_size=3000)
    index = FileIndex(path, cache_bytes=1)
    order = np.random.default_rng(0).permutation(20)
    assert [bytes(index.message(index.entries[i]).data) for i in order] == [
        messages[i][3] for i in order
    ]
    index.close()
    with pytest.raises(ValueError, match="closed"):
        index.message(index.entries[0])


def test_what_was_not_finished_names_the_command_that_restores_it(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    write(path, [(0, 1, 1, b"x")])
    path.write_bytes(path.read_bytes()[:-1])
    with pytest.raises(RecordingError, match="sailenv bag recover"):
        FileIndex(path)


@pytest.mark.parametrize("length", [2**31, 2**63 - 1, 2**63 + 1, 2**64 - 1])
def test_a_record_longer_than_any_file_is_damage(tmp_path: Path, length: int) -> None:
    """The next one would lie where no file can be read: found by fuzzing as an OSError."""
    path = tmp_path / "long.mcap"
    record = bytes([0x80]) + length.to_bytes(8, "little")  # of a kind that readers pass over
    footer = bytes([Opcode.FOOTER]) + (20).to_bytes(8, "little") + bytes(20)
    path.write_bytes(MAGIC + record + footer + MAGIC)
    with pytest.raises(RecordingError, match="shorter than its index says"):
        FileIndex(path)
