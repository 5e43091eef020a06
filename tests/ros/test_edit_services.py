"""Editing, saving and thumbnails over DDS, through the Agent and by bare requests."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from sailenv_ros import Agent
from sailenv_ros.errors import InvalidRequest, InvalidState
from sailenv_ros.types.geometry import Pose
from tests.support.probed_scene import agent_in_scene

pytestmark = pytest.mark.ros

TWO_MOVERS = """
version: 1
environment: {exposure: 0.25}
objects:
  - {name: box, asset: cube, position: [2, 0, 1], scale: 0.4, static: true}
movers:
  - {name: rail, total_time: 4, waypoints: [{position: [0, 0, 1]}, {position: [0, 1, 1]}]}
  - {name: cart, position: [0, -2, 1], controller: rigidbody}
agents:
  - {name: watcher, width: 16, height: 12, rate: 0, following: false, position: [0, 0, 1]}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("scenes")


@pytest.fixture(scope="module")
def keeper(folder: Path) -> Iterator[Agent]:
    """A lockstep simulator for the tests of this module, held by an Agent of its own."""
    with agent_in_scene(folder, TWO_MOVERS, "/edited") as keeper:
        yield keeper


@pytest.fixture
def agent(keeper: Agent) -> Agent:
    """The agent, in the scene as it begins, at (0, 0, 1) and level."""
    keeper.change_scene("yard")
    keeper.set_position((0.0, 0.0, 1.0), teleport=True)
    return keeper


def test_a_changed_object_is_in_the_next_frame(agent: Agent) -> None:
    """Its id stays, its category and colour are others; a new scale leaves it without flow."""
    (id_,) = agent.instances
    agent.get_frame()
    agent.step(8)
    agent.change_object("box", category="chair", colour="#ff0000", name="crate")
    frame = agent.get_frame()
    seen = frame["instance"] == id_
    assert agent.instances[id_].name == "crate"
    assert set(np.unique(frame["category"][seen])) == {agent.instances[id_].category_id}
    assert frame["flow_valid"][seen].all()
    agent.step(8)
    agent.change_object(id_, scale=0.8)
    frame = agent.get_frame()
    larger = frame["instance"] == id_
    assert larger.sum() > 2 * seen.sum()
    assert not frame["flow_valid"][larger].any()
    with pytest.raises(InvalidRequest, match=r"0\.001 to 1000"):
        agent.change_object("crate", scale=0.0)
    with pytest.raises(InvalidRequest, match="key of an object"):
        agent.change_object("crate", asset="cube")


def test_surroundings_change_by_the_keys_of_a_file(agent: Agent) -> None:
    """A brighter exposure makes a brighter picture; unknown keys are answered with the known."""
    dark = agent.get_frame()["main"].mean()
    agent.set_environment(exposure=2.0)
    assert agent.get_frame()["main"].mean() > dark
    with pytest.raises(InvalidRequest, match="exposure"):
        agent.set_environment(brightness=2.0)
    with pytest.raises(InvalidRequest, match="a number, a text, a truth value"):
        agent.set_environment(exposure=object())


def test_lights_come_and_go(agent: Agent) -> None:
    """A lamp is in the next picture, then it is gone; names are unique."""
    dark = agent.get_frame()["main"].mean()
    lamp = agent.add_light("lamp", "point", position_m=(1.0, 0.0, 2.0), intensity=8.0)
    assert (lamp.type, lamp.position_m, lamp.range_m) == ("point", (1.0, 0.0, 2.0), 20.0)
    assert agent.lights_names == ["lamp"]
    assert agent.get_frame()["main"].mean() > dark
    with pytest.raises(InvalidRequest, match="light name"):
        agent.add_light("lamp", "spot")
    agent.remove_light("lamp")
    assert agent.lights_names == []
    assert agent.get_frame()["main"].mean() == pytest.approx(dark)


def test_tracks_are_announced_and_run_through(agent: Agent) -> None:
    """Waypoints come by pose or by pair; the second mover's can be set as the first's."""
    assert [len(mover.waypoints) for mover in agent.movers.values()] == [2, 0]
    agent.set_waypoints(
        [Pose((1.0, 0.0, 1.0)), ((2, 0, 1), (0, 0, 90))], total_time_s=2, loop=False
    )
    agent.add_waypoint((2, 2, 1))
    rail = agent.movers["rail"]
    assert (rail.total_time_s, rail.loop) == (2.0, False)
    assert [p.position_m for p in rail.waypoints] == [(1, 0, 1), (2, 0, 1), (2, 2, 1)]
    assert rail.waypoints[1].rpy_deg == pytest.approx((0.0, 0.0, 90.0))
    agent.set_follow(True)
    agent.step(240)
    assert agent.get_position() == pytest.approx((2.0, 0.0, 1.0), abs=1e-6)
    agent.set_follow(False)
    with pytest.raises(InvalidRequest, match="bus"):
        agent.add_waypoint((0, 0, 0), mover="bus")


def test_any_mover_can_be_driven(agent: Agent) -> None:
    """The second mover walks, the first goes on along its track; a track's mover refuses."""
    agent.drive_mover((0.5, 0.0, 0.0), (0.0, 0.0, math.pi / 4.0), mover="cart")
    agent.step(120)
    agent.set_mover_controller("waypoint", "cart")
    assert agent.movers["cart"].controller == "waypoint"
    path = Path(agent.save_scene("driven", overwrite=True))
    text = path.read_text(encoding="utf-8")
    assert "rotation: [0, 0, 22.5]" in text  # an eighth of a turn a second, for half a second
    with pytest.raises(InvalidState, match="set_mover_controller"):
        agent.drive_mover((1.0, 0.0, 0.0), mover="rail")


def test_a_saved_scene_is_one_of_the_scenes(agent: Agent, folder: Path) -> None:
    """It is announced at once and begins as the world was; names in use are refused."""
    agent.spawn_object("Sphere", (1.0, 1.0, 0.5), object_name="ball", scale=0.3)
    path = agent.save_scene("yard at noon", title="With a ball", cameras=[agent.id])
    assert Path(path) == folder / "yard at noon.yaml"
    assert "yard at noon" in agent.scenes
    agent.despawn_object("ball")
    agent.change_scene("yard at noon")
    assert agent.get_object("ball").pose.position_m == (1.0, 1.0, 0.5)
    assert f"name: {agent.id}" in Path(path).read_text(encoding="utf-8")
    with pytest.raises(InvalidRequest, match="overwritten"):
        agent.save_scene("yard at noon")
    with pytest.raises(InvalidRequest, match="scene name"):
        agent.save_scene("../elsewhere")


def test_the_catalogue_has_pictures(agent: Agent) -> None:
    """A red cube it is not: light grey, in the middle of 160 x 120 pixels."""
    picture = agent.get_thumbnail("cube")
    assert (picture.shape, picture.dtype) == ((120, 160, 3), np.uint8)
    middle, corner = picture[55:65, 75:85].mean(), picture[:10, :10].mean()
    assert abs(middle - corner) > 8
    with pytest.raises(InvalidRequest, match="asset"):
        agent.get_thumbnail("unicorn")
