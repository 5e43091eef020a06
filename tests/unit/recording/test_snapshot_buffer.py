"""The last seconds are kept, older ones are not, and a bag comes of them when it is asked for."""

from __future__ import annotations

from pathlib import Path

import pytest

from sailenv_ros.errors import RecordingError
from sailenv_ros.recording.reader import RecordingReader
from sailenv_ros.recording.snapshot_buffer import SnapshotBuffer
from sailenv_ros.recording.topics import OfferedQos, RecordedTopic, RecordingOptions

S = 10**9
VOLATILE = RecordedTopic(name="/a", type="std_msgs/msg/Empty", schema="", qos=OfferedQos())
LATCHED = RecordedTopic(
    name="/info",
    type="std_msgs/msg/Empty",
    schema="",
    qos=OfferedQos(depth=1, durability="transient_local"),
)


def buffer(folder: Path, *, keep_s: float = 3.0, limit_bytes: int = 10**6) -> SnapshotBuffer:
    made = SnapshotBuffer(
        folder / "bag", RecordingOptions(), keep_s=keep_s, limit_bytes=limit_bytes
    )
    made.add_topic(VOLATILE)
    made.add_topic(LATCHED)
    return made


def kept(folder: Path) -> list[tuple[str, bytes, int]]:
    with RecordingReader(folder) as reader:
        return [(t.name, bytes(raw.data), raw.log_ns) for t, raw in reader.messages()]


def test_the_last_seconds_and_what_was_latched_before(tmp_path: Path) -> None:
    """A latched message from before the kept seconds stands at their beginning, the last alone."""
    recent = buffer(tmp_path)
    recent.put("/info", b"\0\1\0\0old", 1 * S)
    recent.put("/info", b"\0\1\0\0new", 2 * S)
    for second in range(1, 11):
        recent.put("/a", b"\0\1\0\0%d" % second, second * S)
    folder = recent.write()
    assert folder == tmp_path / "bag_0"
    assert kept(folder) == [
        ("/info", b"\0\1\0\0new", 7 * S),
        *(("/a", b"\0\1\0\0%d" % second, second * S) for second in range(7, 11)),
    ]
    recent.put("/a", b"\0\1\0\0x", 12 * S)
    assert recent.write() == tmp_path / "bag_1"
    assert [log_ns for _, _, log_ns in kept(tmp_path / "bag_1")] == [9 * S, 9 * S, 10 * S, 12 * S]


def test_memory_is_bounded(tmp_path: Path) -> None:
    """Also where messages are larger than was thought."""
    recent = buffer(tmp_path, keep_s=1e6, limit_bytes=1000)
    for number in range(50):
        recent.put("/a", b"\0\1\0\0" + bytes(296), number)
    assert [log_ns for _, _, log_ns in kept(recent.write())] == [47, 48, 49]


def test_without_a_message_there_is_nothing_to_write(tmp_path: Path) -> None:
    """One sentence, no folder; a name that is in use is passed over."""
    recent = buffer(tmp_path)
    with pytest.raises(RecordingError, match="nothing has been recorded yet"):
        recent.write()
    assert not list(tmp_path.iterdir())
    (tmp_path / "bag_0").mkdir()
    recent.put("/a", b"\0\1\0\0x", 1)
    assert recent.write() == tmp_path / "bag_1"
