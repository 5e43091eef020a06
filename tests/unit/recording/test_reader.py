"""Reading recordings: ours frame by frame, other programs' message by message."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.writer import CompressionType, IndexType, Writer

from sailenv_ros import Agent
from sailenv_ros.errors import InvalidRequest, RecordingError, UnknownName
from sailenv_ros.frame.frame import Frame
from sailenv_ros.recording.frames import RecordedFrames
from sailenv_ros.recording.lockstep import FrameRecorder
from sailenv_ros.recording.reader import RecordingReader
from sailenv_ros.recording.topics import RecordingOptions
from sailenv_ros.recording.writer import RecordingWriter
from sailenv_ros.ros.client.recorded import RecordedAgent
from sailenv_ros.types.views import VIEWS
from tests.support.recordings import DT_NS, noise_frame, noise_info, write_noise

pytestmark = pytest.mark.ros

ALL = tuple(VIEWS)


def same_frame(read: Frame, written: Frame) -> None:
    for name in ("agent", "scene", "epoch", "revision", "sequence", "stamp_ns", "dt_ns"):
        assert getattr(read, name) == getattr(written, name)
    assert read.camera.intrinsics == written.camera.intrinsics
    np.testing.assert_allclose(
        read.camera.world_from_camera, written.camera.world_from_camera, rtol=0, atol=1e-12
    )
    assert read.states is not None
    assert read.states == written.states
    assert list(read.views) == [view for view in VIEWS if view in written.views]
    for view, values in written.views.items():
        assert read[view].dtype == values.dtype
        assert read[view].tobytes() == values.tobytes()


def same_dict(one: dict[str, Any], other: dict[str, Any]) -> None:
    assert list(one) == list(other)
    for key, value in one.items():
        if isinstance(value, np.ndarray):
            assert value.dtype == other[key].dtype, key
            assert value.shape == other[key].shape, key
            assert value.tobytes() == other[key].tobytes(), key
        else:
            assert value == other[key], key


@pytest.mark.parametrize(
    "options",
    [
        RecordingOptions(),
        RecordingOptions(compression="lz4", chunk_bytes=1),
        RecordingOptions(compression="none", split_bytes=60_000),
    ],
)
def test_frames_come_back_bit_for_bit(tmp_path: Path, options: RecordingOptions) -> None:
    """Every view of every frame, its camera and its numbers, however the bag was written."""
    frames = write_noise(tmp_path / "bag", 7, options, views=ALL)
    with RecordingReader(tmp_path / "bag") as reader:
        read = RecordedFrames(reader)
        assert (len(read), read.incomplete, read.views) == (7, 0, ALL)
        for one, other in zip(read, frames, strict=True):
            same_frame(one, other)
        same_frame(read[-2], frames[5])
        for one, other in zip(read[1:6:2], frames[1:6:2], strict=True):
            same_frame(one, other)


def test_a_recorded_agent_gives_the_live_agents_dict(tmp_path: Path) -> None:
    """`get_frame` goes through the frames in order, each as `frame_dict` makes it of the views."""
    views = tuple(view for view in ALL if view != "normals")
    frames = write_noise(tmp_path / "bag", 3, views=views)
    with Agent.from_recording(tmp_path / "bag") as agent:
        assert (agent.id, len(agent), agent.views) == ("eye", 3, views)
        for frame in frames:
            expected = frame.to_dict()
            read = agent.get_frame()
            np.testing.assert_allclose(
                read["world_from_camera"], expected["world_from_camera"], rtol=0, atol=1e-12
            )
            assert expected["camera"].intrinsics == read["camera"].intrinsics
            for name in ("world_from_camera", "camera"):
                expected[name] = read[name]
            same_dict(read, expected)
            read["main"][:] = 0  # the caller's own
        with pytest.raises(RecordingError, match=r"no frame after its 3; seek\(0\)"):
            agent.get_frame()
        agent.seek(0)
        assert agent.get_frame()["main"].any()
        assert agent.instances[2].moving
        assert (agent.categories[3], agent.categories[9]) == ("chair", "lamp")
        assert (agent.scene, agent.scenes) == ("noise", ["noise", "other"])
        assert agent.save_contact_sheet(tmp_path / "sheet.png", agent[0]).stat().st_size > 0


def test_frames_are_found_by_number_and_by_time(tmp_path: Path) -> None:
    """Negative numbers count from the end; a time gives the last frame before it."""
    write_noise(tmp_path / "bag", 5)
    with RecordedAgent(tmp_path / "bag") as agent:
        assert [frame["sequence"] for frame in agent] == [1, 2, 3, 4, 5]
        assert [frame["sequence"] for frame in agent[3:]] == [4, 5]
        assert agent[-1]["sequence"] == 5
        assert agent.frame_at(2 * DT_NS * 1e-9)["sequence"] == 3
        assert agent.frame_at(2.9 * DT_NS * 1e-9)["sequence"] == 3
        assert agent.frame_at(100.0)["sequence"] == 5
        with pytest.raises(RecordingError, match=r"at or before -1 s"):
            agent.frame_at(-1.0)
        for time_s in (float("nan"), float("inf"), "soon"):
            with pytest.raises(InvalidRequest, match="time_s must be a finite number"):
                agent.frame_at(time_s)  # type: ignore[arg-type]  # on purpose
        for wrong in (5, -6):
            with pytest.raises(IndexError):
                agent[wrong]
        with pytest.raises(InvalidRequest, match="integer"):
            agent.seek("first")  # type: ignore[arg-type]  # what is to be refused


def test_a_scene_that_begins_anew_is_recorded_behind_itself(tmp_path: Path) -> None:
    """Two epochs whose times overlap stay apart, and each frame finds its own scene_info."""
    frames = [noise_frame(number) for number in range(1, 4)]
    again = [noise_frame(n, stamp_ns=(n - 4) * DT_NS, epoch=2) for n in range(4, 7)]
    with RecordingWriter(tmp_path / "bag") as writer:
        recorder = FrameRecorder(writer)
        for epoch, part in ((1, frames), (2, again)):
            recorder.write_info(noise_info(epoch=epoch))
            for frame in part:
                recorder.write_frame(frame, 10.0)
    with RecordingReader(tmp_path / "bag") as reader:
        read = RecordedFrames(reader)
        assert [frame.sequence for frame in read] == [1, 2, 3, 4, 5, 6]
        assert list(read.stamps_ns) == [0, DT_NS, 2 * DT_NS] * 2
        assert [read.scene_info(n).epoch for n in range(6)] == [1, 1, 1, 2, 2, 2]  # type: ignore[union-attr]
        assert read.index_at(0.0) == 3


def test_several_agents_are_told_apart(tmp_path: Path) -> None:
    """With more than one agent the one that is meant has to be named."""
    with RecordingWriter(tmp_path / "bag") as writer:
        recorder = FrameRecorder(writer)
        for number in (1, 2):
            recorder.write_frame(noise_frame(number, agent="left"), 7.5)
            recorder.write_frame(noise_frame(number, agent="right", views=("rgb",)), 10.0)
    with pytest.raises(UnknownName, match="one of: left, right"):
        RecordedAgent(tmp_path / "bag")
    with RecordedAgent(tmp_path / "bag", "right") as agent:
        assert agent.views == ("rgb",)
        assert [frame["sequence"] for frame in agent] == [1, 2]
        # No scene_info: the camera_info tells of the lens, but for rounding, the same.
        expected = noise_frame(1).camera.intrinsics.K
        np.testing.assert_allclose(agent[0]["K"], expected, rtol=1e-12)
        assert (agent.instances, agent.categories, agent.scene) == ({}, {}, "")
    with RecordingReader(tmp_path / "bag") as reader:
        assert {frame.depth_range_m for frame in RecordedFrames(reader, "left")} == {7.5}


def test_a_frame_without_all_its_images_is_passed_over(tmp_path: Path) -> None:
    """An info whose image was not recorded gives no frame, and is counted."""
    from sailenv_ros.recording.channels import agent_topics, frame_messages

    with RecordingWriter(tmp_path / "bag") as writer:
        for topic in agent_topics("/sailenv", "eye", ("rgb", "depth")):
            writer.add_topic(topic)
        for number in (1, 2, 3):
            for name, parts in frame_messages(noise_frame(number, views=("rgb", "depth")), 10.0):
                if (number, name) != (2, "depth"):
                    writer.write(f"/sailenv/eye/{name}", parts, 100 * number)
    with RecordingReader(tmp_path / "bag") as reader:
        read = RecordedFrames(reader)
        assert [frame.sequence for frame in read] == [1, 3]
        assert read.incomplete == 1


def foreign_file(path: Path, **settings: Any) -> None:
    """Write what another program could: unlike ours in every way that the format allows."""
    with path.open("wb") as stream:
        writer = Writer(stream, chunk_size=300, **settings)
        writer.start(profile="ros2", library="another")
        schema = writer.register_schema("std_msgs/msg/String", "ros2msg", b"string data\n")
        cdr = writer.register_channel("/chat", "cdr", schema)
        other = writer.register_channel("/numbers", "json", schema)
        for number in range(20):
            writer.add_message(other, number, b"{}", number)
            text = f"{number:03}".encode()
            data = b"\0\1\0\0\4\0\0\0" + text + b"\0"
            writer.add_message(cdr, 1000 - 10 * number, data, 5 * number, sequence=number)
        writer.finish()


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {"use_chunking": False},
        {"compression": CompressionType.LZ4, "index_types": IndexType.NONE},
        {"compression": CompressionType.NONE, "index_types": IndexType.CHUNK},
        {"use_statistics": False},
        {"repeat_channels": False, "repeat_schemas": False},
        {"use_summary_offsets": False, "enable_crcs": False},
    ],
)
def test_other_programs_files_are_read(tmp_path: Path, settings: dict[str, Any]) -> None:
    """With chunks and without, with and without indexes; what is not CDR is left out."""
    foreign_file(tmp_path / "other.mcap", **settings)
    with RecordingReader(tmp_path / "other.mcap") as reader:
        assert [topic.name for topic in reader.topics] == ["/chat"]
        assert reader.topic("/chat").schema == "string data\n"
        read = [(m.log_ns, m.publish_ns, bytes(m.data)[8:11]) for _, m in reader.messages()]
        expected = [(1000 - 10 * n, 5 * n, f"{n:03}".encode()) for n in reversed(range(20))]
        assert read == expected
        some = reader.messages(["/chat"], start_ns=900, end_ns=930)
        assert [m.sequence for _, m in some] == [10, 9, 8, 7]
        assert (reader.start_ns, reader.end_ns, len(reader)) == (810, 1000, 20)
        with pytest.raises(UnknownName, match="/chat"):
            reader.topic("/chap")
        with pytest.raises(RecordingError, match="no frames of an agent"):
            RecordedFrames(reader)


def test_what_is_no_recording_is_told(tmp_path: Path) -> None:
    """Paths that are not there, empty folders, other files, files that were not finished."""
    with pytest.raises(RecordingError, match="is not there"):
        RecordingReader(tmp_path / "nothing")
    with pytest.raises(RecordingError, match="has no MCAP file"):
        RecordingReader(tmp_path)
    (tmp_path / "text.mcap").write_text("a text, not a recording")
    with pytest.raises(RecordingError, match="no MCAP file"):
        RecordingReader(tmp_path / "text.mcap")
    write_noise(tmp_path / "bag", 2)
    whole = (tmp_path / "bag/bag_0.mcap").read_bytes()
    cut = tmp_path / "cut.mcap"
    for size in (8, 9, 100, len(whole) // 2, len(whole) - 1):
        cut.write_bytes(whole[:size])
        with pytest.raises(RecordingError, match=r"damaged.*`sailenv bag recover .*cut\.mcap`"):
            RecordingReader(cut)


def test_a_flipped_bit_is_never_read_as_data(tmp_path: Path) -> None:
    """Wherever one byte is changed, the file is refused, or reading it is, or all is as it was."""
    write_noise(tmp_path / "bag", 2, RecordingOptions(chunk_bytes=4000), views=("category",))
    whole = (tmp_path / "bag/bag_0.mcap").read_bytes()
    shutil.rmtree(tmp_path / "bag")
    path = tmp_path / "a.mcap"

    def read() -> list[bytes]:
        with RecordingReader(path) as reader:
            return [bytes(message.data) for _, message in reader.messages()]

    path.write_bytes(whole)
    intact = read()
    refused = 0
    for at in [*range(0, len(whole) - 60, 47), *range(len(whole) - 60, len(whole))]:
        path.write_bytes(whole[:at] + bytes([whole[at] ^ 0x10]) + whole[at + 1 :])
        try:
            assert read() == intact
        except RecordingError:
            refused += 1
    assert refused > 300


def test_recordings_without_states_are_read(tmp_path: Path) -> None:
    """Version 0.2.0 knew no states: its frames have none, and are complete otherwise."""
    frames = [replace(noise_frame(number), states=None) for number in (1, 2)]
    with RecordingWriter(tmp_path / "bag") as writer:
        recorder = FrameRecorder(_WithoutStates(writer))  # type: ignore[arg-type]
        recorder.write_info(noise_info())
        for frame in frames:
            recorder.write_frame(frame, 10.0)
    with RecordingReader(tmp_path / "bag") as reader:
        assert "has_states" not in reader.topic("/sailenv/eye/frame_info").schema
        read = list(RecordedFrames(reader))
    assert [frame.states for frame in read] == [None, None]
    assert [frame.sequence for frame in read] == [1, 2]
    assert read[1]["flow"].tobytes() == frames[1]["flow"].tobytes()
    assert read[1].timings_s["render"] == frames[1].timings_s["render"]


class _WithoutStates:
    """Writes definition and bytes of `FrameInfo` as they were before it had states."""

    def __init__(self, writer: RecordingWriter) -> None:
        self._writer = writer

    def add_topic(self, topic: Any) -> None:
        if topic.type.endswith("FrameInfo"):
            first, _, rest = topic.schema.partition("bool has_states")
            old = first + rest[rest.index("=" * 10) :]
            topic = replace(topic, schema=old)
        self._writer.add_topic(topic)

    def write(self, topic: str, parts: Any, log_ns: int) -> None:
        if topic.endswith("frame_info"):
            # A false, three bytes that fill up, three empty arrays, two empty texts with three
            # bytes between them, bytes up to a multiple of eight, a number of eight bytes, and
            # two empty arrays.
            (data,) = parts
            header, empty_text = 4, 5
            end = len(bytes(data).rstrip(b"\0")) + empty_text - 1
            assert len(data) == header + -(-(end - header) // 8) * 8 + 8 + 4 + 4
            data = data[:end]
            assert data[-29] == 0
            assert not any(data[-25:-13])
            assert bytes(data[-13:]) == b"\x01\0\0\0\0" + bytes(3) + b"\x01\0\0\0\0"
            parts = (data[:-29],)
        self._writer.write(topic, parts, log_ns)
