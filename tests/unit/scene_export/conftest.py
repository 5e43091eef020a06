"""A small scene with everything that exports know: built once, exported by each file's tests."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from sailenv_ros.scene_export.contents import ExportedScene
from sailenv_ros.scene_export.gathering import agents_in, exported_world
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.world.world import World

SCENE = """
version: 1
title: A cabinet, a wardrobe and loose things
lights:
  - {name: sun, type: directional, direction: [-0.5, 0.4, -0.8], intensity: 2.0}
  - {name: bulb, type: point, position: [0, 1, 2.2], colour: [1.0, 0.8, 0.6], intensity: 8.0,
       range: 7}
  - {name: spot, type: spot, position: [1, 1, 2], direction: [0.3, 0, -1], inner_cone: 20,
       outer_cone: 40}
  - {name: panel, type: area, position: [0, -2, 2], direction: [0, 1, 0], width: 2, height: 0.5,
       intensity: 3}
objects:
  - {name: floor, asset: plane, static: true, category: floor}
  - {name: cabinet, asset: cube, static: true, position: [2, 0.3, 0.45], rotation: [0, 0, 30],
       scale: [0.5, 0.8, 0.9]}
  - name: cabinet door
    asset: cube
    category: door
    position: [-0.27, 0, 0]
    rotation: [0, 0, 10]
    scale: [0.03, 0.8, 0.8]
    joint: {type: hinge, parent: cabinet, origin: [0, 0.4, 0], axis: [0, 0.1, 1], limits: [-1.9,
        0.2], position: -0.4, damping: 0.5}
  - {name: ball, asset: sphere, position: [0, 0, 0.15], scale: [0.3, 0.3, 0.3], colour: "#c03020",
       mass: 0.7, category: sports ball}
  - {name: can, asset: cylinder, position: [0.5, -0.4, 0.1], rotation: [0, 0, 45], scale: [0.1,
       0.1, 0.2]}
  - {name: second ball, asset: sphere, position: [0.4, 0.5, 0.15], scale: [0.3, 0.3, 0.3], colour:
       "#c03020"}
  - {name: wardrobe, asset: "wardrobe~hinged:7", static: true, position: [-2, 1, 0], rotation: [0,
       0, -90]}
agents:
  - {name: eye, width: 320, height: 240, vertical_fov: 50, following: false, position: [-2, 0,
       1.5], rotation: [0, 20, 15]}
  - {name: fish, width: 200, height: 200, following: false, position: [0, 0, 2], distortion_model:
       equidistant, fx: 90, fy: 90, distortion: [0.01, 0, 0, 0]}
"""


@pytest.fixture(scope="session")
def scene_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("exported") / "little.yaml"
    path.write_text(SCENE, encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def world(scene_file: Path) -> Iterator[World]:
    with closing(SceneLibrary(baked_light=False).build(scene_file)) as world:
        yield world


@pytest.fixture(scope="session")
def scene(scene_file: Path, world: World) -> ExportedScene:
    agents = SceneLibrary(baked_light=False).load(scene_file).agents
    return exported_world(world, agents_in(world, [one.to_agent_spec() for one in agents]))
