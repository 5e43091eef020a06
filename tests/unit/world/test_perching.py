"""Cats that jump on furniture: they touch it from above alone, lie, and come down again."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.sources import installed_sources
from sailenv_ros.types.model import Asset
from sailenv_ros.world.person_body import PersonBody
from sailenv_ros.world.placement import Placement
from sailenv_ros.world.skin import contact_skin
from sailenv_ros.world.world import World
from tests.support.blocks import furniture
from tests.support.peopled_worlds import box, one, person, placed, until_activity, world_of

SEAT_M, BACK_M = 0.42, 0.85
TRUNK = ("belly", "spine02", "spine03")


def sofa(height: float = SEAT_M, width: float = 2.0) -> Asset:
    """A block with a back; its front edge is at x = 0.45, its back at -0.25."""
    return furniture(
        "sofa",
        "couch",
        [((0.9, width, height), (0.0, 0.0, 0.0)), ((0.2, width, BACK_M), (-0.35, 0.0, 0.0))],
    )


def with_cat(*others: Placement, piece: Asset | None = None, name: str = "cat_02") -> World:
    animal = AssetLibrary(installed_sources()).get(name)
    seat = placed("sofa", sofa() if piece is None else piece, 0.0, 0.0, static=True)
    world = world_of(placed("tom", animal, 1.7, 0.6, 100.0), seat, *others)
    world.step(1)
    return world


until = partial(until_activity, steps=4, most=3000)


def skin_of(cat: PersonBody) -> np.ndarray:
    matrix = cat.world_from_body()
    places = contact_skin(cat.placement.asset).places(cat.walker.posture)
    return places @ matrix[:3, :3].T + matrix[:3, 3]


def deepest(skin: np.ndarray) -> float:
    """How deep skin is within the sofa, along the shortest way out [m]."""
    x, y, z = skin.T
    beside = np.minimum.reduce([0.45 - x, 1.0 - y, y + 1.0])
    in_seat = np.minimum.reduce([beside, SEAT_M - z])
    in_back = np.minimum.reduce([beside, -0.25 - x, BACK_M - z])
    return float(np.maximum(in_seat, in_back).max())


def test_a_cat_jumps_on_a_sofa_lies_there_and_jumps_down() -> None:
    world = with_cat()
    cat = one(world, "tom")
    assert cat.walker.beds() == ("floor", "sofa")
    assert cat.walker.lie_on("sofa")
    assert until(world, cat, "lying down") == ["walking", "lying down"]
    before, fastest, deep, lain, stays = skin_of(cat), 0.0, 0.0, 0, []
    seen = []
    while cat.walker.activity != "standing":
        world.step(2)
        skin = skin_of(cat)
        fastest = max(fastest, float(np.abs(skin - before).max()))
        deep = max(deep, deepest(skin))
        before = skin
        seen.append(cat.walker.activity)
        if seen[-1] == "lying":
            lain += 1
            stays.append(skin)
            if lain == 60:
                assert cat.placed_pose().position_m[2] == 0.0  # where a saved scene puts it
                cat.walker.get_up()
    assert list(dict.fromkeys(seen)) == ["lying down", "lying", "getting up", "standing"]
    assert deep < 0.01
    assert fastest < 0.05  # in 1/120 s: nothing jumps
    rig = cat.placement.asset.rig
    assert rig is not None
    skin = stays[-1]
    trunk = np.isin(contact_skin(cat.placement.asset).joints, [rig.joint_of[n] for n in TRUNK])
    assert abs(float(skin[trunk, 2].min()) - SEAT_M) < 0.006
    assert np.abs(skin[:, 1]).max() < 1.0
    assert cat.pose().position_m[2] == pytest.approx(0.0, abs=1e-9)
    assert cat.walker.walk_to((1.5, -0.8))
    world.close()


def test_one_who_is_told_to_get_up_on_the_way_comes_down_again() -> None:
    world = with_cat()
    cat = one(world, "tom")
    assert cat.walker.lie_on("sofa")
    until(world, cat, "lying down")
    world.step(12)
    cat.walker.get_up()
    assert until(world, cat, "standing") == ["getting up", "standing"]
    assert cat.pose().position_m[2] == pytest.approx(0.0, abs=1e-9)
    world.close()


def test_what_is_made_anew_meanwhile_stands_on_the_floor() -> None:
    world = with_cat()
    cat = one(world, "tom")
    assert cat.walker.lie_on("sofa")
    until(world, cat, "lying")
    assert cat.pose().position_m[2] == pytest.approx(SEAT_M, abs=0.005)
    new = cat.rebuilt(cat.placement)
    assert new.pose().position_m[2] == 0.0
    world.close()


@pytest.mark.parametrize(
    ("name", "piece", "others"),
    [
        ("cat_02", sofa(height=0.9), ()),
        ("cat_02", sofa(width=0.5), ()),
        ("cat_02", furniture("table", "dining table", [((0.9, 2.0, 0.42), (0, 0, 0))]), ()),
        ("dog_01", sofa(), ()),
        ("cat_02", sofa(), (placed("wall", box("w", (0.1, 3.0, 1.0)), 0.9, 0.0, static=True),)),
    ],
    ids=["too high", "too narrow", "no seat", "a dog", "no room before it"],
)
def test_nobody_jumps_where_there_is_no_room(
    name: str, piece: Asset, others: tuple[Placement, ...]
) -> None:
    world = with_cat(*others, piece=piece, name=name)
    animal = one(world, "tom")
    assert not animal.walker.lie_on("sofa")
    assert animal.walker.activity == "standing"
    world.close()


def test_a_place_that_is_taken_is_not_free() -> None:
    library = AssetLibrary(installed_sources())
    world = with_cat(placed("kim", library.get("cat_03"), 1.7, -0.6), piece=sofa(width=0.9))
    tom, kim = one(world, "tom"), one(world, "kim")
    assert tom.walker.lie_on("sofa")
    assert kim.walker.beds() == ("floor",)
    assert not kim.walker.lie_on("sofa")
    until(world, tom, "lying")
    tom.walker.get_up()
    until(world, tom, "standing")
    assert kim.walker.lie_on("sofa")
    world.close()


def test_nobody_lies_down_upon_a_cat() -> None:
    bed = furniture("bed", "bed", [((2.0, 0.9, 0.45), (0.0, 0.0, 0.0))])
    world = with_cat(person("anna", 1.6, -0.9), piece=bed)
    tom, anna = one(world, "tom"), one(world, "anna")
    assert anna.walker.beds() == ("sofa",)
    assert tom.walker.lie_on("sofa")
    assert anna.walker.beds() == ()
    world.close()


def test_nobody_sits_down_upon_a_cat() -> None:
    world = with_cat(person("anna", 1.6, -0.9), piece=sofa(width=0.9))
    tom, anna = one(world, "tom"), one(world, "anna")
    assert anna.walker.seats() == ("sofa",)
    assert tom.walker.lie_on("sofa")
    assert anna.walker.seats() == ()
    world.close()
