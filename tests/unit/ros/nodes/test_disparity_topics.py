"""`disparity` of a rig as ROS has it: made of two frames of one instant, while somebody listens."""

from __future__ import annotations

import dataclasses
import types
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from rclpy.serialization import serialize_message
from rosbags.typesys import Stores, get_typestore

from sailenv_msgs_py.images import view_from_image
from sailenv_ros import AgentSpec, CameraIntrinsics, Pose, RigCamera, Simulation, look_at
from sailenv_ros.frame.stereo import disparity
from sailenv_ros.ros.nodes.disparity_topics import DisparityTopics, stereo_pairs

pytestmark = pytest.mark.ros

LENS = CameraIntrinsics(width=64, height=48)
VIEWS = ("depth", "instance")
RIG = {
    "left": RigCamera(intrinsics=LENS, extrinsics=Pose((0.0, 0.2, 0.0)), views=VIEWS),
    "up": RigCamera(intrinsics=LENS, extrinsics=Pose((0.0, 0.2, 0.1)), views=VIEWS),
    "right": RigCamera(intrinsics=LENS, extrinsics=Pose((0.0, -0.2, 0.0)), views=VIEWS),
}
HEAD = AgentSpec(
    name="head", following=False, pose=look_at((-4, 0, 1.5), (0, 0, 1)), rate_hz=0.0, cameras=RIG
)


@dataclass
class FakeNode:
    """Keeps what is published, by topic; `readers` is how many listen."""

    readers: int = 1
    sent: dict[str, list[Any]] = field(default_factory=dict)

    def create_publisher(self, kind: type, topic: str, *args: Any, **kwargs: Any) -> Any:
        messages = self.sent.setdefault(topic, [])
        return types.SimpleNamespace(
            topic=topic, publish=messages.append, get_subscription_count=lambda: self.readers
        )

    def destroy_publisher(self, publisher: Any) -> None:
        del self.sent[publisher.topic]


def test_a_pair_of_one_instant_becomes_a_message() -> None:
    """Values of what both see, -1 elsewhere; a frame of another instant makes none."""
    node = FakeNode()
    topics = DisparityTopics(node)  # type: ignore[arg-type]  # all that it uses of a node
    with Simulation("optical", mode="lockstep", agent=HEAD) as simulation:
        topics.set_agents(simulation.info.agents)
        before = simulation.capture_rig()
        simulation.step(8)
        after = simulation.capture_rig()
        simulation.delete_agent("head/right")
        alone = simulation.info.agents
    assert topics.wanted_views("head/left") == topics.wanted_views("head/right") == set(VIEWS)
    assert topics.wanted_views("head/up") == set()
    for frame in (before["left"], before["up"], after["right"]):
        topics.publish(frame)
    assert node.sent["head/disparity"] == []
    topics.publish(after["left"])
    (message,) = node.sent["head/disparity"]
    true = disparity(after["left"], after["right"])
    values = view_from_image("depth", message.image)
    assert 0.5 < true.visible.mean() < 1.0
    assert (values[true.visible] == true.disparity[true.visible]).all()
    assert (values[~true.visible] == -1.0).all()
    assert (message.f, message.t) == (LENS.fx, pytest.approx(0.4))
    assert message.header.frame_id == "head/left/camera_optical_frame"
    assert message.max_disparity == values.max()
    topics.set_agents(alone)
    assert node.sent == {}


def test_the_message_is_ros_2_s() -> None:
    """By Jazzy's own definition: it has these fields, and they travel as CDR."""
    node = FakeNode()
    topics = DisparityTopics(node)  # type: ignore[arg-type]  # all that it uses of a node
    with Simulation("optical", mode="lockstep", agent=HEAD) as simulation:
        topics.set_agents(simulation.info.agents)
        for frame in simulation.capture_rig().values():
            topics.publish(frame)
    (message,) = node.sent["head/disparity"]
    store = get_typestore(Stores.ROS2_JAZZY)
    kind: Any = store.types["stereo_msgs/msg/DisparityImage"]
    names = [one.name for one in dataclasses.fields(kind)]

    def travelled(name: str, type_name: str) -> Any:
        return store.deserialize_cdr(serialize_message(getattr(message, name)), type_name)

    parts = {
        "header": "std_msgs/msg/Header",
        "image": "sensor_msgs/msg/Image",
        "valid_window": "sensor_msgs/msg/RegionOfInterest",
    }
    values = {
        name: travelled(name, parts[name]) if name in parts else getattr(message, name)
        for name in names
        if name != "__msgtype__"
    }
    data = store.serialize_cdr(kind(**values), kind.__msgtype__)
    back: Any = store.deserialize_cdr(data, kind.__msgtype__)
    assert back.t == np.float32(0.4)
    assert (back.image.height, back.valid_window.width) == (48, 64)


def test_nobody_listens_nothing_is_asked_for() -> None:
    """No views are drawn for it, and nothing is made."""
    node = FakeNode(readers=0)
    topics = DisparityTopics(node)  # type: ignore[arg-type]  # all that it uses of a node
    cameras = (AgentSpec(name="head"), *HEAD.camera_specs)
    topics.set_agents(cameras)
    assert topics.wanted_views("head/left") == set()
    assert stereo_pairs(cameras) == {"head": ("head/left", "head/right")}
    assert stereo_pairs((AgentSpec(name="eye"),)) == {}
