"""Topics of sim_node over real DDS: names, encodings, one stamp for a frame, nothing unwanted."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped
from rclpy.qos import DurabilityPolicy, ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image
from tf2_msgs.msg import TFMessage
from vision_msgs.msg import Detection3DArray

from sailenv_msgs.msg import AgentInfo, FrameInfo, SceneInfo
from sailenv_msgs.srv import (
    Capture,
    ChangeScene,
    DeleteAgent,
    RegisterAgent,
    Reset,
    SetFollow,
    SetPose,
    SetPosition,
    Step,
)
from sailenv_msgs_py.services import AGENT_SERVICES, SERVICES, SIMULATOR_SERVICES, Service
from sailenv_msgs_py.stamps import ns_from_stamp
from sailenv_msgs_py.transforms import pose_from_msg, pose_to_msg
from sailenv_ros.simulation.operations import ALL_OPERATIONS
from sailenv_ros.types.geometry import Pose, invert, look_at
from sailenv_ros.types.views import RENDERED_VIEWS, VIEWS
from tests.support.ros_probe import BEST_EFFORT, LATCHED, Eye, Probe
from tests.support.sim_node_process import NodeProcess
from tests.support.waiting import until

pytestmark = pytest.mark.ros

NAMESPACE = "/topics"


@pytest.fixture(scope="module")
def node() -> Iterator[NodeProcess]:
    """A lockstep simulator with one small agent at 30 Hz."""
    with NodeProcess(
        NAMESPACE, mode="lockstep", publish_clock=True, agent__width=160, agent__height=120
    ) as node:
        yield node


def step_until(probe: Probe, condition: object, what: str) -> None:
    """Step frame by frame until what was subscribed to arrives."""

    def stepped() -> bool:
        probe.done(Step, "step", Step.Request(steps=8))
        return bool(condition())  # type: ignore[operator]

    until(stepped, what)


# -- what there is -------------------------------------------------------------------------


def test_topics_are_those_of_the_interface(probe: Probe) -> None:
    """The node with its one agent has the topics of the interface and no other of its own."""
    expected = {
        **{f"{NAMESPACE}/agent/{view}": "sensor_msgs/msg/Image" for view in VIEWS},
        **{
            f"{NAMESPACE}/agent/{view}/color": "sensor_msgs/msg/Image"
            for view in ("depth", "category", "instance", "flow", "measured_depth")
        },
        **{
            f"{NAMESPACE}/agent/{view}/compressed": "sensor_msgs/msg/CompressedImage"
            for view in ("rgb", "category", "instance")
        },
        **{
            f"{NAMESPACE}/agent/{view}/compressedDepth": "sensor_msgs/msg/CompressedImage"
            for view in ("depth", "measured_depth")
        },
        "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
        f"{NAMESPACE}/agent/objects": "sailenv_msgs/msg/Objects",
        f"{NAMESPACE}/agent/objects/amodal": "sailenv_msgs/msg/Objects",
        f"{NAMESPACE}/agent/points": "sensor_msgs/msg/PointCloud2",
        **{
            f"{NAMESPACE}/agent/detections_{n}d": f"vision_msgs/msg/Detection{n}DArray"
            for n in (2, 3)
        },
        f"{NAMESPACE}/agent/skeletons": "visualization_msgs/msg/MarkerArray",
        f"{NAMESPACE}/agent/camera_info": "sensor_msgs/msg/CameraInfo",
        f"{NAMESPACE}/agent/frame_info": "sailenv_msgs/msg/FrameInfo",
        f"{NAMESPACE}/agent/pose": "geometry_msgs/msg/PoseStamped",
        f"{NAMESPACE}/scene_info": "sailenv_msgs/msg/SceneInfo",
        f"{NAMESPACE}/contacts": "sailenv_msgs/msg/Contacts",
        f"{NAMESPACE}/joint_states": "sensor_msgs/msg/JointState",
        f"{NAMESPACE}/lesson": "std_msgs/msg/String",
        f"{NAMESPACE}/free_space": "nav_msgs/msg/OccupancyGrid",
        "/tf": "tf2_msgs/msg/TFMessage",
        "/tf_static": "tf2_msgs/msg/TFMessage",
        "/clock": "rosgraph_msgs/msg/Clock",
    }

    def published() -> dict[str, str]:
        found = probe.node.get_publisher_names_and_types_by_node("sim_node", NAMESPACE)
        return {name: kinds[0] for name, kinds in found if name not in ("/rosout",)}

    def seen() -> bool:
        try:
            return set(expected) <= set(published())
        except Exception:  # the node is not known yet
            return False

    until(seen, "the topics")
    topics = published()
    assert topics.pop("/parameter_events") == "rcl_interfaces/msg/ParameterEvent"
    assert topics == expected


def test_every_operation_is_served(probe: Probe) -> None:
    """Each operation has a service, of the type that the table says, and there are no others."""

    def kind(service: Service) -> str:
        return f"sailenv_msgs/srv/{service.type.__name__}"

    assert set(SERVICES) == set(ALL_OPERATIONS)
    agent = {service.name: kind(service) for service in AGENT_SERVICES}
    own = {service.name: kind(service) for service in SIMULATOR_SERVICES}
    assert (agent["set_position"], agent["toggle_follow"], own["change_scene"]) == (
        "sailenv_msgs/srv/SetPosition",
        "sailenv_msgs/srv/ToggleFollow",
        "sailenv_msgs/srv/ChangeScene",
    )
    expected = {f"{NAMESPACE}/agent/{name}": kind for name, kind in agent.items()}
    expected |= {f"{NAMESPACE}/{name}": kind for name, kind in own.items()}

    def served() -> dict[str, str]:
        return {name: kinds[0] for name, kinds in probe.node.get_service_names_and_types()}

    until(lambda: set(expected) <= set(served()), "the services")
    assert {name: served()[name] for name in expected} == expected


@pytest.mark.parametrize(
    ("topic", "reliability", "durability"),
    [
        (f"{NAMESPACE}/agent/rgb", ReliabilityPolicy.RELIABLE, DurabilityPolicy.VOLATILE),
        (f"{NAMESPACE}/agent/camera_info", ReliabilityPolicy.RELIABLE, DurabilityPolicy.VOLATILE),
        (f"{NAMESPACE}/scene_info", ReliabilityPolicy.RELIABLE, DurabilityPolicy.TRANSIENT_LOCAL),
        ("/clock", ReliabilityPolicy.BEST_EFFORT, DurabilityPolicy.VOLATILE),
    ],
)
def test_quality_of_service(
    probe: Probe, topic: str, reliability: ReliabilityPolicy, durability: DurabilityPolicy
) -> None:
    """Images match subscribers of every kind, the state is latched, the clock is best effort."""

    def own() -> list[object]:
        found = probe.node.get_publishers_info_by_topic(topic)
        return [p for p in found if p.node_name == "sim_node" and p.node_namespace == NAMESPACE]

    until(own, f"a publisher of {topic}")
    [publisher] = own()
    assert publisher.qos_profile.reliability == reliability  # type: ignore[attr-defined]
    assert publisher.qos_profile.durability == durability  # type: ignore[attr-defined]


# -- frames --------------------------------------------------------------------------------


def test_one_stamp_and_the_promised_encodings(probe: Probe) -> None:
    """A streamed frame has one stamp and one frame_id; its images look as the interface says."""
    topics = [
        probe.listen(FrameInfo, "agent/frame_info"),
        probe.listen(CameraInfo, "agent/camera_info"),
        *(probe.listen(Image, f"agent/{view}") for view in VIEWS),
    ]

    def common() -> set[int]:
        return set.intersection(*(set(topic.stamps()) for topic in topics))

    # The first frame may be the agent's very first, which has no frame before it.
    step_until(probe, lambda: len(common()) > 1, "two stamps that all topics have")
    stamp = max(common())
    at = {topic.name: topic.messages[topic.stamps().index(stamp)] for topic in topics}
    assert {m.header.frame_id for m in at.values()} == {"agent/camera_optical_frame"}
    for view, spec in VIEWS.items():
        image = at[f"agent/{view}"]
        stored = 1 if spec.dtype == np.bool_ else spec.dtype.itemsize
        assert (image.width, image.height, image.encoding) == (160, 120, spec.encoding)
        assert image.step == 160 * spec.channels * stored
        assert len(image.data) == image.step * 120
        assert image.is_bigendian == 0
    info = at["agent/frame_info"]
    assert (info.agent, info.scene) == ("agent", "optical")
    assert info.dt_ns in (33_333_333, 33_333_334)
    assert list(info.views) == list(RENDERED_VIEWS)


def test_the_tree_of_frames_leads_to_the_camera(probe: Probe) -> None:
    """/tf and /tf_static, as tf2 multiplies them, are the pose that the frame tells."""
    fixed = probe.listen(TFMessage, "/tf_static", LATCHED)
    moving = probe.listen(TFMessage, "/tf")
    info = probe.listen(FrameInfo, "agent/frame_info")
    boxes = probe.listen(Detection3DArray, "agent/detections_3d")

    def told() -> set[int]:
        stamps = {ns_from_stamp(m.transforms[0].header.stamp) for m in moving.messages}
        return stamps & set(info.stamps()) & set(boxes.stamps())

    step_until(probe, lambda: fixed.messages and told(), "transforms of a frame")
    stamp = max(told())
    links = {
        (one.header.frame_id, one.child_frame_id): one.transform
        for message in (*fixed.messages, *moving.messages)
        for one in message.transforms
        if message in fixed.messages or ns_from_stamp(one.header.stamp) == stamp
    }
    chain = ("world", "agent", "agent/camera_frame", "agent/camera_optical_frame")
    product = np.eye(4)
    for link in itertools.pairwise(chain):
        at, turn = links[link].translation, links[link].rotation
        product = product @ Pose((at.x, at.y, at.z), (turn.x, turn.y, turn.z, turn.w)).matrix()
    true = info.messages[info.stamps().index(stamp)].camera_pose
    np.testing.assert_allclose(product, pose_from_msg(true).matrix(), atol=1e-9)
    seen = boxes.messages[boxes.stamps().index(stamp)]
    assert seen.header.frame_id == chain[-1]
    assert all(one.bbox.center.position.z > 0.0 for one in seen.detections)
    assert seen.detections


def test_the_motion_to_the_next_frame_comes_with_it(probe: Probe) -> None:
    """One frame late, each once, with its own frame's stamp; where it ends is where flow began."""
    flow = probe.listen(Image, "agent/flow")
    # Discovery may take longer for one topic than for the other.
    step_until(probe, lambda: flow.messages, "a frame's flow")
    late = probe.listen(Image, "agent/flow_forward")
    step_until(probe, lambda: len(late.messages) > 2, "three motions")
    first, second = late.stamps()[-2:]
    assert second - first in (33_333_333, 33_333_334)
    until(lambda: max(flow.stamps()) > max(late.stamps()), "the last frame's flow")
    assert set(late.stamps()) < set(flow.stamps())
    forward = np.frombuffer(late.last.data, np.float32)
    assert np.isfinite(forward).mean() > 0.9
    assert np.nanmax(np.abs(forward)) > 0.01


def test_streamed_frames_come_at_the_agents_rate(probe: Probe) -> None:
    """At 30 Hz a frame falls due every 8 steps of 1/240 s, and each one arrives."""
    depth = probe.listen(Image, "agent/depth")
    step_until(probe, lambda: depth.messages, "the first frame")
    for _ in range(5):
        known = len(depth.messages)
        probe.done(Step, "step", Step.Request(steps=8))
        until(lambda known=known: len(depth.messages) > known, "the frame of this step")  # type: ignore[misc]
    assert set(np.diff(depth.stamps()[-5:])) <= {33_333_333, 33_333_334}


def test_camera_info_projects_a_body_onto_its_pixels(probe: Probe) -> None:
    """K and the camera's pose put the centre of the red cube on the pixels of its id."""
    scene = probe.listen(SceneInfo, "scene_info", LATCHED)
    until(lambda: scene.messages, "scene_info")
    ids = {instance.name: instance.id for instance in scene.last.instances}
    centre = np.array([0.0, 0.0, 1.25])
    with Eye(probe, ("instance", "depth")) as eye:
        for position in ((4.4, 0.0, 1.8), (1.0, 1.5, 5.0), (-1.5, -1.0, 4.5)):
            pose = look_at(position, centre + np.array([0.3, 0.2, -0.2]))
            probe.done(SetPose, "eye/set_pose", SetPose.Request(pose=pose_to_msg(pose)))
            views = eye.capture()
            camera = pose_from_msg(eye.frame_info.last.camera_pose).matrix()
            x, y, z = (invert(camera) @ np.append(centre, 1.0))[:3]
            k = np.asarray(eye.camera_info.last.k).reshape(3, 3)
            column, row = round(k[0, 0] * x / z + k[0, 2]), round(k[1, 1] * y / z + k[1, 2])
            assert views["instance"][row, column] == ids["red cube"]
            # A cube of 1.1 m has its surface from 0.55 m to 0.953 m before its centre.
            assert z - 0.55 * np.sqrt(3.0) <= views["depth"][row, column] <= z - 0.55 + 1e-4


# -- nothing unwanted ----------------------------------------------------------------------


def test_nothing_is_rendered_while_nobody_subscribes(probe: Probe) -> None:
    """A second of simulated time without subscribers renders no frame at all."""
    before = probe.done(Capture, "agent/capture", Capture.Request(views=["depth"])).sequence
    probe.done(Step, "step", Step.Request(steps=240))
    after = probe.done(Capture, "agent/capture", Capture.Request(views=["depth"])).sequence
    assert after == before + 1


def test_only_views_that_are_subscribed_to_are_published(probe: Probe) -> None:
    """A subscriber of depth alone gets frames that hold nothing else."""
    depth = probe.listen(Image, "agent/depth")
    info = probe.listen(FrameInfo, "agent/frame_info")
    step_until(probe, lambda: depth.messages and info.messages, "a frame")
    assert {tuple(message.views) for message in info.messages if message.views} == {("depth",)}


def test_infos_come_without_images(probe: Probe) -> None:
    """Who subscribes to camera_info alone gets one for each frame."""
    camera_info = probe.listen(CameraInfo, "agent/camera_info")
    step_until(probe, lambda: len(camera_info.messages) >= 2, "two infos")
    message = camera_info.last
    assert (message.width, message.height, message.distortion_model) == (160, 120, "plumb_bob")
    assert message.k[2] == 79.5
    assert message.k[5] == 59.5


def test_pose_comes_without_images(probe: Probe) -> None:
    """Who subscribes to the pose alone is told of every move."""
    pose = probe.listen(PoseStamped, "agent/pose")
    probe.done(SetFollow, "agent/set_follow", SetFollow.Request(following=False))
    step_until(probe, lambda: pose.messages, "a pose")
    target = SetPosition.Request()
    target.position.x, target.position.y, target.position.z = 3.0, 2.0, 1.0
    probe.done(SetPosition, "agent/set_position", target)
    until(lambda: pose.last.pose.position == target.position, "the pose that was set")
    assert pose.last.header.frame_id == "world"


# -- state ---------------------------------------------------------------------------------


def test_scene_info_is_there_for_those_who_come_late(probe: Probe) -> None:
    """The last state is kept for new subscribers, and comes again, newer, at every change."""
    scene = probe.listen(SceneInfo, "scene_info", LATCHED)
    until(lambda: scene.messages, "the kept scene_info")
    info = scene.last
    assert (info.scene, info.mode, info.paused) == ("optical", "lockstep", False)
    assert [agent.name for agent in info.agents] == ["agent"]
    assert {"red cube", "floor", "teal cylinder"} <= {i.name for i in info.instances}
    assert {i.category for i in info.instances} <= {c.name for c in info.categories}
    probe.done(SetFollow, "agent/set_follow", SetFollow.Request(following=False))
    until(lambda: scene.last.revision > info.revision, "a newer scene_info")
    assert not scene.last.agents[0].following


def test_clock_follows_the_simulation(probe: Probe) -> None:
    """/clock tells the time after each step, and goes back only when the scene begins anew."""
    clock = probe.listen(Clock, "/clock", BEST_EFFORT)
    times = [0]
    for _ in range(3):
        answer = probe.done(Step, "step", Step.Request(steps=24))
        times.append(ns_from_stamp(answer.stamp))
        step_until(probe, lambda: clock.messages, "the clock")
    heard = [ns_from_stamp(message.clock) for message in clock.messages]
    assert heard == sorted(heard)
    answer = probe.done(Step, "step", Step.Request(steps=24))
    now = ns_from_stamp(answer.stamp)
    until(lambda: ns_from_stamp(clock.last.clock) == now, "the clock of the last step")
    probe.done(Reset, "reset", Reset.Request(keep_seed=True))
    until(lambda: ns_from_stamp(clock.last.clock) == 0, "the clock of a new beginning")


# -- agents --------------------------------------------------------------------------------


def test_agents_of_different_size_and_rate_live_side_by_side(probe: Probe) -> None:
    """An agent's topics come with its registration and go with it; the others do not notice."""
    wanted = AgentInfo(name="tall", width=40, height=64, rate_hz=60.0)
    answer = probe.done(RegisterAgent, "register_agent", RegisterAgent.Request(agent=wanted))
    assert (answer.accepted.width, answer.accepted.mover) == (40, "mover")
    tall = probe.listen(Image, "tall/category")
    first = probe.listen(Image, "agent/category")
    step_until(probe, lambda: len(tall.messages) > 2 and first.messages, "frames of both")
    assert (tall.last.width, tall.last.height) == (40, 64)
    assert (first.last.width, first.last.height) == (160, 120)
    apart_ns = np.diff(tall.stamps())
    periods = np.rint(apart_ns * 60 / 1e9)
    # A busy machine may lose a frame between two.
    assert periods.min() == 1
    np.testing.assert_allclose(apart_ns, periods * 1e9 / 60, atol=1.0)
    probe.done(DeleteAgent, "delete_agent", DeleteAgent.Request(name="tall"))
    gone = f"{NAMESPACE}/tall/category"
    until(lambda: not probe.node.get_publishers_info_by_topic(gone), "the topic to go")
    known = len(first.messages)
    step_until(probe, lambda: len(first.messages) > known, "another frame of the first agent")


def test_frames_never_outrun_scene_info(probe: Probe) -> None:
    """After a change of scene the frames carry the epoch and ids that scene_info announced."""
    scene = probe.listen(SceneInfo, "scene_info", LATCHED)
    with Eye(probe, ("instance",), following=True) as eye:
        for name in ("object_view", "optical"):
            probe.done(ChangeScene, "change_scene", ChangeScene.Request(scene=name))
            views = eye.capture()
            info = eye.frame_info.last
            until(lambda info=info: scene.last.revision >= info.revision, "its scene_info")  # type: ignore[misc]
            assert (info.scene, info.epoch) == (name, scene.last.epoch)
            known = {0} | {instance.id for instance in scene.last.instances}
            assert set(np.unique(views["instance"])) <= known


def test_a_capture_of_no_named_views_has_the_agents_own(probe: Probe) -> None:
    """The views that an agent was registered with are those of its frames."""
    with Eye(probe, ("depth", "normals"), views=["normals", "depth"]) as eye:
        eye.capture()
        answer = probe.done(Capture, "eye/capture", Capture.Request())
        assert list(answer.views_published) == ["depth", "normals"]
