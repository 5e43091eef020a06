"""The recorder node over real DDS: what a live agent saw, byte for byte, and nothing in silence."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from rosbags.rosbag2 import Reader
from rosgraph_msgs.msg import Clock
from std_srvs.srv import Trigger

from sailenv_msgs.msg import FrameInfo
from sailenv_ros import Agent
from sailenv_ros.errors import RecordingError
from sailenv_ros.recording.bag_recovery import recover
from sailenv_ros.recording.frames import RecordedFrames
from sailenv_ros.recording.reader import RecordingReader
from tests.support.ros_probe import BEST_EFFORT, Probe
from tests.support.sim_node_process import NodeProcess
from tests.support.tool_process import ToolProcess, run_several
from tests.support.waiting import until
from tests.unit.recording.test_reader import same_dict

pytestmark = [pytest.mark.ros, pytest.mark.gl]

NAMESPACE = "/recorded"


@pytest.fixture(scope="module")
def node() -> Iterator[NodeProcess]:
    """A lockstep simulator without an agent."""
    with NodeProcess(NAMESPACE, scene="optical", mode="lockstep", agent__name="") as node:
        yield node


def recorder(output: Path, **parameters: object) -> ToolProcess:
    settings = {"output": str(output), "progress_interval_s": 0.2, **parameters}
    return ToolProcess("recorder", NAMESPACE, "Ctrl-C ends it", **settings)


def counts(process: ToolProcess) -> list[int]:
    """Return the number of frames of each line of progress."""
    told = [line for line in process.lines if " frames (" in line]
    return [int(line.split(" frames (")[0].split()[-1]) for line in told]


def recorded(process: ToolProcess) -> int:
    """Return the number of frames of the latest line of progress."""
    return (counts(process) or [0])[-1]


def test_a_recording_gives_what_the_live_agent_saw(node: NodeProcess, tmp_path: Path) -> None:
    """Every frame of the recording is the dict that `get_frame` gave, byte for byte."""
    live: dict[int, dict[str, Any]] = {}
    bag = tmp_path / "bag"
    with (
        Agent(width=64, height=48, name="eye", namespace=NAMESPACE) as agent,
        recorder(bag, views=["rgb", "depth", "category", "instance", "flow"]) as process,
    ):
        instances, categories = agent.instances, agent.categories

        def seen() -> bool:
            agent.step(8)
            frame = agent.get_frame()
            live[frame["sequence"]] = frame
            return recorded(process) >= 3

        until(seen, "frames to be recorded")
        for _ in range(6):
            seen()
        first = agent.get_frame()  # of the same instant as the one before: told apart all the same
        last = agent.get_frame()
        live.update({first["sequence"]: first, last["sequence"]: last})
        lines = len(counts(process))

        def rests() -> bool:
            """Five lines from now on say the same: in a second no other frame was taken."""
            later = counts(process)[lines:]
            return len(later) >= 5 and len(set(later[-5:])) == 1

        until(rests, "the last frames to be taken")
        assert process.end() == 0, process.log
    assert process.said("dropped 0")
    with Agent.from_recording(bag) as read:
        frames = [read.get_frame() for _ in range(len(read))]
        assert read.instances == instances
        assert read.categories == categories
        assert read.scene == "optical"
    numbers = [frame["sequence"] for frame in frames]
    assert numbers == list(range(numbers[0], last["sequence"] + 1))
    assert len(numbers) >= 8
    for frame in frames:
        if frame["sequence"] in live:
            same_dict(frame, live[frame["sequence"]])
    with Reader(bag) as other:
        assert other.message_count == sum(1 for _ in other.messages())


def test_amodal_masks_are_kept_with_their_frames(node: NodeProcess, tmp_path: Path) -> None:
    """Of each frame that has them, its own: those that the live frame had."""
    bag = tmp_path / "bag"
    live = {}
    with (
        Agent(width=64, height=48, name="whole", namespace=NAMESPACE) as agent,
        recorder(bag, agents=["whole"], amodal=True, clock=False) as process,
    ):

        def seen() -> bool:
            agent.step(8)
            frame = agent.capture()
            live[frame.sequence] = frame.amodal
            return recorded(process) >= 4

        until(seen, "frames to be recorded")
        assert process.end() == 0, process.log
    with RecordingReader(bag) as reader:
        read = [frame for frame in RecordedFrames(reader) if frame.draw_amodal is not None]
        assert read
        for frame in read:
            kept = live[frame.sequence]
            assert kept.pixels.tolist() == frame.amodal.pixels.tolist()
            for id_ in kept.ids.tolist():
                assert (frame.amodal.mask(id_) == kept.mask(id_)).all()


def test_an_agent_that_is_not_meant_is_left_out(node: NodeProcess, tmp_path: Path) -> None:
    """Only the agents and views that were named are recorded, and no other is rendered for it."""
    bag = tmp_path / "bag"
    with (
        Agent(width=32, height=24, name="one", namespace=NAMESPACE) as one,
        Agent(width=32, height=24, name="two", namespace=NAMESPACE) as two,
        recorder(bag, agents=["two"], views=["rgb"], clock=False) as process,
    ):

        def seen() -> bool:
            one.step(8)
            one.get_frame()
            two.get_frame()
            return recorded(process) >= 3

        until(seen, "frames to be recorded")
        assert process.end(signal.SIGTERM) == 0, process.log
    with RecordingReader(bag) as reader:
        assert {topic.name for topic in reader.topics} == {f"{NAMESPACE}/scene_info"} | {
            f"{NAMESPACE}/two/{name}" for name in ("rgb", "camera_info", "frame_info", "pose")
        }


def test_a_killed_recorder_leaves_what_can_be_restored(node: NodeProcess, tmp_path: Path) -> None:
    """After kill -9 the bag is refused by the name of the command that restores it."""
    bag = tmp_path / "bag"
    with (
        Agent(width=320, height=240, name="eye", namespace=NAMESPACE) as agent,
        recorder(bag) as process,
    ):

        def seen() -> bool:
            agent.step(8)
            agent.get_frame()
            return recorded(process) >= 5

        until(seen, "frames to be recorded")
        assert process.end(signal.SIGKILL) == -signal.SIGKILL
    with pytest.raises(RecordingError, match="sailenv bag recover"):
        Agent.from_recording(bag)
    recover(bag)
    with Agent.from_recording(bag) as read:
        assert len(read) >= 3
        # The recorder finds topics one by one: the first frame may have come before the picture's.
        frames = [read[number] for number in range(len(read))]
        assert {one["main"].shape for one in frames if "main" in one} == {(240, 320, 3)}


def test_what_cannot_be_written_is_told_at_once(node: NodeProcess, tmp_path: Path) -> None:
    """An existing bag, a wrong name, an unknown parameter: status 2 and one sentence."""
    (tmp_path / "bag").mkdir()
    refused: tuple[tuple[dict[str, object], str], ...] = (
        ({"output": str(tmp_path / "bag")}, "exists already"),
        ({"output": str(tmp_path / "b"), "views": ["rgbd"]}, "did you mean 'rgb'"),
        ({"output": str(tmp_path / "c"), "outpt": "x"}, "did you mean 'output'"),
        ({"output": "/proc/bag"}, "cannot be made"),
    )
    runs = run_several("recorder", NAMESPACE, *(parameters for parameters, _ in refused))
    for (_, sentence), (status, log) in zip(refused, runs, strict=True):
        assert status == 2
        assert sentence in log


def test_a_recording_begins_when_it_begins(node: NodeProcess, tmp_path: Path) -> None:
    """The scene was announced when the simulator started; in the bag it stands at its start."""
    began_ns = time.time_ns()
    bag = tmp_path / "bag"
    with recorder(bag) as process:
        until(lambda: recorded_messages(process), "the scene to be taken")
        assert process.end() == 0, process.log
    with RecordingReader(bag) as read:
        assert read.start_ns >= began_ns


def recorded_messages(process: ToolProcess) -> bool:
    """Return whether a line of progress tells of bytes."""
    return any(" MB" in line and " 0.0 MB" not in line for line in process.lines) or (
        sum(" frames (" in line for line in process.lines) >= 8
    )


def test_without_a_simulator_the_status_says_so(tmp_path: Path) -> None:
    """Nothing was recorded: 1, and a sentence."""
    settings = {"output": str(tmp_path / "bag"), "progress": False}
    with ToolProcess("recorder", "/nobody_is_here", "Ctrl-C ends it", **settings) as process:
        assert process.end() == 1
    assert process.said("no simulator was heard in /nobody_is_here")


def test_a_simulator_of_another_namespace_does_not_count(tmp_path: Path) -> None:
    """Its /clock is everybody's, and a recording of nothing else is none."""
    settings = {"output": str(tmp_path / "bag"), "progress": False}
    with (
        NodeProcess("/elsewhere", publish_clock=True),
        ToolProcess("recorder", "/nobody_is_here", "Ctrl-C ends it", **settings) as process,
        Probe("/clock_probe") as probe,
    ):
        ticks = probe.listen(Clock, "/clock", BEST_EFFORT)
        until(lambda: probe.node.count_subscribers("/clock") == 2, "the recorder to subscribe")
        until(lambda: len(ticks.messages) >= 20, "the clock to tick")
        assert process.end() == 1
    assert process.said("no simulator was heard in /nobody_is_here")
    with RecordingReader(tmp_path / "bag") as read:
        assert {topic.name for topic, _ in read.messages()} == {"/clock"}


def test_a_killed_simulator_is_told(tmp_path: Path) -> None:
    """What it sent is kept, the status is 1; one that ends by itself is no failure."""
    for number, status in ((signal.SIGKILL, 1), (signal.SIGTERM, 0)):
        settings = {"output": str(tmp_path / f"bag_{status}"), "progress_interval_s": 0.1}
        with (
            NodeProcess("/killed", scene="optical", agent__width=32, agent__height=24) as simulator,
            ToolProcess("recorder", "/killed", "Ctrl-C ends it", **settings) as process,
        ):
            until(lambda p=process: recorded(p) >= 3, "frames to be recorded")
            simulator.signal(number)
            until(lambda s=simulator: not s.alive, "its end")
            if status:
                until(lambda p=process: p.said("/killed was killed"), "the recorder to notice")
            assert process.end() == status, process.log
        with RecordingReader(tmp_path / f"bag_{status}") as read:
            assert len(read)


def test_the_last_frame_of_a_simulator_that_ends_is_recorded(tmp_path: Path) -> None:
    """It waits for a recorder that is behind, so that its topics do not go before their images."""
    settings = {"output": str(tmp_path / "bag"), "progress_interval_s": 0.1}
    with (
        NodeProcess("/ending", scene="optical", agent__width=32, agent__height=24) as simulator,
        ToolProcess("recorder", "/ending", "Ctrl-C ends it", **settings) as process,
        Probe("/ending") as probe,
    ):
        infos = probe.listen(FrameInfo, "agent/frame_info")
        until(lambda: recorded(process) >= 3 and infos.messages, "frames to be recorded")
        os.kill(process.pid, signal.SIGSTOP)
        heard = len(infos.messages)
        until(lambda: len(infos.messages) >= heard + 5, "frames that are not recorded yet")
        simulator.signal(signal.SIGTERM)
        capture = "/ending/agent/capture"
        until(lambda: capture not in services(probe), "the agent's services to go")
        os.kill(process.pid, signal.SIGCONT)
        until(lambda: not simulator.alive, "its end")
        assert process.end() == 0, process.log
    with Agent.from_recording(tmp_path / "bag") as read:
        assert read[len(read) - 1]["sequence"] == infos.last.sequence


def services(probe: Probe) -> set[str]:
    return {name for name, _ in probe.node.get_service_names_and_types()}


def test_snapshots_are_written_on_request(tmp_path: Path) -> None:
    """By the service and by a signal; each is a recording that an Agent can be read from."""
    settings = {"output": str(tmp_path / "bag"), "snapshot_s": 2.0, "progress_interval_s": 0.1}
    with (
        NodeProcess("/snapped", scene="optical", agent__width=32, agent__height=24),
        ToolProcess("recorder", "/snapped", "Ctrl-C ends it", **settings) as process,
        Probe("/snapped") as probe,
    ):
        until(lambda: recorded(process) >= 10, "frames to be kept")
        assert not list(tmp_path.iterdir())
        answer = probe.call(Trigger, "recorder/snapshot", Trigger.Request())
        assert answer.success
        assert answer.message == str(tmp_path / "bag_0")
        os.kill(process.pid, signal.SIGUSR1)
        until(lambda: process.said(f"wrote {tmp_path / 'bag_1'}"), "the second snapshot")
        assert process.end() == 0, process.log
    for number in range(2):
        with Agent.from_recording(tmp_path / f"bag_{number}") as read:
            assert len(read) >= 3
            assert read.scene == "optical"
            assert read.get_frame()["main"].shape == (24, 32, 3)
