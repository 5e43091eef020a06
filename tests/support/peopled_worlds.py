"""Worlds of blocks with people of sticks."""

from __future__ import annotations

from typing import Any

import numpy as np

from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.categories import load_categories
from sailenv_ros.behaviours import RunningBehaviour, start_behaviour
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import Asset
from sailenv_ros.world.mover import Mover
from sailenv_ros.world.person_body import PersonBody
from sailenv_ros.world.placement import Placement
from sailenv_ros.world.world import World
from tests.support.blocks import furniture
from tests.support.stick_person import stick_person

__all__ = [
    "CATEGORIES",
    "STICK",
    "box",
    "bytes_of",
    "chair",
    "nearest_crossing",
    "one",
    "person",
    "placed",
    "until_activity",
    "world_of",
]

CATEGORIES = load_categories()
STICK = stick_person()
"""A person without a behaviour; see `person`."""


def box(name: str, size: tuple[float, float, float], category: str = "cube") -> Asset:
    """A block on the floor."""
    return furniture(name, category, [(size, (0.0, 0.0, 0.0))])


def chair() -> Asset:
    """A block 0.45 m high with a back; one sits towards +x."""
    return furniture(
        "chair",
        "chair",
        [((0.5, 0.5, 0.45), (0.0, 0.0, 0.0)), ((0.08, 0.5, 0.9), (-0.25, 0.0, 0.0))],
    )


def placed(name: str, asset: Asset, x: float, y: float, yaw: float = 0.0, **more: Any) -> Placement:
    """An object on the floor, turned about the vertical [deg]."""
    return Placement(
        name=name,
        asset=asset,
        category_id=CATEGORIES.named(asset.category).id,
        pose=Pose.from_rpy_deg((x, y, 0.0), (0.0, 0.0, yaw)),
        **more,
    )


def person(name: str, x: float, y: float, kind: str = "", **parameters: Any) -> Placement:
    """A person of sticks who behaves."""
    behaviours: tuple[RunningBehaviour, ...] = ()
    if kind:
        behaviours = (start_behaviour(kind, parameters, seed=3, object_name=name, place=0),)
    return placed(name, STICK, x, y, behaviours=behaviours)


def world_of(*placements: Placement) -> World:
    """A world of a floor and these."""
    ground = Placement(
        name="ground",
        asset=AssetLibrary().get("plane"),
        category_id=CATEGORIES.named("plane").id,
        pose=Pose((0.0, 0.0, 0.0)),
        static=True,
    )
    return World(
        scene="people",
        placements=[ground, *placements],
        movers=[Mover(name="mover", start=Pose(), track=None, controller="rigidbody")],
        categories=CATEGORIES,
    )


def one(world: World, name: str) -> PersonBody:
    """The person of that name."""
    found = next(body for body in world.bodies if body.placement.name == name)
    assert isinstance(found, PersonBody)
    return found


def until_activity(
    world: World, body: PersonBody, word: str, *, steps: int = 12, most: int = 900
) -> list[str]:
    """Step until an activity; return the activities on the way."""
    seen = []
    for _ in range(most):
        world.step(steps)
        seen.append(body.walker.activity)
        if seen[-1] == word:
            break
    return list(dict.fromkeys(seen))


def nearest_crossing(world: World, first: PersonBody, second: PersonBody) -> float:
    """Step until two who have set out stand; return how near they have come to each other [m]."""
    nearest = 9.0
    for _ in range(600):
        world.step(12)
        between = np.subtract(first.pose().position_m, second.pose().position_m)
        nearest = min(nearest, float(np.hypot(*between[:2])))
        if first.walker.activity == second.walker.activity == "standing":
            break
    return nearest


def bytes_of(world: World) -> tuple[bytes, ...]:
    """Return where all is, and the shapes of those who have some."""
    states = world.states()
    shapes = [shape.meshes[0].positions.tobytes() for shape in states.deformations.values()]
    return states.positions.tobytes(), *shapes
