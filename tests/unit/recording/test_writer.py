"""Bags as other programs read them: rosbags by metadata.yaml, mcap-ros2-support by the schemas."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.msg import get_types_from_msg

from sailenv_ros.errors import InvalidRequest, RecordingError, UnknownName
from sailenv_ros.recording.lockstep import FrameRecorder
from sailenv_ros.recording.schemas import schema_text
from sailenv_ros.recording.topics import OfferedQos, RecordedTopic, RecordingOptions, qos_of_yaml
from sailenv_ros.recording.writer import RecordingWriter
from sailenv_ros.types.views import VIEWS
from tests.support.recordings import file_size_limit, noise_frame, noise_info, write_noise

pytestmark = pytest.mark.ros

ALL = tuple(VIEWS)
NOTE = RecordedTopic(name="/note", type="std_msgs/msg/String", schema="string data\n")


def pixels(view: str, message: Any) -> Any:
    spec = VIEWS[view]
    stored = np.uint8 if spec.dtype == np.bool_ else spec.dtype
    flat = np.frombuffer(bytes(message.data), stored)
    return flat.reshape(spec.shape(message.height, message.width))


def same_pixels(view: str, message: Any, frame: Any) -> None:
    values = frame[view]
    if values.dtype == np.bool_:
        values = values.astype(np.uint8) * 255
    assert pixels(view, message).tobytes() == values.tobytes()
    assert message.encoding == VIEWS[view].encoding


@pytest.mark.parametrize("compression", ["zstd", "lz4", "none"])
def test_mcap_ros2_support_reads_what_we_write(tmp_path: Path, compression: Any) -> None:
    """Every message of every view decodes by the file's own schemas to the frame's values."""
    options = RecordingOptions(compression=compression)
    frames = write_noise(tmp_path / "bag", 3, options, views=ALL)
    seen = dict.fromkeys(ALL, 0)
    infos = []
    with (tmp_path / "bag/bag_0.mcap").open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        for _, channel, _, decoded in reader.iter_decoded_messages():
            name = channel.topic.rsplit("/", 1)[1]
            if name in seen:
                same_pixels(name, decoded, frames[seen[name]])
                seen[name] += 1
            elif name == "frame_info":
                infos.append(decoded)
            elif name == "scene_info":
                assert [instance.name for instance in decoded.instances] == ["chair_1", "lamp_1"]
    assert set(seen.values()) == {3}
    assert [info.sequence for info in infos] == [1, 2, 3]
    assert [tuple(info.views) for info in infos] == [ALL] * 3
    assert infos[1].camera_pose.position.x == frames[1].camera.pose.position_m[0]


def test_rosbags_reads_what_we_write(tmp_path: Path) -> None:
    """The bag folder opens by its metadata.yaml; images and our own messages come out right."""
    frames = write_noise(tmp_path / "bag", 4)
    store = get_typestore(Stores.ROS2_JAZZY)
    for kind in ("FrameInfo", "SceneInfo"):
        name = f"sailenv_msgs/msg/{kind}"
        store.register(get_types_from_msg(schema_text(name), name))
    depths = infos = 0
    with Reader(tmp_path / "bag") as reader:
        assert reader.message_count == 1 + 4 * 8
        assert {c.topic for c in reader.connections} >= {"/sailenv/eye/rgb", "/sailenv/scene_info"}
        for connection, _, raw in reader.messages():
            message = store.deserialize_cdr(raw, connection.msgtype)
            if connection.topic.endswith("/depth"):
                same_pixels("depth", message, frames[depths])
                depths += 1
            if connection.topic.endswith("/frame_info"):
                infos += 1
                assert message.sequence == infos
    assert (depths, infos) == (4, 4)


def test_metadata_says_what_the_files_hold(tmp_path: Path) -> None:
    """metadata.yaml has rosbag2's version 9, and its quality of service is each channel's own."""
    write_noise(tmp_path / "bag", 3)
    text = (tmp_path / "bag/metadata.yaml").read_text()
    bag = yaml.safe_load(text)["rosbag2_bagfile_information"]
    assert "&id" not in text
    assert (bag["version"], bag["storage_identifier"]) == (9, "mcap")
    assert bag["message_count"] == 25
    assert bag["relative_file_paths"] == ["bag_0.mcap"]
    assert bag["duration"]["nanoseconds"] == 2 * 33_333_333
    topics = {t["topic_metadata"]["name"]: t for t in bag["topics_with_message_count"]}
    assert topics["/sailenv/eye/rgb"]["message_count"] == 3
    with (tmp_path / "bag/bag_0.mcap").open("rb") as stream:
        reader = make_reader(stream)
        channels = reader.get_summary().channels.values()
        (embedded,) = [record for record in reader.iter_metadata() if record.name == "rosbag2"]
    for channel in channels:
        told = topics[channel.topic]["topic_metadata"]
        assert (
            yaml.safe_load(channel.metadata["offered_qos_profiles"])
            == (told["offered_qos_profiles"])
        )
        assert channel.metadata["topic_type_hash"] == told["type_description_hash"]
        assert told["type_description_hash"].startswith("RIHS01_")
    within = yaml.safe_load(embedded.metadata["serialized_metadata"])
    assert within["rosbag2_bagfile_information"]["message_count"] == 25


@pytest.mark.parametrize(
    ("options", "least"),
    [(RecordingOptions(split_bytes=30_000, compression="none", chunk_bytes=9000), 4),
     (RecordingOptions(split_s=0.1), 3)],
)  # fmt: skip
def test_split_files_are_one_bag(tmp_path: Path, options: RecordingOptions, least: int) -> None:
    """Split by size or time, each file is whole by itself and together nothing is missing."""
    write_noise(tmp_path / "bag", 10, options)
    files = sorted((tmp_path / "bag").glob("*.mcap"))
    assert len(files) >= least
    count = 0
    for path in files:
        with path.open("rb") as stream:
            count += sum(1 for _ in make_reader(stream, validate_crcs=True).iter_messages())
    assert count == 1 + 10 * 8
    with Reader(tmp_path / "bag") as reader:
        assert sum(1 for _ in reader.messages()) == reader.message_count == count


def test_an_existing_bag_is_never_overwritten(tmp_path: Path) -> None:
    """A second recording of the same name is refused, and the first is as it was."""
    write_noise(tmp_path / "bag", 1)
    before = (tmp_path / "bag/bag_0.mcap").read_bytes()
    with pytest.raises(RecordingError, match=r"exists already.*another name"):
        RecordingWriter(tmp_path / "bag")
    assert (tmp_path / "bag/bag_0.mcap").read_bytes() == before


def test_a_folder_that_cannot_be_made_is_told(tmp_path: Path) -> None:
    """A path below a file cannot be a bag; the error says why."""
    (tmp_path / "file").write_text("")
    with pytest.raises(RecordingError, match="cannot be made: Not a directory"):
        RecordingWriter(tmp_path / "file/bag")


def test_a_full_disk_ends_the_recording_readably(tmp_path: Path) -> None:
    """The writer says that the disk is full, counts what it lost, and leaves a readable bag."""
    frames = 0
    with file_size_limit(130_000):
        writer = RecordingWriter(
            tmp_path / "bag", RecordingOptions(compression="none", chunk_bytes=10_000)
        )
        recorder = FrameRecorder(writer)
        recorder.write_info(noise_info())
        with pytest.raises(RecordingError, match="disk is full"):  # noqa: PT012
            while True:
                recorder.write_frame(noise_frame(frames + 1), 10.0)
                frames += 1
        with pytest.raises(RecordingError, match="has ended"):
            recorder.write_info(noise_info())
        writer.close()
    statistics = writer.statistics
    with Reader(tmp_path / "bag") as reader:
        kept = sum(1 for _ in reader.messages())
        assert kept == reader.message_count
    assert kept + statistics.lost == statistics.messages
    assert kept > 8
    assert statistics.lost > 0


def test_a_file_that_cannot_be_begun_ends_the_recording_readably(tmp_path: Path) -> None:
    """When the next of split files is in the way of something, those before it are a whole bag."""
    writer = RecordingWriter(tmp_path / "bag", RecordingOptions(split_s=0.1))
    (tmp_path / "bag/bag_1.mcap").mkdir()
    recorder = FrameRecorder(writer)
    recorder.write_info(noise_info())
    with pytest.raises(  # noqa: PT012
        RecordingError, match=r"bag_1\.mcap cannot be written: File exists"
    ):
        for number in range(1, 10):
            recorder.write_frame(noise_frame(number), 10.0)
    writer.close()
    with Reader(tmp_path / "bag") as reader:
        assert sum(1 for _ in reader.messages()) == reader.message_count
        assert reader.message_count == writer.statistics.messages > 8


def test_a_file_without_room_for_its_head_is_not_left_behind(tmp_path: Path) -> None:
    """Where nothing at all can be written, there is an error and no stump of a file."""
    with file_size_limit(10), pytest.raises(RecordingError, match="disk is full"):
        RecordingWriter(tmp_path / "bag")
    assert list((tmp_path / "bag").iterdir()) == []


def test_a_topic_keeps_its_type(tmp_path: Path) -> None:
    """The same topic twice is one; with another type it is refused."""
    other = RecordedTopic(name="/note", type="std_msgs/msg/Bool", schema="bool data\n")
    with RecordingWriter(tmp_path / "bag") as writer:
        writer.add_topic(NOTE)
        writer.add_topic(NOTE)
        with pytest.raises(InvalidRequest, match="type of /note"):
            writer.add_topic(other)


def test_options_out_of_range_are_refused() -> None:
    """Each option says what it accepts."""
    with pytest.raises(UnknownName, match="zstd, lz4, none"):
        RecordingOptions(compression="gzip")  # type: ignore[arg-type]  # what is to be refused
    for wrong in ({"chunk_bytes": 0}, {"split_bytes": -1}, {"split_s": float("nan")}):
        with pytest.raises(InvalidRequest):
            RecordingOptions(**wrong)  # type: ignore[arg-type]  # what is to be refused


def test_quality_of_service_survives_its_text() -> None:
    """What a channel says of its quality of service is read back; older numbers too."""
    for qos in (OfferedQos(), OfferedQos(depth=1, durability="transient_local")):
        assert qos_of_yaml(qos.yaml()) == qos
    old = "- history: 1\n  depth: 7\n  reliability: 2\n  durability: 1\n"
    assert qos_of_yaml(old) == OfferedQos(
        depth=7, reliability="best_effort", durability="transient_local"
    )
    assert qos_of_yaml("") == OfferedQos()
