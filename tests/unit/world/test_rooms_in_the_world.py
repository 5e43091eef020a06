"""A scene's room in the world: static objects with ids of their own that hold things in."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sailenv_ros.world.world import World
from tests.support.built_world import built_world

OPENINGS = [
    {"type": "window", "wall": "north", "at": 0.4, "curtains": True},
    {"type": "door", "wall": "east", "at": -0.8},
    {"type": "door", "wall": "south", "at": 0.0, "open": 60},
]


def build(objects: list[dict[str, Any]], **room: Any) -> World:
    keys = {"size": [4.0, 3.0, 2.5], "openings": OPENINGS, **room}
    return built_world({"room": keys, "objects": objects})


def position(world: World, name: str) -> np.ndarray[Any, np.dtype[np.float64]]:
    names = [drawn.instance.name for drawn in world.contents.instances]
    return world.snapshot().world_from_body[names.index(name), :3, 3]


def test_the_room_s_parts_come_first_and_are_static() -> None:
    world = build([{"name": "ball", "asset": "sphere", "position": [0, 0, 1]}])
    found = [drawn.instance for drawn in world.contents.instances]
    walls = ["north wall", "east wall", "south wall", "west wall"]
    names = ["floor", "ceiling", *walls, "skirting", "window 1", "door 1", "door 2", "curtains 1"]
    assert [instance.name for instance in found] == [*names, "ball"]
    assert [instance.id for instance in found] == list(range(1, len(names) + 2))
    assert [instance.static for instance in found] == [True] * len(names) + [False]
    kinds = {instance.name: instance.category for instance in found}
    assert kinds["north wall"] == "wall"
    assert kinds["window 1"] == "window"
    assert kinds["curtains 1"] == "curtain"


def test_a_ball_comes_to_rest_on_the_floor() -> None:
    """Its centre is its radius above z = 0, within 2 mm."""
    ball = {"name": "ball", "asset": "sphere", "scale": 0.2, "position": [0.5, 0.3, 0.6]}
    world = build([ball])
    world.step(480)
    assert position(world, "ball")[2] == pytest.approx(0.1, abs=2e-3)


@pytest.mark.parametrize(
    ("start", "velocity"),
    [
        ([0.4, 0.0, 1.4], [0, 12, 2]),  # through the window
        ([0.0, -0.8, 1.2], [12, 0, 2]),  # through the closed door
        ([0.0, 0.5, 1.2], [-12, 0, 2]),
        ([-1.2, 0.0, 1.2], [0, -12, 2]),
        ([0.0, 0.0, 1.0], [0, 0, 12]),
        ([0.0, 0.0, 1.0], [3, 2, -15]),
    ],
)
def test_nothing_leaves_a_closed_room(start: list[float], velocity: list[float]) -> None:
    """Small balls thrown at 12 to 15 m/s bounce off window, door, walls, ceiling and floor."""
    ball = {
        "name": "ball",
        "asset": "sphere",
        "scale": 0.08,
        "mass": 0.2,
        "restitution": 0.9,
        "position": start,
        "velocity": velocity,
    }
    world = build([ball], openings=OPENINGS[:2], thickness=0.15)
    for _ in range(120):
        world.step(4)
        # A step at 15 m/s is 6 cm: so deep may it be in what throws it back.
        x, y, z = position(world, "ball")
        assert abs(x) < 2.07
        assert abs(y) < 1.57
        assert -0.07 < z < 2.57
    world.step(240)
    assert (np.abs(position(world, "ball") - [0, 0, 1.25]) < [2.07, 1.57, 1.32]).all()


def test_one_may_leave_through_an_open_door() -> None:
    ball = {
        "name": "ball",
        "asset": "sphere",
        "scale": 0.1,
        "gravity": False,
        "position": [-0.2, 0.0, 1.0],
        "velocity": [0, -4, 0],
    }
    world = build([ball])
    world.step(240)
    assert position(world, "ball")[1] < -2.0


def test_an_open_leaf_is_in_the_way() -> None:
    """The leaf of the south door stands open; what flies along the wall meets it."""
    ball = {
        "name": "ball",
        "asset": "sphere",
        "scale": 0.1,
        "gravity": False,
        "position": [1.6, -1.2, 1.0],
        "velocity": [-3, 0, 0],
    }
    free, met = build([ball], openings=[]), build([ball], openings=OPENINGS[2:])
    free.step(180)
    met.step(180)
    assert position(free, "ball")[0] == pytest.approx(1.6 - 3 * 0.75, abs=0.02)
    # The leaf runs from its hinges at x = 0.42 to x = 0.0, across the way.
    assert position(met, "ball")[0] > 0.0
