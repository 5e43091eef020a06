"""Lessons over DDS: the same as in process, in frames, on the topic and in a recording."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from std_msgs.msg import String

from sailenv_ros import Agent, Simulation
from sailenv_ros.errors import InvalidEntry, InvalidRequest, InvalidState
from sailenv_ros.recording.frames import RecordedFrames
from sailenv_ros.recording.lockstep import record_lockstep
from sailenv_ros.recording.reader import RecordingReader
from sailenv_ros.recording.writer import RecordingWriter
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.lessons import LessonState
from tests.support.probed_scene import agent_in_scene
from tests.support.ros_probe import LATCHED, Probe
from tests.support.waiting import until

pytestmark = pytest.mark.ros

CLASS = """
version: 1
gravity: [0, 0, 0]
objects:
  - {name: one, asset: cube, position: [1, 0, 1], scale: 0.4}
  - {name: two, asset: sphere, position: [1, 0, 1], scale: 0.4}
lessons:
  laps: 2
  sequence: [{objects: [one], duration: 0.1}, {objects: [two], duration: 0.1}]
"""


@pytest.fixture(scope="module")
def agent(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Agent]:
    folder = tmp_path_factory.mktemp("scenes")
    with agent_in_scene(folder, CLASS, "/lessons", backend="native") as agent:
        yield agent


def test_frames_and_the_topic_tell_the_lesson(agent: Agent) -> None:
    agent.reset()
    with Probe("/lessons") as probe:
        topic = probe.listen(String, "lesson", LATCHED)
        told = []
        for _ in range(5):
            frame = agent.get_frame()
            state = frame["lesson"]
            assert agent.get_lesson() == state
            there = {shown.name for shown in frame["instances"].values()}
            assert there == (set() if state.phase == "ended" else set(state.objects))
            until(
                lambda state=state: topic.messages and topic.last.data == state.to_json(),
                "the topic to follow",
            )
            told.append((state.lap, state.name, state.phase))
            agent.step(24)
        assert told == [
            *((lap, name, "lesson") for lap in (1, 2) for name in ("one", "two")),
            (2, "two", "ended"),
        ]


def test_lessons_are_begun_stopped_and_refused(agent: Agent) -> None:
    agent.reset()
    state = agent.start_lessons("{sequence: [{objects: [two], duration: 1}]}")
    assert isinstance(state, LessonState)
    assert (state.name, state.laps, state.count) == ("two", 0, 1)
    with pytest.raises(InvalidEntry, match="takes no time"):
        agent.start_lessons({"sequence": [{"objects": ["one"]}]})
    with pytest.raises(InvalidRequest, match="a mapping"):
        agent.start_lessons("[1]")
    agent.stop_lessons()
    with pytest.raises(InvalidState, match="no lessons"):
        agent.stop_lessons()
    assert agent.get_frame()["lesson"].phase == "stopped"
    assert agent.start_lessons().name == "two"
    agent.change_scene("optical")
    assert agent.get_lesson() is None
    assert agent.get_frame()["lesson"] is None
    with pytest.raises(InvalidState, match="has no lessons"):
        agent.start_lessons()
    agent.change_scene("yard")


def test_recorded_frames_tell_their_lessons(tmp_path: Path) -> None:
    (tmp_path / "class.yaml").write_text(CLASS, encoding="utf-8")
    eye = AgentSpec(name="eye", intrinsics=CameraIntrinsics(width=32, height=24), rate_hz=20.0)
    told = []
    with Simulation("class", mode="lockstep", scene_paths=[tmp_path], agent=eye) as simulation:
        with RecordingWriter(tmp_path / "bag") as writer:
            record_lockstep(simulation, writer, frames=10, views=["instance"])
        simulation.reset()
        for _ in range(10):
            told.append(simulation.capture(["instance"]))
            simulation.step(12)
    with RecordingReader(tmp_path / "bag") as reader:
        frames = list(RecordedFrames(reader))
    assert [frame.lesson for frame in frames] == [frame.lesson for frame in told]
    assert len({frame.lesson for frame in frames}) == 5
    for recorded, live in zip(frames, told, strict=True):
        assert recorded.instances == live.instances
        assert np.array_equal(recorded["instance"], live["instance"])
