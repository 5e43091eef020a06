"""The streamer node over real DDS: frames on topics in their order, and a clock."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Image

import sailenv_ros.streams as streams
from sailenv_msgs.msg import FrameInfo, SceneInfo
from sailenv_msgs_py.images import view_from_image
from sailenv_msgs_py.stamps import ns_from_stamp
from tests.support.ros_probe import BEST_EFFORT, LATCHED, Probe
from tests.support.tool_process import ToolProcess
from tests.support.waiting import until

pytestmark = pytest.mark.ros

COURSE = """
version: 1
rate: 30
episode: 5
rooms: {scenes: [optical]}
eye: {width: 48, height: 32, walk: 0, carry: 0, fixate: 0, stand: 1}
moves: {open: 0, pushed: 0}
drift: {lamps: {onset: 0, life: 100, left: 0.5}}
"""


@pytest.fixture
def course(tmp_path: Path) -> Path:
    path = tmp_path / "short.yaml"
    path.write_text(COURSE)
    return path


def streamer(path: Path, **parameters: object) -> ToolProcess:
    settings = {"course": str(path), "seed": 4, "views": ["rgb", "instance"], **parameters}
    return ToolProcess("streamer", "/sailenv", "", **settings)


def test_frames_come_by_their_numbers(course: Path) -> None:
    """Those of the stream itself, byte for byte, each once; what drifts is told; the clock runs."""
    settings = {"begin": 7, "frames": 6, "rate": 2.0, "delay_s": 5.0}
    with Probe("/sailenv") as probe:
        pictures = probe.listen(Image, "eye/rgb")
        infos = probe.listen(FrameInfo, "eye/frame_info")
        scenes = probe.listen(SceneInfo, "scene_info", LATCHED)
        clock = probe.listen(Clock, "/clock", BEST_EFFORT)
        with streamer(course, **settings) as process:
            until(lambda: len(pictures.messages) == len(infos.messages) == 6, "six frames", 60.0)
            until(lambda: scenes.messages, "the scene")
            assert process.status() == 0, process.log
    with streams.open(course, seed=4, views=("rgb", "instance")) as stream:
        for number, picture, info in zip(
            range(7, 13), pictures.messages, infos.messages, strict=True
        ):
            frame = stream[number]
            np.testing.assert_array_equal(view_from_image("rgb", picture), frame["rgb"])
            assert info.sequence == number
            assert ns_from_stamp(info.header.stamp) == round(number * 1e9 / 30)
            assert f'"number": {number}' in info.randomised
    times = [ns_from_stamp(one.clock) for one in clock.messages]
    assert times == sorted(set(times))
    # What is told of the scene is as old as the last change of light: frame 5.
    assert set(times) <= {round(number * 1e9 / 30) for number in (5, *range(7, 13))}


def test_it_ends_when_asked(course: Path) -> None:
    with Probe("/sailenv") as probe:
        infos = probe.listen(FrameInfo, "eye/frame_info")
        with streamer(course, rate=0.0) as process:
            until(lambda: len(infos.messages) > 20, "some frames", 60.0)
            assert process.end() == 0, process.log


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ({"course": "away"}, "course of a stream"),
        ({"begin": 10_000_000}, "begin"),
    ],
)
def test_a_wrong_parameter_is_told(course: Path, wrong: dict[str, object], told: str) -> None:
    with streamer(course, **wrong) as process:
        assert process.status() == 2
        assert told in process.log
