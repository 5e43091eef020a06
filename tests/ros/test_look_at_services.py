"""Look-at constraints over DDS: both services, an Agent with the calls of a Simulation."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pytest
from geometry_msgs.msg import Point

from sailenv_msgs.srv import (
    DespawnObject,
    GetMoverPose,
    GetPose,
    SetLookAt,
    SetMoverLookAt,
    SetRotation,
    Step,
)
from sailenv_ros import Agent
from sailenv_ros.errors import UnknownName
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.look_at import LookAt
from tests.support.probed_scene import probed_scene
from tests.support.ros_probe import Probe

pytestmark = pytest.mark.ros

NAMESPACE = "/look_at_services"
SCENE = """
version: 1
gravity: [0, 0, 0]
objects:
  - {name: post, asset: cube, position: [3, 3, 1], static: true}
  - {name: ball, asset: sphere, position: [2, 0, 1], scale: 0.3, gravity: false,
     velocity: [0, 1, 0]}
mover: {position: [0, 0, 1], controller: rigidbody}
agents:
  - {name: eye, width: 16, height: 12, following: false, position: [0, 0, 1]}
"""


@pytest.fixture(scope="module")
def probe(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Probe]:
    """A participant beside a lockstep simulator of a ball that drifts."""
    with probed_scene(tmp_path_factory.mktemp("scenes"), SCENE, NAMESPACE) as probe:
        yield probe


def yaw_of(probe: Probe) -> float:
    return float(probe.done(GetPose, "eye/get_pose", GetPose.Request()).yaw_deg)


def test_an_agent_faces_an_object_a_point_and_nothing(probe: Probe) -> None:
    """By id: where it is after each step, and where it was when it is gone; then by a point."""
    probe.done(SetLookAt, "eye/set_look_at", SetLookAt.Request(id=2))
    assert yaw_of(probe) == pytest.approx(0.0, abs=1e-9)
    probe.done(Step, "step", Step.Request(steps=120))
    there = math.degrees(math.atan2(0.5, 2.0))
    assert yaw_of(probe) == pytest.approx(there, abs=0.1)
    probe.done(DespawnObject, "despawn_object", DespawnObject.Request(id=2))
    probe.done(Step, "step", Step.Request(steps=120))
    assert yaw_of(probe) == pytest.approx(there, abs=0.1)
    point = SetLookAt.Request(point=Point(x=0.0, y=-4.0, z=1.0))
    probe.done(SetLookAt, "eye/set_look_at", point)
    assert yaw_of(probe) == pytest.approx(-90.0, abs=1e-9)
    turn = SetRotation.Request(yaw_deg=12.0)
    probe.done(SetRotation, "eye/set_rotation", turn)
    assert yaw_of(probe) == pytest.approx(12.0, abs=1e-9)
    probe.done(SetLookAt, "eye/set_look_at", point)
    # What else a release says means nothing.
    probe.done(SetLookAt, "eye/set_look_at", SetLookAt.Request(release=True, id=999))
    assert yaw_of(probe) == pytest.approx(-90.0, abs=1e-9)
    answer = probe.call(SetLookAt, "eye/set_look_at", SetLookAt.Request(id=999))
    assert not answer.success
    assert "999" in answer.message
    answer = probe.call(SetLookAt, "eye/set_look_at", SetLookAt.Request(point=Point(x=math.inf)))
    assert not answer.success
    assert yaw_of(probe) == pytest.approx(-90.0, abs=1e-9)


def test_a_mover_faces_a_point_of_an_object(probe: Probe) -> None:
    request = SetMoverLookAt.Request(id=1, point=Point(x=-3.0))
    probe.done(SetMoverLookAt, "set_mover_look_at", request)
    turned = probe.done(GetMoverPose, "get_mover_pose", GetMoverPose.Request()).pose.orientation
    half = math.sqrt(0.5)
    assert (turned.x, turned.y) == pytest.approx((0.0, 0.0), abs=1e-12)
    assert (turned.z, turned.w) == pytest.approx((half, half), abs=1e-12)
    request.mover = "nobody"
    assert "nobody" in probe.call(SetMoverLookAt, "set_mover_look_at", request).message


def test_an_agent_has_the_calls_of_a_simulation(probe: Probe) -> None:
    with Agent(name="looker", namespace=NAMESPACE, following=False) as agent:
        agent.set_pose(agent.get_pose())
        agent.set_position((3.0, 0.0, 1.0))
        agent.set_look_at("post")
        assert agent.get_rotation() == pytest.approx((0.0, 0.0, 90.0), abs=1e-9)
        agent.set_look_at("post", point_m=(0.0, 0.0, 3.0))
        assert agent.get_rotation() == pytest.approx((0.0, -45.0, 90.0), abs=1e-9)
        agent.set_look_at()
        agent.set_position((0.0, 0.0, 1.0))
        assert agent.get_rotation() == pytest.approx((0.0, -45.0, 90.0), abs=1e-9)
        agent.set_mover_look_at(point_m=(-5.0, 0.0, 1.0))
        assert abs(agent.get_mover_pose().rpy_deg[2]) == pytest.approx(180.0, abs=1e-9)
        agent.set_mover_look_at()
        with pytest.raises(UnknownName):
            agent.set_look_at("pots")
        faces = LookAt(obj="post", point_m=(0.0, 0.0, 0.5))
        agent.register_agent(AgentSpec(name="other", look_at=faces))
        assert agent.get_look_at(agent="other") == faces
        agent.delete_agent("other")


def test_what_is_faced_is_announced(probe: Probe) -> None:
    """In the latched scene_info that the response's revision names, and by the agent's methods."""
    with Agent(name="onlooker", namespace=NAMESPACE, following=False) as agent:
        assert agent.get_look_at() is None
        agent.set_look_at("post", point_m=(0.0, 0.0, 0.5))
        assert agent.get_look_at() == LookAt(obj="post", point_m=(0.0, 0.0, 0.5))
        (told,) = (spec for spec in agent.info.agents if spec.name == "onlooker")
        assert told.look_at == agent.get_look_at()
        agent.set_rotation((0.0, 0.0, 5.0))
        assert agent.get_look_at() is None
        agent.set_mover_look_at(point_m=(-5.0, 0.0, 1.0))
        assert agent.get_mover_look_at() == LookAt(point_m=(-5.0, 0.0, 1.0))
        agent.set_mover_look_at()
        assert agent.get_mover_look_at() is None
