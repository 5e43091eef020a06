"""The player node over real DDS: the recorded bytes on the recorded topics, and a clock."""

from __future__ import annotations

import shutil
from itertools import pairwise
from pathlib import Path

import pytest
from mcap.writer import Writer
from rclpy.serialization import deserialize_message, serialize_message
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import String
from std_srvs.srv import Trigger

from sailenv_msgs.msg import FrameInfo, SceneInfo
from sailenv_msgs_py.stamps import ns_from_stamp
from sailenv_ros.recording.reader import RecordingReader
from tests.support.recordings import DT_NS, write_noise
from tests.support.ros_probe import BEST_EFFORT, LATCHED, Probe
from tests.support.tool_process import ToolProcess, run_several
from tests.support.waiting import until

pytestmark = pytest.mark.ros

NAMESPACE = "/sailenv"
COUNT = 6


def player(path: Path, **parameters: object) -> ToolProcess:
    settings = {"input": str(path), "paused": True, "delay_s": 0.0, **parameters}
    return ToolProcess("player", "/", "hold it", **settings)


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("played") / "bag"
    write_noise(folder, COUNT)
    return folder


def heard(probe: Probe) -> dict[str, object]:
    """Subscribe to everything of the recording."""
    return {
        "rgb": probe.listen(Image, "eye/rgb"),
        "flow": probe.listen(Image, "eye/flow"),
        "camera_info": probe.listen(CameraInfo, "eye/camera_info"),
        "frame_info": probe.listen(FrameInfo, "eye/frame_info"),
        "scene_info": probe.listen(SceneInfo, "scene_info", LATCHED),
        "/clock": probe.listen(Clock, "/clock", BEST_EFFORT),
    }


def all_matched(probe: Probe) -> bool:
    """Return whether every subscription has found its publisher."""
    topics = [f"{NAMESPACE}/eye/{name}" for name in ("rgb", "flow", "camera_info", "frame_info")]
    return all(probe.node.count_publishers(topic) for topic in [*topics, "/clock"])


def test_every_message_comes_back_as_it_was_recorded(bag: Path) -> None:
    """The same messages on the same topics with their own stamps; /clock tells those stamps."""
    with player(bag, rate=10.0) as process, Probe(NAMESPACE) as probe:
        topics = heard(probe)
        until(lambda: all_matched(probe), "the player's topics")
        until(lambda: topics["scene_info"].messages == [], "nothing while paused")  # type: ignore[attr-defined]
        answer = probe.call(Trigger, "/player/resume")
        assert answer.success
        until(
            lambda: all(
                len(topics[name].messages) >= COUNT  # type: ignore[attr-defined]
                for name in ("rgb", "flow", "camera_info", "frame_info")
            ),
            "all frames",
        )
        until(lambda: topics["scene_info"].messages, "the scene_info")  # type: ignore[attr-defined]
        assert process.status() == 0, process.log
        with RecordingReader(bag) as reader:
            for name in ("rgb", "flow", "camera_info", "frame_info"):
                sent = [m for _, m in reader.messages([f"{NAMESPACE}/eye/{name}"])]
                read = topics[name].messages  # type: ignore[attr-defined]
                assert read == [deserialize_message(bytes(m.data), type(read[0])) for m in sent]
    clocks = [ns_from_stamp(message.clock) for message in topics["/clock"].messages]  # type: ignore[attr-defined]
    assert clocks == sorted(set(clocks))
    assert set(clocks) <= {number * DT_NS for number in range(COUNT)}
    assert clocks


def test_it_can_be_paused_and_looped(bag: Path) -> None:
    """While paused nothing comes; a loop begins anew; it ends when asked to."""
    with player(bag, rate=2.0, loop=True) as process, Probe(NAMESPACE) as probe:
        infos = probe.listen(FrameInfo, "eye/frame_info")
        until(
            lambda: probe.node.count_publishers(f"{NAMESPACE}/eye/frame_info"), "the player's topic"
        )
        probe.call(Trigger, "/player/resume")
        until(lambda: len(infos.messages) > 2 * COUNT, "the third round")
        assert probe.call(Trigger, "/player/pause").success
        numbers = [message.sequence for message in infos.messages]
        assert {(b - a) % COUNT for a, b in pairwise(numbers)} == {1}
        before = len(infos.messages)
        # Another service of the same thread answers, so that whatever was on its way has come.
        probe.call(Trigger, "/player/pause")
        probe.call(Trigger, "/player/resume")
        until(lambda: len(infos.messages) > before + COUNT, "the next round")
        assert process.end() == 0, process.log


def test_a_start_offset_and_chosen_topics(bag: Path) -> None:
    """From an offset on, only those topics, and no clock if none is wanted."""
    topic = f"{NAMESPACE}/eye/frame_info"
    start = (2 * DT_NS + DT_NS // 2) * 1e-9
    with (
        player(bag, start_s=start, topics=[topic], clock=False) as process,
        Probe(NAMESPACE) as probe,
    ):
        infos = probe.listen(FrameInfo, "eye/frame_info")
        until(lambda: probe.node.count_publishers(topic), "the player's topic")
        assert probe.node.count_publishers("/clock") == 0
        assert probe.node.count_publishers(f"{NAMESPACE}/eye/rgb") == 0
        probe.call(Trigger, "/player/resume")
        assert process.status() == 0, process.log
        until(lambda: len(infos.messages) == COUNT - 3, "the rest")
    assert [message.sequence for message in infos.messages] == [4, 5, 6]


def test_a_file_of_python_mcap_alone_is_played(tmp_path: Path) -> None:
    """What never saw this package or ROS is published all the same; unknown types are named."""
    path = tmp_path / "foreign.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start(profile="ros2", library="another")
        known = writer.register_schema("std_msgs/msg/String", "ros2msg", b"string data\n")
        other = writer.register_schema("no_such_msgs/msg/Thing", "ros2msg", b"int8 a\n")
        chat = writer.register_channel("/chat", "cdr", known)
        thing = writer.register_channel("/thing", "cdr", other)
        for number in range(5):
            data = serialize_message(String(data=f"word {number}"))
            writer.add_message(chat, number * 10_000_000, data, number * 10_000_000)
            writer.add_message(thing, number * 10_000_000, b"\0\1\0\0\1", number)
        writer.finish()
    with player(path) as process, Probe("/") as probe:
        chat_heard = probe.listen(String, "/chat")
        until(lambda: probe.node.count_publishers("/chat"), "the player's topic")
        probe.call(Trigger, "/player/resume")
        assert process.status() == 0, process.log
        until(lambda: len(chat_heard.messages) == 5, "all words")
    assert [message.data for message in chat_heard.messages] == [f"word {n}" for n in range(5)]
    assert process.said("/thing is not played: message type no_such_msgs/msg/Thing")


def test_what_cannot_be_played_is_told_at_once(bag: Path, tmp_path: Path) -> None:
    """No file, a damaged file, an unknown topic, a rate out of range: status 2 and a sentence."""
    copy = tmp_path / "cut"
    shutil.copytree(bag, copy)
    cut = copy / "bag_0.mcap"
    cut.write_bytes(cut.read_bytes()[:-100])
    refused: tuple[tuple[dict[str, object], str], ...] = (
        ({}, "parameter input must be"),
        ({"input": str(tmp_path / "none")}, "is not there"),
        ({"input": str(copy)}, "sailenv bag recover"),
        ({"input": str(bag), "topics": ["/sailenv/eye/rbg"]}, "did you mean"),
        ({"input": str(bag), "rate": 0.0}, "rate must be"),
        ({"input": str(bag), "start_s": 99.0}, "start must be from 0"),
    )
    runs = run_several("player", "/", *(parameters for parameters, _ in refused))
    for (_, sentence), (status, log) in zip(refused, runs, strict=True):
        assert status == 2
        assert sentence in log
