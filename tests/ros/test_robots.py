"""Robots over DDS: an Agent that has one, and the topics that Nav2 and ros2_control read."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import pytest
from geometry_msgs.msg import Twist
from nav_msgs.msg import OccupancyGrid, Odometry
from sensor_msgs.msg import Imu, JointState, LaserScan
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from sailenv_msgs.srv import GetRobot, Step
from sailenv_msgs_py.stamps import ns_from_stamp
from sailenv_ros import Agent
from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.types.geometry import Pose
from tests.support.probed_scene import probed_scene
from tests.support.robot_files import ARM, CART, CART_BEFORE_A_WALL
from tests.support.ros_probe import LATCHED, Probe
from tests.support.waiting import until

pytestmark = pytest.mark.ros

NAMESPACE = "/robots"
SCENE = f"""{CART_BEFORE_A_WALL}\
    position: [0, 1, 0]
    sensors:
      - {{name: scan, type: lidar, position: [0, 0, 0.15], rate: 20, rays: 4}}
      - {{name: imu, type: imu, rate: 60}}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("scenes")
    for name, text in (("arm", ARM), ("cart", CART)):
        (folder / f"{name}.urdf").write_text(text, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def probe(folder: Path) -> Iterator[Probe]:
    """A participant beside a lockstep simulator of a cart."""
    with probed_scene(folder, SCENE, NAMESPACE) as probe:
        yield probe


def step(probe: Probe, count: int) -> None:
    probe.done(Step, "step", Step.Request(steps=count))


def test_topics_of_a_cart_are_those_that_nav2_reads(probe: Probe) -> None:
    """It is driven by cmd_vel; odometry, scan, map, frames and description follow."""
    step(probe, 1)
    odom = probe.listen(Odometry, "cart/odom")
    scans = probe.listen(LaserScan, "cart/scan")
    imu = probe.listen(Imu, "cart/imu")
    maps = probe.listen(OccupancyGrid, "cart/map", LATCHED)
    texts = probe.listen(String, "cart/robot_description", LATCHED)
    moving = probe.listen(TFMessage, "/tf")
    fixed = probe.listen(TFMessage, "/tf_static", LATCHED)
    driving = probe.node.create_publisher(Twist, "cart/cmd_vel", 1)

    def driven() -> bool:
        driving.publish(Twist(linear=_vector(0.5)))
        step(probe, 12)
        heard = (odom, scans, imu, maps, texts, moving, fixed)
        told = all(one.messages for one in heard)
        return told and odom.messages[-1].twist.twist.linear.x > 0.45

    until(driven, "a cart that drives, and all of its topics")
    place = odom.messages[-1]
    assert (place.header.frame_id, place.child_frame_id) == ("cart/odom", "cart/chassis")
    assert place.pose.pose.position.x > 0.05
    assert abs(place.pose.pose.position.y) < 0.01  # from where it began
    scan = scans.messages[-1]
    assert scan.header.frame_id == "cart/scan"
    # Rays at -180, -90, 0 and 90 degrees; the third one meets the wall, whose face is at 2.9 m.
    assert len(scan.ranges) == 4
    assert math.isinf(scan.ranges[0])
    driven_to = {ns_from_stamp(one.header.stamp): one.pose.pose.position.x for one in odom.messages}
    seen = [
        (driven_to[ns_from_stamp(one.header.stamp)], one.ranges[2])
        for one in scans.messages
        if ns_from_stamp(one.header.stamp) in driven_to
    ]
    assert seen
    for x, distance in seen:
        assert x + distance == pytest.approx(2.9, abs=0.02)
    assert imu.messages[-1].linear_acceleration.z == pytest.approx(9.81, abs=0.2)
    grid = maps.messages[-1]
    assert grid.header.frame_id == "map"
    cells = dict.fromkeys(grid.data)
    assert {0, 100} <= set(cells)
    column = round((0.0 - grid.info.origin.position.x) / grid.info.resolution)
    row = round((1.0 - grid.info.origin.position.y) / grid.info.resolution)
    assert grid.data[row * grid.info.width + column] == 0  # the cart itself is no obstacle
    assert "<robot" in texts.messages[-1].data
    frames = {t.child_frame_id: t.header.frame_id for m in fixed.messages for t in m.transforms}
    assert frames["map"] == "world"
    assert frames["cart/odom"] == "map"
    assert frames["cart/base_link"] == "cart/chassis"
    assert frames["cart/scan"] == "cart/chassis"
    links = {t.child_frame_id: t.header.frame_id for m in moving.messages for t in m.transforms}
    assert links["cart/chassis"] == "cart/odom"
    assert links["cart/front_left"] == "cart/chassis"


def test_an_agent_has_the_same_as_a_simulation(probe: Probe, folder: Path) -> None:
    with Agent(namespace=NAMESPACE, width=64, height=48) as agent:
        bent = {"joints": [{"name": "elbow", "position": 0.5}]}
        name = agent.spawn_robot(str(folder / "arm.urdf"), (1, -2, 0), settings=bent)
        assert name == "arm"
        assert agent.get_robots() == ("cart", "arm")
        agent.drive_joints({"shoulder": 0.6}, robot="arm", speed=2.0)
        agent.step(240)
        state = agent.get_robot("arm")
        places = {joint.name: joint.position for joint in state.joints}
        assert places["shoulder"] == pytest.approx(0.6, abs=1e-3)
        assert agent.instances[state.links["upper"]].category == "robot"
        straight = agent.link_pose("tip", {"shoulder": 0.0, "elbow": 0.0}, robot="arm")
        assert straight.position_m == pytest.approx((1.0, -2.0, 1.1), abs=1e-9)
        goal = agent.link_pose("tip", {"elbow": 1.0}, robot="arm")
        found = agent.reach_pose("tip", goal, robot="arm")
        assert found["elbow"] == pytest.approx(1.0, abs=1e-2)
        agent.put_joints({"elbow": 0.1}, robot="arm")
        with pytest.raises(UnknownName, match="joint"):
            agent.drive_joints({"neck": 0.0}, robot="arm")
        with pytest.raises(InvalidRequest, match="elbow"):
            agent.drive_joints({"elbow": 3.0}, robot="arm")
        agent.drive_robot(0.2, 0.1, robot="cart", seconds=1.0)
        assert agent.get_robot("cart").command == pytest.approx((0.2, 0.0, 0.1))
        assert "<robot" in agent.robot_description("arm")
        scan = agent.get_scan(robot="cart")
        assert len(scan.ranges_m) == 4
        assert isinstance(scan.pose, Pose)
        assert agent.get_inertial(robot="cart").acceleration_m_s2[2] == pytest.approx(9.81, abs=0.2)
        heard = probe.listen(JointState, "arm/joint_states")
        commands = probe.node.create_publisher(JointState, "arm/joint_commands", 1)

        def followed() -> bool:
            commands.publish(JointState(name=["shoulder", "elbow"], position=[-0.3, math.nan]))
            step(probe, 24)
            if not heard.messages:
                return False
            last = heard.messages[-1]
            return bool(abs(last.position[last.name.index("shoulder")] + 0.3) < 1e-3)

        until(followed, "an arm that follows joint_commands")
        agent.despawn_robot("arm")
        assert agent.get_robots() == ("cart",)
    answer = probe.call(GetRobot, "get_robot", GetRobot.Request(robot="arm"))
    assert not answer.success
    assert "robot" in answer.message


def _vector(x: float) -> object:
    vector = Twist().linear
    vector.x = x
    return vector
