"""Pictures, compressed images, diagnostics and live parameters of sim_node."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import Any

import cv2
import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rcl_interfaces.srv import DescribeParameters, SetParameters
from rclpy.parameter import Parameter
from sensor_msgs.msg import CompressedImage, Image

from sailenv_msgs.msg import SceneInfo
from sailenv_msgs.srv import Capture, DeleteAgent, GetPose, Pause, Resume
from tests.support.ros_probe import LATCHED, Eye, Probe
from tests.support.sim_node_process import NodeProcess
from tests.support.waiting import until

pytestmark = pytest.mark.ros

NAMESPACE = "/derived"


@pytest.fixture(scope="module")
def participant() -> Iterator[Probe]:
    """A participant beside a realtime simulator with one small agent."""
    with (
        NodeProcess(NAMESPACE, agent__width=160, agent__height=120, agent__rate_hz=20.0),
        Probe(NAMESPACE) as probe,
    ):
        yield probe


@pytest.fixture
def probe(participant: Probe) -> Iterator[Probe]:
    """The participant, with no topic subscribed to."""
    yield participant
    participant.listen_no_more()


def set_parameter(probe: Probe, name: str, value: object) -> Any:
    request = SetParameters.Request(parameters=[Parameter(name, value=value).to_parameter_msg()])
    return probe.call(SetParameters, "sim_node/set_parameters", request).results[0]


# -- pictures ------------------------------------------------------------------------------


@pytest.mark.parametrize("view", ["depth", "category", "instance", "flow"])
def test_a_picture_alone_is_enough_to_have_its_view_rendered(probe: Probe, view: str) -> None:
    """`<view>/color` is an rgb8 image of the agent's size, with more than one colour in it."""
    heard = probe.listen(Image, f"agent/{view}/color")
    until(lambda: len(heard.messages) > 1, "two pictures")
    image = heard.last
    assert (image.encoding, image.width, image.height) == ("rgb8", 160, 120)
    assert image.header.frame_id
    assert len(np.unique(np.frombuffer(image.data, np.uint8))) > 1


def test_compressed_ids_are_lossless_and_pictures_nearly(probe: Probe) -> None:
    """png of the ids is the ids; jpeg of the picture is within some grey levels of it."""
    with Eye(probe, ("rgb", "category", "instance")) as eye:
        packed = {v: probe.listen(CompressedImage, f"eye/{v}/compressed") for v in eye.views}
        until(
            lambda: all(
                probe.node.count_publishers(f"{NAMESPACE}/eye/{v}/compressed") for v in eye.views
            ),
            "the topics",
        )
        views: dict[str, Any] = {}

        def arrived() -> bool:
            # A subscriber is matched a moment after its publisher is known.
            for topic in packed.values():
                topic.messages.clear()
            views.update(eye.capture())
            return all(topic.messages for topic in packed.values())

        until(arrived, "compressed images")
        for view, topic in packed.items():
            message = topic.last
            decoded = cv2.imdecode(np.frombuffer(message.data, np.uint8), cv2.IMREAD_UNCHANGED)
            assert message.header.stamp == eye.images[view].last.header.stamp
            if view == "rgb":
                assert message.format == "rgb8; jpeg compressed bgr8"
                error = np.abs(decoded[..., ::-1].astype(int) - views[view])
                assert error.mean() < 4.0
            else:
                assert "png" in message.format
                assert np.array_equal(decoded, views[view])
                assert decoded.dtype == views[view].dtype


def test_compressed_depth_is_what_its_readers_expect(probe: Probe) -> None:
    """Decoded by their formula it is the depth to half a step, and nothing where there is none."""
    with Eye(probe, ("depth",)) as eye:
        packed = probe.listen(CompressedImage, "eye/depth/compressedDepth")
        views: dict[str, Any] = {}

        def arrived() -> bool:
            packed.messages.clear()
            views.update(eye.capture())
            return bool(packed.messages)

        until(arrived, "a compressed depth")
        message, depth = packed.last, views["depth"]
    assert message.format == "32FC1; compressedDepth png"
    assert message.header.stamp == eye.images["depth"].last.header.stamp
    data = bytes(message.data)
    kind, scale, offset = struct.unpack("<iff", data[:12])
    levels = cv2.imdecode(np.frombuffer(data[12:], np.uint8), cv2.IMREAD_UNCHANGED)
    assert (kind, levels.dtype) == (0, np.uint16)
    known = np.isfinite(depth)
    assert np.array_equal(levels > 0, known)
    assert 0.1 < known.mean() < 1.0
    found = np.float32(scale) / (levels[known].astype(np.float32) - np.float32(offset))
    half_a_step = depth[known].astype(np.float64) ** 2 / (2.0 * scale)
    # Readers compute in single precision.
    assert (np.abs(found - depth[known]) <= 1.01 * half_a_step + 2e-6 * depth[known]).all()


def test_nothing_is_made_that_nobody_looks_at(probe: Probe) -> None:
    """With a derived topic alone subscribed to, a capture sends no image of its view."""
    heard = probe.listen(Image, "agent/flow/color")
    until(lambda: heard.messages, "a picture")
    answer = probe.done(Capture, "agent/capture", Capture.Request(views=["flow"]))
    assert answer.views_published == []


# -- diagnostics ---------------------------------------------------------------------------


def values_of(status: DiagnosticStatus) -> dict[str, str]:
    return {pair.key: pair.value for pair in status.values}


def test_diagnostics_tell_rates_times_and_renderer(probe: Probe) -> None:
    """A status of the simulation and one of each agent, once a second."""
    images = probe.listen(Image, "agent/rgb")
    heard = probe.listen(DiagnosticArray, "/diagnostics")

    def statuses() -> dict[str, DiagnosticStatus]:
        return {s.name: s for message in heard.messages[-1:] for s in message.status}

    def streams() -> bool:
        agent = statuses().get("derived: agent agent")
        return agent is not None and float(values_of(agent)["frames per second"]) > 1.0

    until(lambda: images.messages, "a frame", 20.0)
    heard.messages.clear()  # what was told before may be of the test before
    until(streams, "diagnostics of frames", 20.0)
    agent = values_of(statuses()["derived: agent agent"])
    simulation = values_of(statuses()["derived: simulation"])
    assert float(agent["render [ms]"]) > 0.0
    assert float(agent["publish [ms]"]) > 0.0
    assert int(agent["frames dropped"]) >= 0
    assert int(simulation["frames skipped"]) >= 0
    assert simulation["scene"] == "optical"
    assert simulation["renderer"]
    assert float(simulation["real-time factor"]) > 0.0


def test_diagnostics_say_that_time_stands_still(probe: Probe) -> None:
    """A paused simulation is no warning, and its message says why nothing moves."""
    heard = probe.listen(DiagnosticArray, "/diagnostics")
    probe.done(Pause, "pause")
    try:
        until(
            lambda: any(
                s.message == "stands still (paused)" and s.level == DiagnosticStatus.OK
                for message in heard.messages
                for s in message.status
            ),
            "the status of a paused simulation",
        )
    finally:
        probe.done(Resume, "resume")


# -- parameters ----------------------------------------------------------------------------


def test_the_real_time_factor_can_be_changed(probe: Probe) -> None:
    """It is in scene_info at once; a value out of range is refused with a reason."""
    scene = probe.listen(SceneInfo, "scene_info", LATCHED)
    assert set_parameter(probe, "real_time_factor", 4.0).successful
    until(lambda: scene.messages and scene.last.real_time_factor == 4.0, "the new factor")
    refused = set_parameter(probe, "real_time_factor", 11.0)
    assert not refused.successful
    assert refused.reason
    assert set_parameter(probe, "real_time_factor", 1.0).successful
    until(lambda: scene.last.real_time_factor == 1.0, "the old factor")


def test_the_first_agents_rate_can_be_changed(probe: Probe) -> None:
    """The topics stay, frames come at the new rate; 0 ends them."""
    scene = probe.listen(SceneInfo, "scene_info", LATCHED)
    images = probe.listen(Image, "agent/depth")
    assert set_parameter(probe, "agent.rate_hz", 60.0).successful
    until(lambda: scene.messages and scene.last.agents[0].rate_hz == 60.0, "the new rate")

    def fast() -> bool:
        gaps = np.diff(images.stamps())
        return bool((abs(gaps[-20:] - 1e9 / 60) < 1e7).any()) if len(gaps) else False

    until(fast, "frames at the new rate")
    assert set_parameter(probe, "agent.rate_hz", 0.0).successful
    until(lambda: scene.last.agents[0].rate_hz == 0.0, "the rate of 0")
    assert set_parameter(probe, "agent.rate_hz", 20.0).successful
    count = len(images.messages)
    until(lambda: len(images.messages) > count + 2, "frames again")


def test_other_parameters_say_what_to_use_instead(probe: Probe) -> None:
    """They are read-only, and their description names the service."""
    assert not set_parameter(probe, "scene", "object_view").successful
    request = DescribeParameters.Request(names=["scene", "seed", "paused", "real_time_factor"])
    descriptors = probe.call(
        DescribeParameters, "sim_node/describe_parameters", request
    ).descriptors
    for descriptor, service in zip(descriptors, ("change_scene", "reset", "pause"), strict=False):
        assert descriptor.read_only
        assert service in descriptor.description
    assert not descriptors[3].read_only


def test_a_rate_without_its_agent_is_refused() -> None:
    """Where the first agent was deleted, its rate cannot be set, and the reason says so."""
    with NodeProcess("/derived_gone"), Probe("/derived_gone") as probe:
        probe.done(GetPose, "agent/get_pose")
        probe.done(DeleteAgent, "delete_agent", DeleteAgent.Request(name="agent"))
        refused = set_parameter(probe, "agent.rate_hz", 5.0)
        assert not refused.successful
        assert "is gone" in refused.reason
