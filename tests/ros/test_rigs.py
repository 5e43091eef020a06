"""Rigs through ROS: one instant for all cameras, topics and `camera_info` of each."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from sensor_msgs.msg import CameraInfo, Image

from sailenv_msgs.msg import AgentInfo, ErrorCode
from sailenv_msgs.srv import CaptureRig, DeleteAgent, RegisterAgent
from sailenv_ros import Agent, CameraIntrinsics, Pose, RigCamera
from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.frame.stereo import disparity
from tests.support.ros_probe import Probe
from tests.support.waiting import until

pytestmark = pytest.mark.ros

NAMESPACE = "/rigged"
LENS = CameraIntrinsics(width=64, height=48)
FISHEYE = CameraIntrinsics(
    width=48,
    height=48,
    fx_px=20.0,
    fy_px=20.0,
    distortion_model="equidistant",
    distortion=(0.01, 0.0, 0.0, 0.0),
    max_angle_deg=80.0,
)
VIEWS = ("rgb", "depth", "instance")
RIG = {
    "left": RigCamera(intrinsics=LENS, extrinsics=Pose((0.0, 0.06, 0.0)), views=VIEWS),
    "right": RigCamera(intrinsics=LENS, extrinsics=Pose((0.0, -0.06, 0.0)), views=VIEWS),
    "wide": RigCamera(
        intrinsics=FISHEYE,
        extrinsics=Pose.from_rpy_deg((0.0, 0.0, 0.1), (0, 30, 0)),
        views=("range",),
    ),
}


@pytest.fixture
def rig(keeper: Agent) -> Iterator[Agent]:
    keeper.reset()
    with Agent(width=160, height=120, name="head", cameras=RIG, namespace=NAMESPACE) as rig:
        yield rig


def test_every_camera_shows_one_instant(rig: Agent) -> None:
    """By topics first, through shared memory then: the same frames, one number each."""
    before = rig.capture_rig()
    after = rig.capture_rig()
    rig.step(8)
    later = rig.capture_rig(("depth",))
    for frames in (before, after, later):
        assert list(frames) == ["left", "right", "wide"]
        assert len({frame.stamp_ns for frame in frames.values()}) == 1
    assert later["left"].stamp_ns == 33_333_333
    for name, camera in RIG.items():
        assert [f[name].sequence for f in (before, after, later)] == [1, 2, 3]
        assert tuple(before[name]) == camera.views
        for view in camera.views:
            assert before[name][view].tobytes() == after[name][view].tobytes()
        expected = rig.get_pose().matrix() @ camera.extrinsics.matrix()
        assert np.abs(later[name].camera.pose.matrix() - expected).max() < 1e-9
        assert later[name].camera.intrinsics == camera.intrinsics
    assert disparity(before["left"], before["right"]).baseline_m == pytest.approx(0.12)
    assert rig.recaptured == 0


def test_cameras_alone_and_as_dicts(rig: Agent) -> None:
    """A camera of the rig is captured by its agent's name; another's is not."""
    frames = rig.get_frames()
    assert frames["left"]["main"].shape == (48, 64, 3)
    assert rig.capture(("depth",), agent="head/right")["depth"].shape == (48, 64)
    extrinsics = {one.name: one.extrinsics for one in rig.info.agents}
    assert extrinsics["head"] is None
    assert extrinsics["head/wide"] == RIG["wide"].extrinsics
    with pytest.raises(InvalidRequest, match="receives its own frames alone"):
        rig.capture(agent="head/none")


def test_an_agent_without_cameras_is_no_rig(keeper: Agent) -> None:
    """It says so, and goes on."""
    with pytest.raises(InvalidRequest, match="made with cameras"):
        keeper.capture_rig()
    assert keeper.get_frame()["sequence"] >= 1


def test_a_rig_that_ends_leaves_nothing(keeper: Agent) -> None:
    """Its cameras go with it, and its name is free again."""
    for _ in range(2):
        with Agent(width=160, height=120, name="head", cameras=RIG, namespace=NAMESPACE) as rig:
            assert "head/left" in {one.name for one in rig.info.agents}
        keeper.step(1)
        assert all(not one.name.startswith("head") for one in keeper.info.agents)


def test_topics_of_each_camera(keeper: Agent) -> None:
    """Registered and captured by services; the right camera's P knows the baseline."""
    keeper.reset()
    cameras = []
    for name, y in (("left", 0.06), ("right", -0.06)):
        camera = AgentInfo(name=f"stereo/{name}", width=64, height=48, rate_hz=0.0, views=["depth"])
        camera.extrinsics.position.y = y
        cameras.append(camera)
    agent = AgentInfo(name="stereo", width=64, height=48, rate_hz=0.0)
    with Probe(NAMESPACE) as probe:
        wrong = AgentInfo(name="other/left")
        refused = probe.call(
            RegisterAgent, "register_agent", RegisterAgent.Request(agent=agent, cameras=[wrong])
        )
        assert (refused.success, refused.code) == (False, ErrorCode.INVALID_REQUEST)
        assert "stereo/<camera>" in refused.message
        probe.done(
            RegisterAgent, "register_agent", RegisterAgent.Request(agent=agent, cameras=cameras)
        )
        images = [probe.listen(Image, f"stereo/{name}/depth") for name in ("left", "right")]
        infos = [
            probe.listen(CameraInfo, f"stereo/{name}/camera_info") for name in ("left", "right")
        ]
        done = probe.done(CaptureRig, "stereo/capture_rig", CaptureRig.Request())
        assert list(done.cameras) == ["stereo/left", "stereo/right"]
        assert list(done.sequences) == [1, 1]
        topics = (*images, *infos)
        until(lambda: all(topic.messages for topic in topics), "the rig's messages")
        messages = [topic.last for topic in topics]
        for message, side in zip(messages, ("left", "right") * 2, strict=True):
            assert message.header.stamp == done.stamp
            assert message.header.frame_id == f"stereo/{side}/camera_optical_frame"
        left, right = messages[2:]
        fx = 24.0 / np.tan(np.radians(30.0))
        assert left.p[3] == 0.0
        assert right.p[3] == pytest.approx(-fx * 0.12)
        assert np.array_equal(left.k, right.k)
        probe.done(DeleteAgent, "delete_agent", DeleteAgent.Request(name="stereo"))
        gone = probe.call(DeleteAgent, "delete_agent", DeleteAgent.Request(name="stereo/left"))
        assert not gone.success
    with pytest.raises(UnknownName):
        keeper.delete_agent("stereo")
