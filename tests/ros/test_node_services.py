"""Services of sim_node over real DDS: what they do, and that a refusal changes nothing."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Point, Pose, Quaternion
from rcl_interfaces.srv import DescribeParameters, ListParameters, SetParameters
from rclpy.parameter import Parameter

from sailenv_msgs.msg import AgentInfo, SceneInfo
from sailenv_msgs.srv import (
    Capture,
    ChangeScene,
    DeleteAgent,
    GetPose,
    Pause,
    RegisterAgent,
    Reset,
    Resume,
    SetFollow,
    SetPose,
    SetPosition,
    SetRotation,
    Step,
    ToggleFollow,
)
from sailenv_msgs_py.stamps import ns_from_stamp
from tests.support.ros_probe import LATCHED, Eye, Probe, Topic
from tests.support.sim_node_process import NodeProcess
from tests.support.waiting import until

pytestmark = pytest.mark.ros

NAMESPACE = "/services"
ALL = ("rgb", "depth", "category", "instance", "flow")
NAN, INF = math.nan, math.inf


@pytest.fixture(scope="module")
def node() -> Iterator[NodeProcess]:
    """A lockstep simulator with one small agent."""
    with NodeProcess(
        NAMESPACE, mode="lockstep", agent__width=160, agent__height=120, agent__following=False
    ) as node:
        yield node


@pytest.fixture
def scene(probe: Probe) -> Topic:
    """scene_info, as it is and as it changes."""
    topic = probe.listen(SceneInfo, "scene_info", LATCHED)
    until(lambda: topic.messages, "scene_info")
    return topic


# -- good requests -------------------------------------------------------------------------


def test_an_agent_is_registered_as_asked(probe: Probe, scene: Topic) -> None:
    """A name alone gets the defaults, and scene_info names the new agent until it is deleted."""
    answer = probe.done(
        RegisterAgent, "register_agent", RegisterAgent.Request(agent=AgentInfo(name="second"))
    )
    accepted = answer.accepted
    assert (accepted.width, accepted.height, accepted.rate_hz) == (640, 480, 30.0)
    assert (list(accepted.views), accepted.mover) == (list(ALL), "mover")
    until(lambda: accepted in scene.last.agents, "the agent in scene_info")
    probe.done(DeleteAgent, "delete_agent", DeleteAgent.Request(name="second"))
    until(lambda: [a.name for a in scene.last.agents] == ["agent"], "the agent to go")


def test_an_agent_starts_where_it_was_asked_to(probe: Probe) -> None:
    """A pose in the registration is the agent's first pose."""
    request = RegisterAgent.Request(
        agent=AgentInfo(name="placed", following=False), has_pose=True, pose=pose(1.0, -2.0, 3.0)
    )
    probe.done(RegisterAgent, "register_agent", request)
    here = probe.done(GetPose, "placed/get_pose")
    probe.done(DeleteAgent, "delete_agent", DeleteAgent.Request(name="placed"))
    assert here.pose.pose == request.pose
    assert here.pose.header.frame_id == "world"


def test_position_rotation_and_pose_are_set(probe: Probe) -> None:
    """Each sets its own part and leaves the other; what is set is what is read."""
    probe.done(SetPose, "agent/set_pose", SetPose.Request(pose=pose(1.0, 2.0, 3.0)))
    turn = SetRotation.Request(roll_deg=10.0, pitch_deg=-20.0, yaw_deg=130.0)
    probe.done(SetRotation, "agent/set_rotation", turn)
    place = SetPosition.Request(position=Point(x=-1.0, y=0.5, z=1.5))
    probe.done(SetPosition, "agent/set_position", place)
    here = probe.done(GetPose, "agent/get_pose")
    assert here.pose.pose.position == place.position
    assert (here.roll_deg, here.pitch_deg, here.yaw_deg) == pytest.approx((10.0, -20.0, 130.0))
    assert (here.following, here.mover) == (False, "mover")


def test_following_is_set_and_toggled(probe: Probe, scene: Topic) -> None:
    """An agent that follows is where its mover is; the answer says the new state."""
    assert probe.done(ToggleFollow, "agent/toggle_follow").following
    first = probe.done(GetPose, "agent/get_pose")
    probe.done(Step, "step", Step.Request(steps=240))
    second = probe.done(GetPose, "agent/get_pose")
    assert first.following
    assert second.pose.pose.position != first.pose.pose.position
    answer = probe.done(SetFollow, "agent/set_follow", SetFollow.Request(following=False))
    assert not answer.following
    stands = probe.done(GetPose, "agent/get_pose").pose.pose
    probe.done(Step, "step", Step.Request(steps=240))
    assert probe.done(GetPose, "agent/get_pose").pose.pose == stands
    until(lambda: not scene.last.agents[0].following, "the state in scene_info")


def test_step_moves_time_by_its_steps(probe: Probe) -> None:
    """n steps are n/240 s of simulated time, to the nanosecond."""
    for total, steps in ((1, 1), (25, 24), (240, 215)):
        answer = probe.done(Step, "step", Step.Request(steps=steps))
        assert abs(ns_from_stamp(answer.stamp) - total * 1_000_000_000 / 240) < 1.0


def test_reset_begins_anew(probe: Probe, scene: Topic) -> None:
    """A reset goes back to time 0 in a new epoch; a seed that is given is the scene's from then."""
    probe.done(Step, "step", Step.Request(steps=48))
    before = scene.last.epoch
    answer = probe.done(Reset, "reset", Reset.Request(seed=7))
    until(lambda: scene.last.epoch == answer.epoch, "the new epoch")
    assert (answer.epoch, scene.last.seed) == (before + 1, 7)
    assert ns_from_stamp(probe.done(GetPose, "agent/get_pose").pose.header.stamp) == 0
    probe.done(Reset, "reset", Reset.Request(seed=0))


def test_the_scene_changes_and_agents_stay(probe: Probe, scene: Topic) -> None:
    """After change_scene there is another scene at time 0, seen by the same agents."""
    probe.done(ChangeScene, "change_scene", ChangeScene.Request(scene="object_view"))
    until(lambda: scene.last.scene == "object_view", "the scene in scene_info")
    assert "agent" in [agent.name for agent in scene.last.agents]
    with Eye(probe, ALL, following=True) as eye:
        views = eye.capture()
        assert len(np.unique(views["instance"])) > 1
        assert eye.frame_info.last.scene == "object_view"
    probe.done(ChangeScene, "change_scene", ChangeScene.Request(scene="optical"))


def test_set_poses_are_motion_and_teleports_are_none(probe: Probe) -> None:
    """Flow shows a pose that was set, and has no past after a teleport."""
    with Eye(probe, ("flow", "flow_valid"), has_pose=False) as eye:
        eye.capture()
        for teleport in (False, True):
            probe.done(Step, "step", Step.Request(steps=8))
            request = SetPose.Request(pose=pose(-4.0, 0.1 + teleport, 1.0), teleport=teleport)
            probe.done(SetPose, "eye/set_pose", request)
            views = eye.capture()
            assert bool(views["flow_valid"].any()) is not teleport
            assert bool(np.isfinite(views["flow"]).any()) is not teleport


def test_capture_counts_and_tells_what_went_out(probe: Probe) -> None:
    """Each capture is one frame; views that nobody subscribes to go nowhere, and it says so."""
    with Eye(probe, ("depth",)) as eye:
        eye.capture()
        request = Capture.Request(views=["rgb", "depth"])
        answer = probe.done(Capture, "eye/capture", request)
        assert (answer.sequence, list(answer.views_published)) == (2, ["depth"])


def test_realtime_is_paused_stepped_and_resumed() -> None:
    """A paused simulation stands still but for steps, and runs on by itself when resumed."""
    with NodeProcess("/realtime", paused=True, agent__name="") as _, Probe("/realtime") as probe:
        scene = probe.listen(SceneInfo, "scene_info", LATCHED)
        until(lambda: scene.messages and scene.last.paused, "a paused simulation")
        first = probe.done(Step, "step", Step.Request(steps=24))
        assert ns_from_stamp(first.stamp) == 100_000_000
        second = probe.done(Step, "step", Step.Request(steps=24))
        assert ns_from_stamp(second.stamp) == 200_000_000
        probe.done(Resume, "resume")
        until(lambda: not scene.last.paused, "a running simulation")
        refused = probe.call(Step, "step", Step.Request(steps=1))
        assert not refused.success
        assert "pause it before stepping" in refused.message
        probe.done(Pause, "pause")
        third = probe.done(Step, "step", Step.Request(steps=1))
        assert ns_from_stamp(third.stamp) > ns_from_stamp(second.stamp)


# -- bad requests --------------------------------------------------------------------------


def pose(x: float, y: float, z: float, quaternion: tuple[float, ...] = (0, 0, 0, 1)) -> Pose:
    qx, qy, qz, qw = (float(value) for value in quaternion)
    return Pose(position=Point(x=x, y=y, z=z), orientation=Quaternion(x=qx, y=qy, z=qz, w=qw))


def registration(**fields: Any) -> RegisterAgent.Request:
    return RegisterAgent.Request(agent=AgentInfo(**{"name": "other", **fields}))


BAD = [
    ("change_scene", ChangeScene, ChangeScene.Request(scene="opticle"), "did you mean 'optical'"),
    ("change_scene", ChangeScene, ChangeScene.Request(), "one of: "),
    ("register_agent", RegisterAgent, registration(width=0), "from 8 to 4096 [px], got 0"),
    ("register_agent", RegisterAgent, registration(height=100_000), "got 100000"),
    ("register_agent", RegisterAgent, registration(name="agent"), "not in use yet, got 'agent'"),
    ("register_agent", RegisterAgent, registration(name="No Name"), "got 'No Name'"),
    ("register_agent", RegisterAgent, registration(name=""), "a lower-case letter"),
    ("register_agent", RegisterAgent, registration(rate_hz=-1.0), "rate_hz must be"),
    ("register_agent", RegisterAgent, registration(rate_hz=NAN), "rate_hz must be"),
    ("register_agent", RegisterAgent, registration(views=["rgb", "smell"]), "got 'smell'"),
    ("register_agent", RegisterAgent, registration(mover="ghost"), "got 'ghost'"),
    ("register_agent", RegisterAgent, registration(near_m=200.0), "less than far_m"),
    ("register_agent", RegisterAgent, registration(vertical_fov_deg=INF), "vertical_fov_deg"),
    (
        "register_agent",
        RegisterAgent,
        RegisterAgent.Request(agent=AgentInfo(name="p"), has_pose=True, pose=pose(NAN, 0.0, 0.0)),
        "position must be three finite numbers",
    ),
    ("delete_agent", DeleteAgent, DeleteAgent.Request(name="ghost"), "one of: agent, got 'ghost'"),
    ("agent/set_position", SetPosition, SetPosition.Request(position=Point(x=NAN)), "finite"),
    ("agent/set_position", SetPosition, SetPosition.Request(position=Point(y=-INF)), "finite"),
    ("agent/set_position", SetPosition, SetPosition.Request(position=Point(z=1e9)), "±10000"),
    ("agent/set_rotation", SetRotation, SetRotation.Request(yaw_deg=NAN), "rotation"),
    ("agent/set_pose", SetPose, SetPose.Request(pose=pose(0.0, 0.0, INF)), "finite"),
    ("agent/set_pose", SetPose, SetPose.Request(pose=pose(0, 0, 0, (0, 0, 0, 2))), "unit length"),
    ("agent/set_pose", SetPose, SetPose.Request(pose=pose(0, 0, 0, (0, 0, 0, 0))), "unit length"),
    ("agent/set_pose", SetPose, SetPose.Request(pose=pose(0, 0, 0, (NAN, 0, 0, 1))), "unit"),
    ("agent/capture", Capture, Capture.Request(views=["deph"]), "did you mean 'depth'"),
    ("step", Step, Step.Request(steps=-1), "from 1 to 1000000, got -1"),
    ("step", Step, Step.Request(steps=0), "got 0"),
    ("step", Step, Step.Request(steps=2**62), "from 1 to 1000000"),
    ("reset", Reset, Reset.Request(seed=-1), "seed must be"),
    ("pause", Pause, Pause.Request(), "lockstep"),
    ("resume", Resume, Resume.Request(), "lockstep"),
]


@pytest.mark.parametrize(
    ("service", "kind", "request_", "sentence"),
    [pytest.param(*case, id=f"{case[0]}-{case[3]}") for case in BAD],
)
def test_a_bad_request_is_refused_in_one_sentence(
    probe: Probe, scene: Topic, service: str, kind: Any, request_: Any, sentence: str
) -> None:
    """It says what was wrong and what is accepted; poses, time and scene stay as they were."""
    probe.done(Step, "step", Step.Request(steps=8))
    before = state(probe, scene)
    answer = probe.call(kind, service, request_)
    assert not answer.success
    assert sentence in answer.message
    assert "\n" not in answer.message
    assert "Traceback" not in answer.message
    assert state(probe, scene) == before


def state(probe: Probe, scene: Topic) -> tuple[object, ...]:
    here = probe.done(GetPose, "agent/get_pose")
    return scene.last, here.pose, here.following


def test_a_refusal_leaves_every_pixel(probe: Probe) -> None:
    """Frames before and after a series of bad requests are the same bytes."""
    with Eye(probe, ALL, following=True) as eye:
        probe.done(Step, "step", Step.Request(steps=8))
        before = eye.capture()
        for service, kind, request, _ in BAD:
            assert not probe.call(kind, service, request).success
        after = eye.capture()
    for view in ALL:
        assert before[view].tobytes() == after[view].tobytes(), view


def test_services_of_an_agent_go_with_it(probe: Probe) -> None:
    """Nobody answers for an agent that was deleted, and its name is free again."""
    service = f"{NAMESPACE}/brief/capture"
    for width in (40, 80):
        with Eye(probe, ("depth",), name="brief", width=width, height=40) as eye:
            assert eye.capture()["depth"].shape == (40, width)
        until(lambda: service not in served(probe), "the service to go")


def served(probe: Probe) -> set[str]:
    return {
        name for name, _ in probe.node.get_service_names_and_types_by_node("sim_node", NAMESPACE)
    }


def test_a_long_request_holds_up_no_other_service(probe: Probe) -> None:
    """While the simulation works on a long step, the node answers what needs no simulation."""
    stepping = probe.begin(Step, "step", Step.Request(steps=6_000))
    names = probe.call(ListParameters, "sim_node/list_parameters")
    unknown = probe.call(RegisterAgent, "register_agent", registration(width=1))
    assert not stepping.done(), "the step ended before the others were answered"
    assert "scene" in names.result.names
    assert not unknown.success
    # Whatever needs the simulation is done after the step, in the order in which it was asked.
    then = probe.begin(Step, "step", Step.Request(steps=1))
    until(stepping.done, "the long step", 100.0)
    until(then.done, "the next step")
    assert stepping.result().success
    assert ns_from_stamp(then.result().stamp) > ns_from_stamp(stepping.result().stamp)


# -- parameters ----------------------------------------------------------------------------


def test_agents_that_come_and_go_leave_no_parameters(probe: Probe) -> None:
    """`rclpy` keeps what a publisher declares, for ever."""

    def names() -> list[str]:
        return sorted(probe.call(ListParameters, "sim_node/list_parameters").result.names)

    before = names()
    probe.done(RegisterAgent, "register_agent", registration(name="passing"))
    topic = f"{probe.namespace}/passing/rgb"
    until(lambda: probe.node.count_publishers(topic), "the agent's topics")
    assert names() == before
    probe.done(DeleteAgent, "delete_agent", DeleteAgent.Request(name="passing"))
    until(lambda: not probe.node.count_publishers(topic), "the agent's topics to end")
    assert names() == before


def test_every_parameter_is_described(probe: Probe) -> None:
    """Each parameter of ours has a description, and each number a range with it."""
    names = probe.call(ListParameters, "sim_node/list_parameters").result.names
    own = [n for n in names if n not in ("use_sim_time", "start_type_description_service")]
    request = DescribeParameters.Request(names=own)
    described = probe.call(DescribeParameters, "sim_node/describe_parameters", request).descriptors
    assert len(own) >= 20
    for descriptor in described:
        assert descriptor.description.endswith("."), descriptor.name
        live = descriptor.name in ("real_time_factor", "agent.rate_hz")
        assert descriptor.read_only != live, descriptor.name
        if descriptor.type == Parameter.Type.INTEGER.value:
            assert descriptor.integer_range, descriptor.name
        if descriptor.type == Parameter.Type.DOUBLE.value:
            assert descriptor.floating_point_range, descriptor.name


def test_a_parameter_that_cannot_change_says_so(probe: Probe) -> None:
    """Setting a parameter at run time is refused with a reason."""
    request = SetParameters.Request(
        parameters=[Parameter("mode", value="realtime").to_parameter_msg()]
    )
    [result] = probe.call(SetParameters, "sim_node/set_parameters", request).results
    assert not result.successful
    assert "read-only" in result.reason


def test_the_source_of_time_follows_no_clock(probe: Probe) -> None:
    """`use_sim_time` is refused in a sentence; false, as it is, is accepted."""
    for value in (True, False):
        asked = [Parameter("use_sim_time", value=value).to_parameter_msg()]
        request = SetParameters.Request(parameters=asked)
        [result] = probe.call(SetParameters, "sim_node/set_parameters", request).results
        assert result.successful != value
        assert ("source of simulated time" in result.reason) == value
