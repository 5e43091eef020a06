"""Files that we write, asked by the reader of the format's own library what they hold."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.records import Channel, Metadata, Schema
from mcap.stream_reader import StreamReader

from sailenv_ros.errors import RecordingError
from sailenv_ros.recording.mcap.chunks import ChunkBuilder
from sailenv_ros.recording.mcap.file_writer import MAGIC, McapFile

TIMES = st.integers(0, 1000)


def file_with(path: Path, times: list[list[int]]) -> McapFile:
    """Write chunks of messages at those times, their channels 1 and 2 in turn; not finished."""
    file = McapFile(path)
    file.add_schema(Schema(id=1, name="pkg/msg/A", encoding="ros2msg", data=b"int8 a\n"))
    for id_ in (1, 2):
        file.add_channel(
            Channel(id=id_, topic=f"/t{id_}", message_encoding="cdr", metadata={}, schema_id=1)
        )
    builder = ChunkBuilder("lz4")
    sequence = 0
    for chunk in times:
        for time in chunk:
            builder.add(1 + sequence % 2, sequence, time, time, (b"%d" % sequence,))
            sequence += 1
        file.add_chunk(builder.seal())
    return file


@settings(max_examples=40, deadline=None)
@given(
    times=st.lists(st.lists(TIMES, min_size=1, max_size=5), max_size=5),
    start=TIMES,
    length=TIMES,
    topics=st.sampled_from([None, ["/t1"], ["/t2"], ["/t1", "/t2"], ["/none"]]),
)
def test_the_library_finds_messages_by_time_and_topic(
    tmp_path_factory: pytest.TempPathFactory,
    times: list[list[int]],
    start: int,
    length: int,
    topics: list[str] | None,
) -> None:
    """It skips chunks by our indexes, and misses nothing that lies in them."""
    path = tmp_path_factory.mktemp("mcap") / "a.mcap"
    file_with(path, times).finish()
    everything = enumerate(time for chunk in times for time in chunk)
    wanted = sorted(
        (time, sequence)
        for sequence, time in everything
        if start <= time < start + length and (topics is None or f"/t{1 + sequence % 2}" in topics)
    )
    with path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        found = reader.iter_messages(topics=topics, starting_at=start, ending_before=start + length)
        assert sorted((m.log_time, m.sequence) for _, _, m in found) == wanted


def test_statistics_metadata_and_offsets_are_the_files_own(tmp_path: Path) -> None:
    """The summary says what a walk over all records finds, and where."""
    path = tmp_path / "a.mcap"
    file = file_with(path, [[5, 3], [9, 4, 4]])
    file.add_metadata(Metadata(name="rosbag2", metadata={"key": "value", "ä": ""}))
    assert not file.finished
    assert file.finish() == 0
    assert file.finish() == 0
    assert (file.finished, file.message_count, file.span_ns()) == (True, 5, (3, 9))
    assert file.counts() == {1: 3, 2: 2}
    assert file.size == path.stat().st_size
    with path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        summary = reader.get_summary()
        (metadata,) = reader.iter_metadata()
        stream.seek(0)
        # Sums of chunks, of the data and of the summary are compared on the way.
        kinds = [
            type(record).__name__
            for record in StreamReader(stream, emit_chunks=True, validate_crcs=True).records
        ]
    assert (metadata.name, metadata.metadata) == ("rosbag2", {"key": "value", "ä": ""})
    assert summary is not None
    statistics = summary.statistics
    assert statistics is not None
    assert statistics.channel_message_counts == {1: 3, 2: 2}
    assert (statistics.message_start_time, statistics.message_end_time) == (3, 9)
    assert (statistics.schema_count, statistics.channel_count) == (1, 2)
    assert (statistics.chunk_count, statistics.metadata_count) == (2, 1)
    counts = [kinds.count(kind) for kind in ("Chunk", "Metadata", "SummaryOffset")]
    assert counts == [2, 1, 5]
    data = path.read_bytes()
    for chunk in summary.chunk_indexes:
        assert data[chunk.chunk_start_offset] == 6
    assert data.startswith(MAGIC)
    assert data.endswith(MAGIC)


def test_an_abandoned_file_is_gone_and_an_existing_one_stays(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    file = file_with(path, [[1]])
    with pytest.raises(RecordingError, match="File exists"):
        McapFile(path)
    assert path.exists()
    file.abandon()
    assert not path.exists()
