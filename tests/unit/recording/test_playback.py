"""When messages are due: rate, pauses, offsets; against arithmetic."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.errors import InvalidRequest, RecordingError
from sailenv_ros.recording.playback import PlaybackClock, programme
from sailenv_ros.recording.reader import RecordingReader
from sailenv_ros.recording.topics import OfferedQos, RecordedTopic
from sailenv_ros.recording.writer import RecordingWriter

STATE = RecordedTopic(
    name="/state",
    type="std_msgs/msg/String",
    schema="string data\n",
    qos=OfferedQos(depth=1, durability="transient_local"),
)
NOTE = RecordedTopic(name="/note", type="std_msgs/msg/String", schema="string data\n")
SECOND_NS = 1_000_000_000


@given(
    rate=st.floats(0.01, 100.0),
    start_ns=st.integers(0, 10**18),
    spans=st.lists(st.tuples(st.floats(0.0, 100.0), st.floats(0.0, 100.0)), max_size=5),
)
def test_only_the_time_that_it_ran_counts(
    rate: float, start_ns: int, spans: list[tuple[float, float]]
) -> None:
    """The position is the start plus the rate times the time it was not paused."""
    clock = PlaybackClock(rate=rate, start_ns=start_ns)
    now = ran = 0.0
    for running, standing in spans:
        clock.resume(now)
        now += running
        ran += running
        clock.pause(now)
        now += standing
        assert clock.wait_s(start_ns, now) == math.inf
    clock.resume(now)
    assert clock.position_ns(now) - start_ns == pytest.approx(ran * rate * 1e9, abs=1e4, rel=1e-9)


def test_waiting_times_are_those_of_the_rate() -> None:
    """At rate 4, a second of the recording takes a quarter; what is past is due at once."""
    clock = PlaybackClock(rate=4.0, start_ns=5 * SECOND_NS)
    assert clock.paused
    clock.resume(100.0)
    assert clock.wait_s(6 * SECOND_NS, 100.0) == pytest.approx(0.25)
    assert clock.wait_s(6 * SECOND_NS, 100.5) == 0.0
    clock.rewind(200.0)
    assert clock.wait_s(6 * SECOND_NS, 200.0) == pytest.approx(0.25)
    for rate in (0.0, -1.0, math.nan, 1e6):
        with pytest.raises(InvalidRequest, match="above 0"):
            PlaybackClock(rate=rate)


@pytest.fixture
def bag(tmp_path: Path) -> Path:
    with RecordingWriter(tmp_path / "bag") as writer:
        writer.add_topic(STATE)
        writer.add_topic(NOTE)
        writer.write("/state", (b"\0\1\0\0old\0",), 1 * SECOND_NS)
        for second in (10, 11, 12, 13):
            writer.write("/note", (b"\0\1\0\0abc\0",), second * SECOND_NS)
        writer.write("/state", (b"\0\1\0\0new\0",), 12 * SECOND_NS + 1)
    return tmp_path / "bag"


def test_playing_starts_with_what_is_not_latched(bag: Path) -> None:
    """A latched message that is much older is sent at once, not waited after."""
    with RecordingReader(bag) as reader:
        both = programme(reader, ["/state", "/note"])
        assert (both.start_ns, both.end_ns) == (10 * SECOND_NS, 13 * SECOND_NS)
        assert [int(reader.log_ns(row)) // SECOND_NS for row in both.before] == [1]
        assert len(both.rows) == 5
        alone = programme(reader, ["/state"])
        assert (alone.start_ns, alone.before) == (1 * SECOND_NS, ())


def test_an_offset_leaves_out_what_is_before_but_the_latest_state(bag: Path) -> None:
    """From 2.5 s on there is one note left, and the newest state before."""
    with RecordingReader(bag) as reader:
        late = programme(reader, ["/state", "/note"], 2.5)
        times = [int(reader.log_ns(row)) for row in (*late.before, *late.rows)]
        assert times == [12 * SECOND_NS + 1, 13 * SECOND_NS]
        with pytest.raises(InvalidRequest, match=r"from 0 to 3 \[s\]"):
            programme(reader, ["/note"], 3.5)
        with pytest.raises(InvalidRequest, match="0 or more"):
            programme(reader, ["/note"], -1.0)


def test_a_recording_without_messages_cannot_be_played(tmp_path: Path) -> None:
    """It is said, not waited for."""
    with RecordingWriter(tmp_path / "bag") as writer:
        writer.add_topic(NOTE)
    with RecordingReader(tmp_path / "bag") as reader, pytest.raises(RecordingError):
        programme(reader, [topic.name for topic in reader.topics])
