"""Which lamp a light is in."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Light
from sailenv_ros.types.model import Asset, BoxShape
from sailenv_ros.world.bodies import Placement
from sailenv_ros.world.world import World
from tests.support.tiny_scenes import CATEGORIES, box_mesh, model_of


def _lamp(name: str, x: float) -> Placement:
    model = model_of(box_mesh(0.2), glow=(1.0, 1.0, 1.0))
    asset = Asset(
        name="lamp",
        display_name="Lamp",
        category=CATEGORIES[1].name,
        model=model,
        collision=(BoxShape(half_extents_m=(0.1, 0.1, 0.1)),),
    )
    return Placement(name=name, asset=asset, category_id=1, pose=Pose((x, 0.0, 1.0)), gravity=False)


def _at(name: str, x: float, kind: str = "point") -> Light:
    return Light(name=name, type=kind, position_m=(x, 0.0, 1.0))  # type: ignore[arg-type]


@pytest.fixture
def world() -> Iterator[World]:
    """Two lamps 2 m apart, and lights in, near and far from them."""
    made = World(
        scene="lamps",
        epoch=1,
        placements=[_lamp("left", 0.0), _lamp("right", 2.0)],
        movers=[],
        categories=CATEGORIES,
        lights=[
            _at("within", 0.05),
            _at("near", 1.45),
            _at("far", 0.75),
            _at("sun", 0.0, "directional"),
            _at("window", 2.0, "area"),
        ],
    )
    yield made
    made.close()


def _lit(world: World) -> dict[str, tuple[str, ...]]:
    return {drawn.instance.name: drawn.lit_by for drawn in world.snapshot().contents.instances}


def test_a_light_is_in_the_nearest_lamp_within_reach(world: World) -> None:
    """0.45 m from the box is near enough, 0.65 m is not; windows and the sun are in no lamp."""
    assert _lit(world) == {"left": ("within",), "right": ("near",)}


def test_a_lamp_that_is_carried_off_goes_dark_and_comes_back_lit(world: World) -> None:
    """Where the lamp is now decides, and nothing else."""
    left = world.find("left")
    home = Pose((0.0, 0.0, 1.0))
    revision = world.contents.revision
    world.put_body(left, Pose((0.0, 3.0, 1.0)))
    assert _lit(world) == {"left": (), "right": ("near",)}
    world.put_body(left, home)
    assert _lit(world) == {"left": ("within",), "right": ("near",)}
    assert world.contents.revision == revision


def test_a_light_that_is_taken_away_leaves_its_lamp(world: World) -> None:
    """So does one that is moved."""
    world.set_lights([_at("near", 1.45), _at("within", 5.0)])
    assert _lit(world) == {"left": (), "right": ("near",)}
