"""The page, materials and chance: what is chosen there is what the simulation has."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sailenv_ros.simulation import Simulation
from tests.support.browser import OpenPage
from tests.support.waiting import until

pytestmark = pytest.mark.slow

SCENE = """
version: 1
room: {size: [4, 4, 3]}
lights: [{name: lamp, type: point, position: [0, 0, 2.5], intensity: 1}]
objects: [{name: box, asset: cube, position: [1, 0, 0.5], scale: 0.6, static: true}]
mover: {position: [-1.8, 0, 1.4]}
"""


def painted(simulation: Simulation, name: str) -> list[dict[str, object]]:
    """What is told of an object's materials."""
    told = next(one.painted for one in simulation.info.instances if one.name == name)
    found: list[dict[str, object]] = json.loads(told or "[]")
    return found


def test_materials_pictures_and_chance(
    simulation: Simulation, opened: OpenPage, tmp_path: Path
) -> None:
    """A material, a picture of one's own, its own again; the scene drawn anew and kept."""
    picture = tmp_path / "mine.png"
    Image.fromarray(np.full((30, 40, 3), 120, np.uint8)).save(picture)
    box = simulation.get_object("box").id
    page = opened.page
    page.get_by_role("tab", name="Object").click()
    page.locator(f'#objects [data-id="{box}"]').click()
    page.locator("#material").select_option("carpet")
    until(lambda: painted(simulation, "box") == [{"material": "carpet"}], "carpet")
    page.locator("#material-picture").set_input_files(picture)
    until(lambda: "picture" in str(painted(simulation, "box")), "the picture")
    page.get_by_text("Its own again").click()
    until(lambda: painted(simulation, "box") == [], "its own materials")
    epoch = simulation.info.epoch
    page.get_by_role("tab", name="Scene").click()
    page.locator("button.randomise").click()
    until(lambda: simulation.info.epoch > epoch, "a new epoch")
    until(lambda: painted(simulation, "floor") != [], "a floor")
    drawn = painted(simulation, "floor")
    page.locator("button.keep-drawn").click()
    until(lambda: _kept(simulation) != [], "the kept scene")
    (kept,) = _kept(simulation)
    simulation.change_scene(kept)
    assert painted(simulation, "floor") == drawn


def _kept(simulation: Simulation) -> list[str]:
    return [name for name in simulation.info.scenes if name.startswith("own_")]
