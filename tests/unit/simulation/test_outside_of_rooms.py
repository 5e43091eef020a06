"""What lies outside a room while a simulator runs: it follows its room and is saved with it."""

from __future__ import annotations

import numpy as np
import pytest
import yaml

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.simulation.operations.rooms import RoomOperations
from sailenv_ros.simulation.synchronous import SynchronousSimulation

STAGE = """
version: 1
lights: [{name: sun, type: directional, direction: [0.3, 0.7, -0.8], intensity: 6}]
room:
  size: [4, 3, 2.5]
  outside: {kind: garden, seed: 2}
  openings: [{type: window, wall: south}]
objects: [{name: table, asset: cube, position: [0, 0, 0.25], scale: 0.5, static: true}]
randomise: [{name: gloss, type: material, of: "*", colour: {choice: ["#aa8855", "#557799"]}}]
"""


def names(core: SynchronousSimulation) -> list[str]:
    return [drawn.instance.name for drawn in core.world.contents.instances]


def saved_room(core: SynchronousSimulation) -> dict[str, object]:
    room = yaml.safe_load(core.scene_text())["room"]
    assert isinstance(room, dict)
    return room


def test_it_is_no_part_of_the_scene_s_bounds(core: SynchronousSimulation) -> None:
    """The box around the room with its walls, not around the neighbourhood."""
    low, high = core.scene_bounds()
    np.testing.assert_allclose((low[0], high[0]), (-2.2, 2.2), atol=0.05)
    assert high[2] < 2.8


def test_it_is_saved_and_may_be_taken_out(core: SynchronousSimulation) -> None:
    assert saved_room(core)["outside"] == {"kind": "garden", "seed": 2}
    core.despawn_object("outside")
    assert "outside" not in names(core)
    assert saved_room(core)["outside"] == "none"


def test_its_materials_are_not_changed(core: SynchronousSimulation) -> None:
    """It is painted; what changes all materials at random leaves it alone."""
    with pytest.raises((InvalidRequest, UnknownName)):
        core.set_material("outside", colour="#ff0000")
    before = next(d.model for d in core.world.contents.instances if d.outside is not None)
    core.randomise(seed=1)
    after = next(d.model for d in core.world.contents.instances if d.outside is not None)
    assert after is before


def test_it_follows_the_room_s_size(core: SynchronousSimulation) -> None:
    """In a room 2 m deeper its ground begins 1 m farther out; it keeps its id."""
    found = [d for d in core.world.contents.instances if d.outside is not None]
    RoomOperations.set_room_size(core, (4.0, 5.0, 2.5))
    now = [d for d in core.world.contents.instances if d.outside is not None]
    assert [d.instance.id for d in now] == [d.instance.id for d in found]
    assert now[0].outside is not None
    assert now[0].outside.low_m == (-2.0, -2.5, 0.0)
    assert now[0].model is not found[0].model
