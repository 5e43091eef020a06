"""Behaviours, controllers and cmd_vel over DDS; the tree of transforms."""

from __future__ import annotations

import json
import types
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from geometry_msgs.msg import Twist, Vector3
from rclpy.serialization import serialize_message
from rosbags.typesys import Stores, get_typestore

from sailenv_msgs.msg import Behaviour, Contacts, SceneInfo
from sailenv_msgs.srv import (
    AddBehaviour,
    ApplyWrench,
    GetContacts,
    GetObject,
    GetPose,
    RemoveBehaviours,
    SetMoverController,
    SpawnObject,
    Step,
)
from sailenv_ros import Simulation
from sailenv_ros.ros.nodes.tf_tree import TfTree
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from tests.support.ros_probe import LATCHED, Probe, Topic
from tests.support.sim_node_process import NodeProcess
from tests.support.waiting import until

pytestmark = pytest.mark.ros

NAMESPACE = "/motion_services"


@pytest.fixture(scope="module")
def probe() -> Iterator[Probe]:
    """A participant beside a lockstep simulator."""
    with NodeProcess(NAMESPACE, mode="lockstep"), Probe(NAMESPACE) as probe:
        yield probe


@pytest.fixture
def scene(probe: Probe) -> Iterator[Topic]:
    topic = probe.listen(SceneInfo, "scene_info", LATCHED)
    until(lambda: topic.messages, "scene_info")
    yield topic
    probe.listen_no_more()


def test_behaviours_come_and_go_by_service(probe: Probe, scene: Topic) -> None:
    """`moving` in scene_info follows; a wrong parameter is refused with its name."""
    floor, cube = scene.last.instances[0], scene.last.instances[1]
    assert floor.is_static
    shake = Behaviour(type="poltergeist", parameters_json=json.dumps({"mean_interval": 1.0}))
    probe.done(RemoveBehaviours, "remove_behaviours", RemoveBehaviours.Request(id=cube.id))
    until(lambda: not scene.last.instances[1].moving, "the object to be left alone")
    request = AddBehaviour.Request(id=cube.id, behaviour=shake)
    probe.done(AddBehaviour, "add_behaviour", request)
    until(lambda: scene.last.instances[1].moving, "the object to be moved")
    wrong = Behaviour(type="poltergeist", parameters_json=json.dumps({"mean_interval": -1.0}))
    answer = probe.call(
        AddBehaviour, "add_behaviour", AddBehaviour.Request(id=cube.id, behaviour=wrong)
    )
    assert not answer.success
    assert "mean_interval" in answer.message
    answer = probe.call(
        AddBehaviour, "add_behaviour", AddBehaviour.Request(id=floor.id, behaviour=shake)
    )
    assert not answer.success
    assert "static" in answer.message


def test_cmd_vel_drives_the_mover_once_it_is_a_rigid_body(probe: Probe, scene: Topic) -> None:
    """Refused words for controllers; then a Twist moves the agent that follows, forward."""
    answer = probe.call(
        SetMoverController, "set_mover_controller", SetMoverController.Request(controller="magic")
    )
    assert not answer.success
    assert "waypoint, rigidbody" in answer.message
    request = SetMoverController.Request(controller="rigidbody")
    probe.done(SetMoverController, "set_mover_controller", request)
    until(lambda: scene.last.movers[0].controller == "rigidbody", "the controller in scene_info")
    before = probe.done(GetPose, "agent/get_pose").pose.pose.position
    commands = probe.node.create_publisher(Twist, f"{NAMESPACE}/mover/cmd_vel", 1)
    until(commands.get_subscription_count, "the simulator to listen to mover/cmd_vel")

    def moved() -> float:
        commands.publish(Twist(linear=Vector3(x=0.0, y=0.0, z=0.4)))
        probe.done(Step, "step", Step.Request(steps=12))
        return float(probe.done(GetPose, "agent/get_pose").pose.pose.position.z - before.z)

    until(lambda: moved() > 0.1, "the mover to rise")
    probe.node.destroy_publisher(commands)


# -- transforms --------------------------------------------------------------------------------


@dataclass
class FakeNode:
    """Keeps what is published, by topic."""

    sent: dict[str, list[Any]] = field(default_factory=dict)

    def create_publisher(self, kind: type, topic: str, *args: Any, **kwargs: Any) -> Any:
        messages = self.sent.setdefault(topic, [])
        return types.SimpleNamespace(publish=messages.append, get_subscription_count=lambda: 1)


def matrix(stamped: Any) -> Any:
    t, r = stamped.transform.translation, stamped.transform.rotation
    return Pose((t.x, t.y, t.z), (r.x, r.y, r.z, r.w)).matrix()


def test_the_tree_leads_from_the_world_to_the_optical_frame() -> None:
    """world → agent → camera → optical, multiplied, is the camera's own matrix."""
    node = FakeNode()
    tree = TfTree(node)  # type: ignore[arg-type]  # all that it uses of a node
    tree.set_agents((AgentSpec(name="left"), AgentSpec(name="right")))
    tree.set_agents((AgentSpec(name="left"), AgentSpec(name="right")))
    (fixed,) = node.sent["/tf_static"]
    pose = Pose.from_rpy_deg((1, 2, 3), (10, 20, 30))
    tree.publish("right", pose, Time(sec=4))
    (moving,) = node.sent["/tf"]
    links = {
        (link.header.frame_id, link.child_frame_id): matrix(link)
        for link in (*fixed.transforms, *moving.transforms)
    }
    camera = Camera(intrinsics=CameraIntrinsics(), pose=pose)
    product = (
        links["world", "right"]
        @ links["right", "right/camera_frame"]
        @ links["right/camera_frame", "right/camera_optical_frame"]
    )
    np.testing.assert_allclose(product, camera.world_from_camera, atol=1e-12)
    assert len(fixed.transforms) == 4
    assert moving.transforms[0].header.stamp.sec == 4


def test_a_rig_is_one_body_with_fixed_cameras() -> None:
    """world → body is told once an instant, by whichever camera; body → camera never changes."""
    extrinsics = {
        "rig/left": Pose.from_rpy_deg((0.1, 0.06, 0.2), (1, 2, 3)),
        "rig/wide": Pose.from_rpy_deg((0.0, 0.0, -0.1), (0, 90, 10)),
    }
    cameras = [AgentSpec(name=name, extrinsics=pose) for name, pose in extrinsics.items()]
    node = FakeNode()
    tree = TfTree(node)  # type: ignore[arg-type]  # all that it uses of a node
    tree.set_agents((AgentSpec(name="rig"), *cameras))
    body = Pose.from_rpy_deg((1, 2, 3), (10, 20, 30))
    for name, pose in extrinsics.items():
        tree.publish(name, body.carried(pose), Time(sec=4))
    (fixed,), (moving,) = node.sent["/tf_static"], node.sent["/tf"]
    links = {
        (link.header.frame_id, link.child_frame_id): matrix(link)
        for link in (*fixed.transforms, *moving.transforms)
    }
    np.testing.assert_allclose(links["world", "rig"], body.matrix(), atol=1e-12)
    for name, pose in extrinsics.items():
        camera = Camera(intrinsics=CameraIntrinsics(), pose=body.carried(pose))
        product = links["world", "rig"] @ links["rig", name] @ links[name, f"{name}/camera_frame"]
        product = product @ links[f"{name}/camera_frame", f"{name}/camera_optical_frame"]
        np.testing.assert_allclose(product, camera.world_from_camera, atol=1e-12)


def test_a_rig_of_a_name_that_was_used_before_is_told() -> None:
    """Also at the instant at which the one before was told last, as in a simulator that waits."""
    node = FakeNode()
    tree = TfTree(node)  # type: ignore[arg-type]  # all that it uses of a node
    rig = (AgentSpec(name="rig"), AgentSpec(name="rig/left", extrinsics=Pose()))
    for agents in (rig, (), rig):
        tree.set_agents(agents)
        if agents:
            tree.publish("rig/left", Pose(), Time(sec=4))
    assert [m.transforms[0].child_frame_id for m in node.sent["/tf"]] == ["rig", "rig"]


def test_what_is_sent_is_a_tf_message_of_ros_2() -> None:
    """By Jazzy's own definition of the type: it holds the transforms, there and back as CDR."""
    node = FakeNode()
    tree = TfTree(node)  # type: ignore[arg-type]  # all that it uses of a node
    tree.set_agents((AgentSpec(name="left"),))
    tree.publish("left", Pose((1.0, 2.0, 3.0)), Time(sec=4))
    store = get_typestore(Stores.ROS2_JAZZY)
    for topic in ("/tf", "/tf_static"):
        (message,) = node.sent[topic]
        held: Any = store.deserialize_cdr(serialize_message(message), "tf2_msgs/msg/TFMessage")
    assert held.transforms[0].header.frame_id == "left"


def test_every_object_of_a_frame_has_a_transform_once() -> None:
    """However many agents see the instant; and nobody who did not ask is told."""
    eye = AgentSpec(name="eye", intrinsics=CameraIntrinsics(width=32, height=24), rate_hz=0.0)
    with Simulation("optical", mode="lockstep", agent=eye) as simulation:
        simulation.step(8)
        frame = simulation.capture(("depth",))
    silent, node = FakeNode(), FakeNode()
    TfTree(silent).publish_instances(frame, Time(sec=1))  # type: ignore[arg-type]  # see above
    assert silent.sent["/tf"] == []
    tree = TfTree(node, instances=True)  # type: ignore[arg-type]  # see above
    tree.publish_instances(frame, Time(sec=1))
    tree.publish_instances(frame, Time(sec=1))
    (message,) = node.sent["/tf"]
    told = {link.child_frame_id: matrix(link) for link in message.transforms}
    assert frame.states is not None
    assert set(told) == {f"object/{one.name}" for one in frame.instances.values()}
    for row, number in enumerate(frame.states.ids.tolist()):
        pose = told[f"object/{frame.instances[number].name}"]
        np.testing.assert_allclose(pose, frame.states.matrices[row], atol=1e-12)


def test_a_push_and_what_it_runs_into_are_told(probe: Probe, scene: Topic) -> None:
    """Two cubes side by side: one is pushed into the other; service and topic tell of it."""
    heard = probe.listen(Contacts, "contacts")
    ids = []
    for number in range(2):
        spawn = SpawnObject.Request(asset="cube", mass_kg=2.0, name=f"pushed {number}")
        spawn.pose.position.x, spawn.pose.position.z = 40.0 + 1.2 * number, 50.0
        ids.append(probe.done(SpawnObject, "spawn_object", spawn).id)
    push = ApplyWrench.Request(id=ids[0], force_n=Vector3(x=480.0), duration_s=0.01)
    probe.done(GetContacts, "get_contacts", GetContacts.Request())
    probe.done(ApplyWrench, "apply_wrench", push)
    probe.done(Step, "step", Step.Request(steps=48))
    asked = GetContacts.Request(seconds=0.2)
    contacts = probe.done(GetContacts, "get_contacts", asked).contacts
    (found,) = [c for c in contacts if {c.first, c.second} == set(ids)]
    assert found.normal.x < -0.9  # towards the first
    speed = probe.done(GetObject, "get_object", GetObject.Request(id=ids[1])).twist.linear.x
    assert speed > 0.1
    assert found.impulse_n_s == pytest.approx(2.0 * speed, rel=0.05)
    until(
        lambda: any({c.first, c.second} == set(ids) for m in heard.messages for c in m.contacts),
        "the contact on its topic",
    )
    refused = ApplyWrench.Request(id=ids[0], force_n=Vector3(x=float("nan")))
    assert "force_n" in probe.call(ApplyWrench, "apply_wrench", refused).message
    refused = ApplyWrench.Request(id=scene.last.instances[0].id, force_n=Vector3(x=1.0))
    assert "static" in probe.call(ApplyWrench, "apply_wrench", refused).message
