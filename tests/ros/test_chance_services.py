"""Materials and random scenes over DDS, through the Agent: the same as in process."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from sailenv_ros import Agent, Simulation
from sailenv_ros.errors import InvalidEntry, InvalidRequest, InvalidState
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from tests.support.probed_scene import agent_in_scene

pytestmark = pytest.mark.ros

YARD = """
version: 1
room: {size: [4, 4, 3]}
lights: [{name: lamp, type: point, position: [0, 0, 2.5], intensity: 1}]
objects:
  - {name: box, asset: cube, position: [1.5, 0, 1], scale: 0.4, static: true}
randomise:
  - {name: lamp, type: light, of: lamp, intensity: {log_uniform: [0.3, 3]}}
  - {name: box, type: material, of: box, every: frame, colour: {uniform: ["#000000", "#ffffff"]}}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("scenes")


@pytest.fixture(scope="module")
def agent(folder: Path) -> Iterator[Agent]:
    with agent_in_scene(folder, YARD, "/drawn", backend="native") as agent:
        yield agent


def test_materials_are_set_told_and_refused(agent: Agent) -> None:
    agent.reset()
    picture = agent.send_picture(np.full((4, 4, 3), 90, np.uint8))
    agent.set_material("floor", picture=picture, tile=(0.5, 0.25), tint=[0.5, 0.5, 0.5])
    agent.set_material("box", material="carpet", roughness=0.25)
    told = {i.name: i for i in agent.info.instances}
    (floor,), (box,) = json.loads(told["floor"].painted), json.loads(told["box"].painted)
    assert floor["picture"] == picture
    assert floor["tile"] == [0.5, 0.25]
    assert box["material"] == "carpet"
    assert len(told["box"].materials) == 1
    for changes in ({"material": "marzipan"}, {"picture": "absent.png"}, {"roughness": 2.0}):
        with pytest.raises((InvalidEntry, InvalidRequest)):
            agent.set_material("box", **changes)
    with pytest.raises(InvalidRequest):
        agent.upload_picture(b"no picture")
    agent.set_material("box")
    assert {i.name: i.painted for i in agent.info.instances}["box"] == ""


def test_frames_are_made_again_in_another_process(agent: Agent, folder: Path) -> None:
    record = agent.randomise(seed=3, index=2)
    assert (record["seed"], record["index"]) == (3, 2)
    agent.step(12)
    frame = agent.capture(["rgb", "depth"])
    assert frame.randomised is not None
    assert frame.randomised["step"] == 12
    assert frame.randomised["epoch"] == record["epoch"]
    lens = CameraIntrinsics(width=64, height=48)
    spec = AgentSpec(name="eye", following=False, intrinsics=lens)
    with Simulation("yard", mode="lockstep", scene_paths=[folder], backend="native") as other:
        other.register_agent(spec)
        other.randomise(record=frame.randomised)
        other.step(12)
        again = other.capture(["rgb", "depth"], agent="eye")
        np.testing.assert_array_equal(again["rgb"], frame["rgb"])
        np.testing.assert_array_equal(again["depth"], frame["depth"])
        assert again.randomised == frame.randomised


def test_things_of_a_call(agent: Agent) -> None:
    things = [{"name": "l", "type": "light", "of": "lamp", "intensity": {"uniform": [5, 6]}}]
    record = agent.randomise(seed=1, things=things)
    assert 5 <= record["epoch"]["lights"]["lamp"]["intensity"] <= 6
    with pytest.raises((InvalidEntry, InvalidRequest, InvalidState)):
        agent.randomise(things=[{"name": "l", "type": "light", "of": "moon"}])
    agent.change_scene("yard")
