"""An object stands on the surfaces that are drawn, by arithmetic."""

from __future__ import annotations

from typing import Any

import pytest

from sailenv_ros.types.geometry import Pose
from sailenv_ros.world.support import overlap_m, standing_place
from sailenv_ros.world.world import World
from tests.support.built_world import built_world


@pytest.fixture
def make(request: pytest.FixtureRequest) -> Any:
    """Build a world of static objects besides a cube of 20 cm, which is named ``box``."""

    def build(*objects: dict[str, Any]) -> World:
        box = {"name": "box", "asset": "cube", "scale": 0.2, "position": [5.0, 5.0, 3.0]}
        entries = [{"name": f"o{k}", "static": True, **entry} for k, entry in enumerate(objects)]
        world = built_world({"objects": [box, *entries]})
        request.addfinalizer(world.close)
        return world

    return build


def height(world: World, x: float, y: float, z: float) -> float:
    """Return the height of the lowest point of the box, wanted with its lowest point at z."""
    number = world.find("box")
    bottom = world.object_state(number).bottom_m
    height_m, carrier = standing_place(world, number, Pose((x, y, z - bottom)))
    assert (carrier is None) == (x == 9.0)
    return height_m + bottom


TABLE = {"asset": "cube", "position": [0.0, 0.0, 0.4], "scale": [1.0, 1.0, 0.8]}


def test_it_stands_on_a_table(make: Any) -> None:
    """At the table's height to a micrometre, also where only a part of its foot is over it."""
    world = make(TABLE)
    top = world.object_state(world.find("o0"))
    at = top.pose.position_m[2] + top.bottom_m + top.size_m[2]
    for x in (0.0, 0.45, 0.58):
        assert height(world, x, 0.1, at) == pytest.approx(at, abs=1e-6)
        assert height(world, x, 0.1, at + 0.3) == pytest.approx(at, abs=1e-6)
        assert height(world, x, 0.1, at - 0.03) == pytest.approx(at, abs=1e-6)


def test_a_step_that_is_too_high_is_not_climbed(make: Any) -> None:
    """What stands under a table does not jump onto it; where nothing is below, it stays."""
    world = make(TABLE, {"asset": "cube", "position": [0.0, 0.0, -0.5], "scale": [4, 4, 1]})
    low = world.object_state(world.find("o1"))
    floor = low.pose.position_m[2] + low.bottom_m + low.size_m[2]
    assert height(world, 1.5, 0.0, floor + 0.2) == pytest.approx(floor, abs=1e-6)
    assert height(world, 9.0, 9.0, 0.7) == 0.7


def test_it_stands_upon_the_top_of_a_ball(make: Any) -> None:
    """On the highest point of what is round, below the foot and not below its middle alone."""
    world = make({"asset": "sphere", "position": [0.0, 0.0, 1.0]})
    ball = world.object_state(world.find("o0"))
    radius = ball.size_m[2] / 2.0
    top = ball.pose.position_m[2] + ball.bottom_m + 2.0 * radius
    assert height(world, 0.0, 0.0, top + 0.2) < top + 1e-6
    assert height(world, 0.1, 0.1, top + 0.2) == pytest.approx(top, abs=0.01)


def test_overlap_is_what_physics_finds(make: Any) -> None:
    """0 beside it, the depth within it."""
    world = make(TABLE)
    box, table = world.body(world.find("box")), world.body(world.find("o0"))
    assert overlap_m(world, box, table) == 0.0
    at = world.object_state(world.find("o0"))
    top = at.pose.position_m[2] + at.bottom_m + at.size_m[2]
    bottom = world.object_state(world.find("box")).bottom_m
    world.put_body(world.find("box"), Pose((0.0, 0.0, top - bottom - 0.05)))
    assert overlap_m(world, box, table) == pytest.approx(0.05, abs=0.003)
