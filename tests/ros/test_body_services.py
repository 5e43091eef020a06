"""Movers that are bodies, over ROS: services, what is announced, and an agent that is carried."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pytest
from geometry_msgs.msg import Vector3

from sailenv_msgs.msg import RigidBody as RigidBodyMsg
from sailenv_msgs.srv import ApplyWrench, GetMoverVelocity, SetMoverBody, Step
from sailenv_ros import Agent
from sailenv_ros.errors import InvalidRequest, InvalidState, UnknownName
from sailenv_ros.types.rigid_body import RigidBody
from tests.support.probed_scene import probed_scene
from tests.support.ros_probe import Probe

NAMESPACE = "/body_services"

SCENE = """
version: 1
movers:
  - name: ball
    position: [0, 0, 1]
    body: {mass: 0.5, drag: 0.0, restitution: 0.5, gravity: false}
  - {name: cart, position: [0, 3, 1]}
objects:
  - {name: wall, asset: cube, position: [2, 0, 1], static: true}
"""


@pytest.fixture(scope="module")
def probe(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Probe]:
    """A participant beside a lockstep simulator of a ball before a wall."""
    with probed_scene(tmp_path_factory.mktemp("scenes"), SCENE, NAMESPACE) as probe:
        yield probe


def speed(probe: Probe, mover: str) -> float:
    request = GetMoverVelocity.Request(mover=mover)
    return float(probe.done(GetMoverVelocity, "get_mover_velocity", request).velocity.linear.x)


def test_services_make_push_and_tell_of_a_body(probe: Probe) -> None:
    """6 N for 0.1 s on 3 kg are 0.2 m/s; what cannot be is refused in a sentence."""
    body = RigidBodyMsg(mass_kg=3.0, gravity=False)
    probe.done(SetMoverBody, "set_mover_body", SetMoverBody.Request(mover="cart", body=body))
    push = ApplyWrench.Request(mover="cart", force_n=Vector3(x=6.0), duration_s=0.1)
    probe.done(ApplyWrench, "apply_wrench", push)
    probe.done(Step, "step", Step.Request(steps=60))
    assert speed(probe, "cart") == pytest.approx(0.2, abs=1e-9)
    push.id = 1
    assert "mover" in probe.call(ApplyWrench, "apply_wrench", push).message
    body.mass_kg = 0.0
    refused = SetMoverBody.Request(mover="cart", body=body)
    assert "mass_kg" in probe.call(SetMoverBody, "set_mover_body", refused).message
    assert speed(probe, "cart") == pytest.approx(0.2, abs=1e-9)
    release = SetMoverBody.Request(mover="cart", release=True)
    probe.done(SetMoverBody, "set_mover_body", release)
    asked = GetMoverVelocity.Request(mover="cart")
    answer = probe.call(GetMoverVelocity, "get_mover_velocity", asked)
    assert "set_mover_body" in answer.message


def test_an_agent_rides_on_a_body_and_feels_it_strike(probe: Probe) -> None:
    """It is carried, bounces off the wall and faces it meanwhile, by the simulation's calls."""
    with Agent(name="rider", namespace=NAMESPACE) as agent:
        begun = agent.movers["ball"].body
        assert begun == RigidBody(mass_kg=0.5, restitution=0.5, gravity=False)
        assert agent.movers["cart"].body is None
        agent.set_mover_look_at("wall")
        agent.contacts()
        agent.apply_wrench("ball", force_n=(0.0, 0.6, 0.0))
        agent.apply_wrench("ball", force_n=(240.0, 0.0, 0.0))
        agent.step(120)
        assert agent.get_mover_velocity("ball")[0][0] == pytest.approx(2.0, abs=1e-9)
        agent.step(120)
        (contact,) = agent.contacts(1.0)
        assert (contact.first, contact.mover) == (0, "ball")
        linear, angular = agent.get_mover_velocity("ball")
        assert linear[0] == pytest.approx(-1.0, abs=1e-6)
        assert angular == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)
        pose = agent.get_pose()
        assert pose.position_m == agent.get_mover_pose("ball").position_m
        way = math.degrees(math.atan2(-pose.position_m[1], 2.0 - pose.position_m[0]))
        assert pose.rpy_deg[2] == pytest.approx(way, abs=1e-6)
        with pytest.raises(InvalidState, match="apply_wrench"):
            agent.drive_mover((1.0, 0.0, 0.0), mover="ball")
        with pytest.raises(InvalidState, match="set_mover_body"):
            agent.set_mover_controller("waypoint", "ball")
        with pytest.raises(InvalidState, match="set_mover_body"):
            agent.apply_wrench("cart", force_n=(1.0, 0.0, 0.0))
        with pytest.raises(UnknownName):
            agent.apply_wrench("bell", force_n=(1.0, 0.0, 0.0))
        with pytest.raises(InvalidRequest, match="RigidBody"):
            agent.set_mover_body(0.5, "ball")  # type: ignore[arg-type]  # what is refused
        agent.set_mover_body(None, "ball")
        assert agent.movers["ball"].body is None
        stays = agent.get_position()
        agent.step(24)
        assert agent.get_position() == stays
