"""People who lie: skin rests on what is below it, and nobody lies where there is no room."""

from __future__ import annotations

import numpy as np
import pytest

from sailenv_ros.types.model import Asset
from sailenv_ros.world.beds import lanes_of
from sailenv_ros.world.person_body import PersonBody
from sailenv_ros.world.world import World
from tests.support.blocks import furniture
from tests.support.peopled_worlds import one, person, placed, until_activity, world_of

MATTRESS_M, PILLOW_M = 0.45, 0.08


def bed(width: float = 0.9, length: float = 2.0) -> Asset:
    """A mattress with a pillow at its back, where a head belongs."""
    return furniture(
        "bed",
        "bed",
        [
            ((length, width, MATTRESS_M), (0.0, 0.0, 0.0)),
            ((0.4, 0.5, PILLOW_M), (-0.5 * length + 0.25, 0.0, MATTRESS_M)),
            ((0.06, width, 0.9), (-0.5 * length - 0.03, 0.0, 0.0)),
        ],
    )


def skin_on(world: World, body: PersonBody, piece: str) -> np.ndarray:
    """(V, 3): where the skin is in the frame of a piece [m]."""
    mesh = np.concatenate([m.positions for m in body.deformation().meshes])
    own = np.linalg.inv(world.body(world.find(piece)).world_from_body())
    matrix = own @ body.world_from_body()
    return mesh @ matrix[:3, :3].T + matrix[:3, 3]


def surface(places: np.ndarray) -> np.ndarray:
    """(V,): height of the bed below places of its own frame; -1 beside it."""
    on_bed = (np.abs(places[:, 0]) < 1.0) & (np.abs(places[:, 1]) < 0.45)
    on_pillow = (np.abs(places[:, 0] + 0.75) < 0.2) & (np.abs(places[:, 1]) < 0.25)
    return np.where(on_bed, MATTRESS_M + PILLOW_M * on_pillow, -1.0)


def test_one_lies_down_rests_and_gets_up() -> None:
    world = world_of(person("anna", 0.4, 1.6), placed("bed", bed(), 0.0, 0.0, 20.0, static=True))
    anna = one(world, "anna")
    world.step(1)
    assert anna.walker.beds() == ("bed",)
    assert anna.walker.lie_on("bed")
    assert until_activity(world, anna, "lying") == ["walking", "lying down", "lying"]
    skin = skin_on(world, anna, "bed")
    depths = surface(skin) - skin[:, 2]
    assert depths.max() < 0.02
    # It rests along all its length: head, trunk, heels.
    for low, high in ((-1.0, -0.55), (-0.35, 0.25), (0.6, 1.05)):
        assert depths[(skin[:, 0] > low) & (skin[:, 0] < high)].max() > 0.0
    assert skin[:, 0].min() > -1.0
    assert np.ptp(skin[:, 0]) > 1.6
    joints = anna.skeleton().joints
    names = anna.skeleton().joint_names
    assert np.ptp(joints[[names.index("head"), names.index("root")], 2]) < 0.25
    assert anna.walker.beds() == ("bed",)  # it is her own
    anna.walker.get_up()
    assert until_activity(world, anna, "standing") == ["getting up", "standing"]
    world.close()


def test_on_the_way_into_a_bed_the_body_stays_above_it() -> None:
    world = world_of(person("anna", 0.4, 1.6), placed("bed", bed(), 0.0, 0.0, static=True))
    anna = one(world, "anna")
    world.step(1)
    assert anna.walker.lie_on("bed")
    until_activity(world, anna, "lying down")
    deepest, last, fastest = 0.0, None, 0.0
    for _ in range(200):
        world.step(8)
        skin = skin_on(world, anna, "bed")
        if last is not None:
            fastest = max(fastest, float(np.abs(skin - last).max()))
        last = skin
        within = np.abs(skin[:, 1]) < 0.3  # not the shanks before the edge
        deepest = max(deepest, float((surface(skin) - skin[:, 2])[within].max(initial=-1.0)))
        if anna.walker.activity == "lying":
            break
    assert anna.walker.activity == "lying"
    assert deepest < 0.02
    assert fastest < 0.12  # in 1/30 s: nothing jumps
    world.close()


@pytest.mark.parametrize(
    "piece",
    [
        bed(width=0.4),
        bed(length=1.5),
        furniture("table", "dining table", [((2.2, 1.0, 0.5), (0.0, 0.0, 0.0))]),
        furniture("loft", "bed", [((2.2, 1.0, 1.4), (0.0, 0.0, 0.0))]),
    ],
    ids=["too narrow", "too short", "no bed", "too high"],
)
def test_nobody_lies_where_there_is_no_room(piece: Asset) -> None:
    world = world_of(person("anna", 0.0, 2.0), placed("bed", piece, 0.0, 0.0, static=True))
    anna = one(world, "anna")
    world.step(1)
    assert anna.walker.beds() == ()
    assert not anna.walker.lie_on("bed")
    assert anna.walker.activity == "standing"
    world.close()


def test_nobody_lies_on_things() -> None:
    book = placed("book", furniture("book", "book", [((0.2, 0.2, 0.05), (0.3, 0.0, 0.45))]), 0, 0)
    world = world_of(person("anna", 0.4, 1.6), placed("bed", bed(), 0.0, 0.0, static=True), book)
    anna = one(world, "anna")
    world.step(1)
    assert anna.walker.beds() == ()
    world.despawn(world.find("book"))
    assert anna.walker.beds() == ("bed",)
    world.close()


def test_two_have_room_on_a_wide_bed_and_a_third_has_not() -> None:
    world = world_of(
        person("anna", 0.2, 1.8),
        person("ben", 0.2, -1.8),
        person("carl", 2.5, 0.0),
        placed("bed", bed(width=1.7), 0.0, 0.0, static=True),
    )
    anna, ben, carl = (one(world, name) for name in ("anna", "ben", "carl"))
    world.step(1)
    assert len(lanes_of(world.body(world.find("bed")))) == 2
    assert anna.walker.lie_on("bed")
    assert ben.walker.lie_on("bed")
    assert carl.walker.beds() == ()
    for body in (anna, ben):
        until_activity(world, body, "lying")
        assert body.walker.activity == "lying"
    sides = [float(skin_on(world, body, "bed")[:, 1].mean()) for body in (anna, ben)]
    assert sides[0] > 0.2
    assert sides[1] < -0.2
    world.close()


def lying_on(couch: Asset) -> tuple[World, PersonBody, np.ndarray]:
    """A world where somebody lies on a couch, and where the skin is in the couch's frame [m]."""
    world = world_of(person("anna", 1.6, 0.0), placed("couch", couch, 0.0, 0.0, static=True))
    anna = one(world, "anna")
    world.step(1)
    assert anna.walker.lie_on("couch")
    until_activity(world, anna, "lying")
    skin = skin_on(world, anna, "couch")
    return world, anna, skin


def test_one_lies_along_a_couch() -> None:
    couch = furniture(
        "couch",
        "couch",
        [
            ((0.9, 2.3, 0.42), (0.0, 0.0, 0.0)),
            ((0.2, 2.3, 0.85), (-0.35, 0.0, 0.0)),
            ((0.9, 0.12, 0.6), (0.0, 1.1, 0.0)),
            ((0.9, 0.12, 0.6), (0.0, -1.1, 0.0)),
        ],
    )
    world, _, skin = lying_on(couch)
    assert np.ptp(skin[:, 1]) > 1.6
    assert np.abs(skin[:, 1]).max() < 1.04  # between the arms
    assert skin[:, 0].min() > -0.27  # before the back
    assert 0.40 < skin[:, 2].min() < 0.425
    world.close()


def test_heels_rest_where_toes_reach_the_arm_of_a_couch() -> None:
    couch = furniture(
        "couch",
        "couch",
        [((0.9, 2.08, 0.42), (0.0, 0.0, 0.0))]
        + [((0.9, 0.12, 0.75), (0.0, side * 0.98, 0.0)) for side in (1.0, -1.0)],
    )
    world, anna, skin = lying_on(couch)
    assert np.abs(skin[:, 1]).max() < 0.92  # between the arms
    names, joints = anna.skeleton().joint_names, anna.skeleton().joints
    for side in "LR":
        heel = joints[names.index(f"foot.{side}")]
        near = np.linalg.norm(skin[:, :2] - heel[:2], axis=1) < 0.15
        assert 0.40 < skin[near, 2].min() < 0.42
    world.close()
