"""Frames through shared memory: the same as by topics, held as long as wanted, for others too."""

from __future__ import annotations

import os
import socket
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import Image

from sailenv_msgs.msg import FrameInfo
from sailenv_ros import Agent
from sailenv_ros.errors import UnknownName
from sailenv_ros.ros.client.frame_client import FrameClient
from sailenv_ros.ros.client.frame_topics import AgentTopics
from sailenv_ros.system.frame_memory import SEGMENTS
from sailenv_ros.system.frame_socket import connect, receive, send
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.views import RENDERED_VIEWS as VIEWS
from tests.ros.conftest import SMALL
from tests.support.ros_probe import Probe
from tests.support.waiting import until

pytestmark = pytest.mark.ros

NAMESPACE = "/direct"
OWN: dict[str, Any] = {**SMALL, "namespace": NAMESPACE}


@pytest.fixture
def agent(keeper: Agent, monkeypatch: pytest.MonkeyPatch) -> Iterator[Agent]:
    """An agent whose frames come through shared memory, or it fails."""
    with Agent(**OWN) as agent:
        agent.get_frame()  # the first comes by topics

        def not_by_topics(*_: object) -> None:
            raise AssertionError("a captured frame came by topics")

        with monkeypatch.context() as patch:
            patch.setattr(AgentTopics, "take", not_by_topics)
            yield agent


def socket_to(simulator: Agent) -> socket.socket:
    """Open a connection of one's own."""
    sock = connect(int(os.environ["ROS_DOMAIN_ID"]), NAMESPACE)
    assert sock is not None
    sock.settimeout(10.0)
    return sock


def test_frames_are_the_same_as_by_topics(keeper: Agent, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every view and every entry of one instant, but for their number and how long they took."""
    keeper.step(8)
    frames = {}
    for way in ("0", "1"):
        monkeypatch.setenv("SAILENV_DIRECT_FRAMES", way)
        with Agent(**OWN, views=tuple(VIEWS), name="twice") as agent:
            agent.get_frame()
            agent.get_frame()
            frames[way] = agent.get_frame()
    one, other = frames.values()
    assert one.keys() == other.keys()
    for name, value in one.items():
        if isinstance(value, np.ndarray):
            assert value.dtype == other[name].dtype
            assert np.array_equal(value, other[name], equal_nan=value.dtype.kind == "f"), name
            assert other[name].flags.writeable
        elif name != "render_s":
            assert value == other[name], name


def test_a_held_frame_is_never_overwritten(agent: Agent) -> None:
    """More frames than there are segments, each with the bytes that it came with."""
    held, bytes_of = [], []
    for _ in range(SEGMENTS + 4):
        agent.step(8)
        held.append(agent.get_frame())
        bytes_of.append({name: held[-1][name].tobytes() for name in ("main", "depth_m", "flow")})
    for frame, expected in zip(held, bytes_of, strict=True):
        assert {name: frame[name].tobytes() for name in expected} == expected
    assert len({expected["depth_m"] for expected in bytes_of}) == len(held)


def test_a_view_of_one_frame_outlives_it(agent: Agent) -> None:
    """A part of one array holds its memory, though the frame itself is gone."""
    part = agent.get_frame()["depth_m"][10:20, ::2]
    expected = part.tobytes()
    for _ in range(3):
        agent.step(8)
        agent.get_frame()
    assert part.tobytes() == expected


def test_others_get_captured_frames_by_topics(agent: Agent) -> None:
    """A subscriber of some topics gets what it would get from the service, and nothing else."""
    with Probe(NAMESPACE) as probe:
        depth = probe.listen(Image, f"{agent.id}/depth")
        info = probe.listen(FrameInfo, f"{agent.id}/frame_info")

        def arrived() -> bool:
            agent.step(8)
            agent.get_frame()
            return bool(depth.messages and info.messages)

        until(arrived, "the images")
        frame = agent.get_frame()
        until(lambda: info.last.sequence == frame["sequence"], "the frame_info")
        until(lambda: depth.last.data.tobytes() == frame["depth_m"].tobytes(), "the image")
        assert list(info.last.views) == ["depth"]


def test_a_stream_begins_after_captured_frames(agent: Agent) -> None:
    """Streams come by topics, and never give a frame that was captured before."""
    with Probe(NAMESPACE) as probe:
        for topic in ("rgb", "depth", "category", "instance", "flow"):
            probe.listen(Image, f"{agent.id}/{topic}")
        last = agent.get_frame()["sequence"]
        stream = agent.frames(30.0)
        assert next(stream)["sequence"] > last
        stream.close()


def test_another_size_comes_too(agent: Agent, keeper: Agent) -> None:
    """Segments grow with the picture, also where another client made it larger."""
    agent.set_intrinsics(CameraIntrinsics(width=320, height=240))
    assert agent.get_frame()["main"].shape == (240, 320, 3)
    keeper.set_intrinsics(CameraIntrinsics(width=64, height=48), agent=agent.id)
    assert agent.get_frame()["main"].shape == (48, 64, 3)


@pytest.mark.parametrize(("width", "repeated"), [(320, 0), (16, 1)])
def test_a_camera_that_another_client_changed_is_noticed(
    agent: Agent, monkeypatch: pytest.MonkeyPatch, width: int, repeated: int
) -> None:
    """Where its scene_info has not arrived yet: the frame is right, or it is asked for anew."""
    intrinsics = FrameClient._intrinsics
    outdated = iter([CameraIntrinsics(width=width, height=width // 2)])
    monkeypatch.setattr(
        FrameClient, "_intrinsics", lambda *args: next(outdated, None) or intrinsics(*args)
    )
    assert agent.get_frame()["main"].shape == (120, 160, 3)
    assert agent.recaptured == repeated


def test_refusals_are_the_operations_own(agent: Agent, keeper: Agent) -> None:
    """The simulator's sentence arrives, and the connection goes on."""
    keeper.delete_agent(agent.id)
    with pytest.raises(UnknownName, match="agent"):
        agent.get_frame()
    with pytest.raises(UnknownName, match="agent"):
        agent.get_frame()


@pytest.mark.parametrize(
    "header",
    [
        {},
        {"segment": 0},
        {"segment": 10**9, "agent": "x", "views": [], "subscribed": []},
        {"segment": "many", "agent": 3, "views": 5, "subscribed": None},
    ],
)
def test_a_hostile_client_is_cut_off(agent: Agent, keeper: Agent, header: dict[str, Any]) -> None:
    """Whoever sends nonsense is disconnected, and nobody else notices."""
    sock = socket_to(keeper)
    with open(os.devnull) as null:
        send(sock, header, (), [null.fileno()] * (header.get("segment") == 10**9))
    assert receive(sock) is None
    sock.close()
    assert agent.get_frame()["main"].shape == (120, 160, 3)
