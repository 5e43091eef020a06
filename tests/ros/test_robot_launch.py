"""The launch file of robots: a simulator with its remappings has all that Nav2 and MoveIt read."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import yaml
from geometry_msgs.msg import Twist
from nav_msgs.msg import OccupancyGrid, Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState, LaserScan
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from tests.support.robot_files import CART, CART_BEFORE_A_WALL
from tests.support.ros_probe import BEST_EFFORT, LATCHED, Probe
from tests.support.sim_node_process import NodeProcess
from tests.support.waiting import until

pytestmark = pytest.mark.ros

ROOT = Path(__file__).parents[2]
NAMESPACE = "/launched"
SCENE = CART_BEFORE_A_WALL + "    sensors: [{name: scan, type: lidar, rays: 8}]\n"


class Declared:
    """What a launch file declares, and what it is given."""

    def __init__(self, *values: Any, **settings: Any) -> None:
        self.values, self.settings = values, settings


@pytest.fixture
def given(tmp_path: Path) -> dict[str, str]:
    """Arguments of the launch file."""
    (tmp_path / "cart.urdf").write_text(CART, encoding="utf-8")
    scene = tmp_path / "launched.yaml"
    scene.write_text(SCENE, encoding="utf-8")
    return {"scene": str(scene), "robot": "cart", "namespace": NAMESPACE}


@pytest.fixture
def nodes(given: dict[str, str], monkeypatch: pytest.MonkeyPatch) -> list[dict[str, Any]]:
    """The nodes that the launch file declares; launch is no part of what PyPI has of ROS."""
    names = {
        "LaunchDescription": list,
        "DeclareLaunchArgument": lambda name, **more: name,
        "LaunchConfiguration": given.__getitem__,
        "PathJoinSubstitution": "/".join,
        "FindPackageShare": lambda package: str(ROOT),
        "ParameterValue": lambda value, value_type: value_type(value),
        "Node": Declared,
    }
    for module in ("launch", "launch.actions", "launch.substitutions", "launch_ros",
                   "launch_ros.actions", "launch_ros.parameter_descriptions",
                   "launch_ros.substitutions"):  # fmt: skip
        made = ModuleType(module)
        made.__dict__.update(names)
        monkeypatch.setitem(sys.modules, module, made)
    declared = runpy.run_path(str(ROOT / "launch/robot.launch.py"))["generate_launch_description"]()
    assert declared[: len(given)] == list(given)
    return [one.settings for one in declared[len(given) :]]


def test_nav2_and_moveit_find_all_that_they_read(
    given: dict[str, str], nodes: list[dict[str, Any]]
) -> None:
    """Topics without the robot's name, a clock, and frames from the map to the robot's base."""
    simulator, *publishers = nodes
    assert (simulator["package"], simulator["executable"]) == ("sailenv_ros", "sim_node")
    file, own = simulator["parameters"]
    settings = yaml.safe_load(Path(file).read_text("utf-8"))["/**"]["ros__parameters"]
    remaps: list[str] = []
    for old, new in simulator["remappings"]:
        remaps += ["-r", f"{''.join(old)}:={new}"]
    with (
        NodeProcess(
            simulator["namespace"],
            remaps=tuple(remaps),
            scene=own["scene"],
            mode=settings["mode"],
            publish_clock=settings["publish_clock"],
            agent__name="",
        ),
        Probe(NAMESPACE) as probe,
    ):
        heard = {
            "odom": probe.listen(Odometry, "/odom"),
            "scan": probe.listen(LaserScan, "/scan"),
            "joint_states": probe.listen(JointState, "/joint_states"),
            "map": probe.listen(OccupancyGrid, "/map", LATCHED),
            "robot_description": probe.listen(String, "/robot_description", LATCHED),
            "clock": probe.listen(Clock, "/clock", BEST_EFFORT),
            "tf": probe.listen(TFMessage, "/tf"),
            "tf_static": probe.listen(TFMessage, "/tf_static", LATCHED),
        }
        driving = probe.node.create_publisher(Twist, "/cmd_vel", 1)
        forward = Twist()
        forward.linear.x = 0.3

        def driven() -> bool:
            driving.publish(forward)
            odom = heard["odom"].messages
            told = all(one.messages for one in heard.values())
            return told and odom[-1].twist.twist.linear.x > 0.25

        until(driven, "a cart that drives, and all of its topics", 30.0)
        frames = {
            one.child_frame_id: one.header.frame_id
            for topic in ("tf", "tf_static")
            for message in heard[topic].messages
            for one in message.transforms
        }
        for publisher in publishers:
            assert publisher["executable"] == "static_transform_publisher"
            _, parent, _, child = publisher["arguments"]
            frames[child] = "".join(parent)

        def above(frame: str) -> list[str]:
            found = [frame]
            while found[-1] in frames:
                found.append(frames[found[-1]])
            return found

        assert above("base_link")[-2:] == ["map", "world"]
        assert above("odom") == ["odom", "cart/odom", "map", "world"]
        assert "cart/odom" in above("base_link")
        scan, odom = heard["scan"].messages[-1], heard["odom"].messages[-1]
        assert "map" in above(scan.header.frame_id)
        assert "cart/odom" in above(odom.child_frame_id)
        assert heard["map"].messages[-1].header.frame_id == "map"
        assert set(heard["joint_states"].messages[-1].name) == {
            f"{corner} joint" for corner in ("front_left", "front_right", "rear_left", "rear_right")
        }
        assert "<robot" in heard["robot_description"].messages[-1].data
