"""Joints over DDS: the services, the topic of sensor_msgs/JointState, an Agent that opens doors."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pytest
from sensor_msgs.msg import JointState

from sailenv_msgs.srv import GetJoints, SetJointPosition, Step
from sailenv_ros import Agent
from sailenv_ros.errors import InvalidRequest
from tests.support.plain_doors import SCENE
from tests.support.probed_scene import probed_scene
from tests.support.ros_probe import Probe
from tests.support.waiting import until

pytestmark = pytest.mark.ros

NAMESPACE = "/joint_services"


@pytest.fixture(scope="module")
def probe(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Probe]:
    """A participant beside a lockstep simulator of a cabinet."""
    with probed_scene(tmp_path_factory.mktemp("scenes"), SCENE, NAMESPACE) as probe:
        yield probe


def test_joints_are_told_set_and_refused(probe: Probe) -> None:
    """The door by its id, beyond its limits, what has no joint; then the topic tells of it."""
    heard = probe.listen(JointState, "joint_states")
    joints = probe.done(GetJoints, "get_joints", GetJoints.Request())
    assert (list(joints.names), list(joints.types)) == (["door", "drawer"], ["hinge", "slide"])
    assert (list(joints.parents), list(joints.highs)) == (["cabinet"] * 2, [1.5, 0.4])
    door = int(joints.ids[0])
    for number, wrong, says in ((door, 1.6, "0 to 1.5"), (door, math.nan, ""), (1, 0.1, "door")):
        request = SetJointPosition.Request(id=number, position=wrong)
        answer = probe.call(SetJointPosition, "set_joint_position", request)
        assert not answer.success
        assert says in answer.message
    request = SetJointPosition.Request(id=door, position=0.75, seconds=0.5)
    probe.done(SetJointPosition, "set_joint_position", request)
    probe.done(Step, "step", Step.Request(steps=130))
    assert probe.done(GetJoints, "get_joints", GetJoints.Request()).positions[0] == 0.75
    until(
        lambda: any(
            list(m.name) == ["door", "drawer"] and m.position[0] == 0.75 for m in heard.messages
        ),
        "the open door on its topic",
    )


def test_an_agent_opens_a_drawer(probe: Probe) -> None:
    """By the same calls as a Simulation's."""
    with Agent(namespace=NAMESPACE, width=64, height=48) as agent:
        agent.set_joint_position("drawer", 0.2)
        drawer = agent.get_joints()[1]
        assert (drawer.name, drawer.position, drawer.parent) == ("drawer", 0.2, "cabinet")
        with pytest.raises(InvalidRequest, match=r"0 to 0\.4"):
            agent.set_joint_position("drawer", 0.5)
