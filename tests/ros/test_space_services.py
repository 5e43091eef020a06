"""Free space, ways and rays over DDS: equal to what the simulation itself returns."""

from __future__ import annotations

import types
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from rclpy.serialization import serialize_message
from rosbags.typesys import Stores, get_typestore

from sailenv_ros import Agent, Simulation
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.ros.nodes.free_space_topic import FreeSpaceTopic
from sailenv_ros.space import FreeSpace
from sailenv_ros.space.free_space import BodySize
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics

pytestmark = pytest.mark.ros

SMALL = {"height_m": 0.5, "radius_m": 0.15}


@pytest.fixture(scope="module")
def both() -> Iterator[tuple[Agent, Simulation]]:
    """A lockstep simulator over ROS, and the same scene in this process."""
    parameters = {"scene": "optical", "mode": "lockstep", "agent.name": "", "gateway.port": 0}
    with (
        Agent(width=32, height=24, namespace="/space", simulator=parameters) as agent,
        Simulation("optical", mode="lockstep") as simulation,
    ):
        yield agent, simulation


def test_the_map_is_the_same_over_ros(both: tuple[Agent, Simulation]) -> None:
    """Cells, origin and body, so that ways through it are the same, too."""
    agent, simulation = both
    far, near = agent.free_space(**SMALL, step_m=0.02), simulation.free_space(**SMALL, step_m=0.02)
    assert np.array_equal(far.cells, near.cells)
    assert (far.origin_m, far.body, far.stamp_ns) == (near.origin_m, near.body, near.stamp_ns)
    assert agent.free_space().body == BodySize()


def test_the_bounds_are_the_same_over_ros(both: tuple[Agent, Simulation]) -> None:
    """Both corners of the box around everything."""
    agent, simulation = both
    assert agent.scene_bounds() == simulation.scene_bounds()


def test_poses_and_ways_are_the_same_over_ros(both: tuple[Agent, Simulation]) -> None:
    """To the bit, for the seed of the scene and for another."""
    agent, _ = both
    for seed in (None, 7):
        poses = [caller.random_pose("robot", **SMALL, seed=seed) for caller in both]
        assert poses[0] == poses[1]
    start = poses[0].position_m
    goal = agent.random_pose("goal", **SMALL, reachable_from=start).position_m
    ways = [caller.find_path(start, goal, **SMALL) for caller in both]
    assert np.array_equal(*ways)
    with pytest.raises(InvalidRequest, match="goal must be a place in free space"):
        agent.find_path(start, (900.0, 0.0), **SMALL)


def test_rays_are_the_same_over_ros(both: tuple[Agent, Simulation]) -> None:
    """Every field of the answer; what meets nothing, too."""
    directions = np.random.default_rng(0).normal(size=(300, 3))
    far, near = (caller.cast_rays((0.0, 0.0, 1.0), directions) for caller in both)
    assert (near.instance_ids == 0).any()
    for mine, theirs in zip(far, near, strict=True):
        assert mine.dtype == theirs.dtype
        assert np.array_equal(mine, theirs, equal_nan=True)
    short = both[0].cast_rays((0.0, 0.0, 1.0), directions, max_distance_m=0.2)
    assert not short.instance_ids.any()


@dataclass
class FakeNode:
    """Keeps what is published."""

    sent: list[Any] = field(default_factory=list)

    def create_publisher(self, kind: type, topic: str, qos: Any) -> Any:
        assert topic == "free_space"
        return types.SimpleNamespace(publish=self.sent.append)


def test_the_topic_is_an_occupancy_grid_of_ros_2() -> None:
    """By Jazzy's own definition of the type: it holds the map, there and back as CDR."""
    node = FakeNode()
    cells = np.array([[0, 100, -1], [0, 0, 0]], np.int8)
    space = FreeSpace(cells=cells, origin_m=(-1.5, 2.25), body=BodySize(), stamp_ns=1_500_000_000)
    FreeSpaceTopic(node).publish(space)  # type: ignore[arg-type]  # all that it uses of a node
    (sent,) = node.sent
    store = get_typestore(Stores.ROS2_JAZZY)
    back: Any = store.deserialize_cdr(serialize_message(sent), "nav_msgs/msg/OccupancyGrid")
    assert back.header.frame_id == "world"
    assert (back.header.stamp.sec, back.header.stamp.nanosec) == (1, 500_000_000)
    assert (back.info.height, back.info.width) == (2, 3)
    assert back.info.resolution == pytest.approx(0.05)
    assert (back.info.origin.position.x, back.info.origin.position.y) == (-1.5, 2.25)
    assert back.info.origin.orientation.w == 1.0
    assert np.array_equal(back.data.reshape(2, 3), cells)


def test_cameras_by_rules_are_the_same_over_ros(both: tuple[Agent, Simulation]) -> None:
    """Pose and target of each, with settings of every type."""
    agent, simulation = both
    lens = CameraIntrinsics(width=32, height=24)
    simulation.register_agent(AgentSpec(name="eye", intrinsics=lens, following=False, rate_hz=0.0))
    asked = {"cover": (0.01, 0.5), "visible": 0.5, "attempts": 80, "seed": 3}
    far = agent.sample_cameras("object_view", 3, **asked)
    near = simulation.sample_cameras("object_view", 3, agent="eye", **asked)
    assert len(near) == 3
    assert far == near
    with pytest.raises(InvalidRequest, match="is not a setting of coverage"):
        agent.sample_cameras("coverage", coverage=1)
