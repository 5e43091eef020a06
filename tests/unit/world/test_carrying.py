"""People who take things, carry them and put them down: the thing goes with the hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sailenv_ros.postures.reaching import grip_place
from sailenv_ros.postures.skeleton import joint_frames
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import Asset
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.person_body import PersonBody
from sailenv_ros.world.placement import Placement
from sailenv_ros.world.surfaces import free_spots
from sailenv_ros.world.world import World
from tests.support.blocks import furniture
from tests.support.peopled_worlds import CATEGORIES, box, one, person, placed, world_of


def table(height: float = 0.7) -> Asset:
    return furniture("table", "dining table", [((0.7, 1.0, height), (0.0, 0.0, 0.0))])


def thing(
    x: float, y: float, z: float, size: tuple[float, float, float] = (0.07, 0.07, 0.12)
) -> Placement:
    asset = box("thing", size)
    return Placement(
        name="thing",
        asset=asset,
        category_id=CATEGORIES.named(asset.category).id,
        pose=Pose((x, y, z)),
        mass_kg=0.3,
        friction=0.8,
    )


def room(*more: Placement, name: str = "anna") -> tuple[World, PersonBody]:
    world = world_of(
        person(name, 0.8, 0.6),
        placed("near", table(), 0.0, 0.0, static=True),
        placed("far", table(0.5), 2.0, 0.0, static=True),
        *more,
    )
    world.step(60)
    return world, one(world, name)


def body(world: World, name: str) -> Body:
    return world.body(world.find(name))


def until_standing(world: World, anna: PersonBody) -> list[str]:
    seen = []
    for _ in range(900):
        world.step(8)
        seen.append(anna.walker.activity)
        if seen[-1] == "standing":
            break
    return list(dict.fromkeys(seen))


def in_hand(anna: PersonBody) -> np.ndarray:
    """Where the middle of what is held should be, in the world [m]."""
    held, rig = anna.walker.held, anna.placement.asset.rig
    assert held is not None
    assert rig is not None
    place = grip_place(rig, *joint_frames(rig, anna.walker.posture), held.grip)
    matrix = anna.world_from_body()
    return np.asarray(matrix[:3, :3] @ place + matrix[:3, 3])


def middle(one: Body) -> np.ndarray:
    return np.asarray(one.pose().matrix()[:3, :3] @ [0, 0, 0.06] + one.pose().position_m)


def test_a_thing_is_taken_carried_and_put_down() -> None:
    world, anna = room(thing(0.2, 0.2, 0.7))
    mug = body(world, "thing")
    assert anna.walker.take("thing")
    assert until_standing(world, anna) == ["walking", "reaching", "standing"]
    assert anna.walker.holds == "thing"
    assert mug.pose().position_m[2] > 0.8
    assert anna.walker.put_on("far")
    worst, tilt = 0.0, 0.0
    for _ in range(900):
        world.step(8)
        if anna.walker.held is None:
            break
        worst = max(worst, float(np.linalg.norm(in_hand(anna) - middle(mug))))
        tilt = max(tilt, 1.0 - float(mug.pose().matrix()[2, 2]))
    assert worst < 0.002
    assert tilt < 1e-3
    until_standing(world, anna)
    assert anna.walker.holds == ""
    world.step(120)
    x, y, z = mug.pose().position_m
    assert z == pytest.approx(0.5, abs=0.004)  # it stands upon the table
    assert abs(x - 2.0) < 0.35
    assert abs(y) < 0.5
    assert mug.pose().matrix()[2, 2] > 0.999
    world.close()


def test_one_in_ten_takes_things_with_the_left_hand() -> None:
    for name, side in (("anna", "R"), ("eve", "L")):
        world, who = room(thing(0.2, 0.2, 0.7), name=name)
        assert who.walker.take("thing")
        until_standing(world, who)
        held, skeleton = who.walker.held, who.skeleton()
        assert held is not None
        assert held.grip.side == side
        assert np.linalg.norm(in_hand(who) - middle(body(world, "thing"))) < 0.002
        wrist = skeleton.joints[skeleton.joint_names.index(f"wrist.{side}")]
        assert np.linalg.norm(wrist - middle(body(world, "thing"))) < 0.2
        world.close()


def test_feet_stand_while_a_hand_reaches_down() -> None:
    world, anna = room(thing(1.8, 0.2, 0.5))
    assert anna.walker.take("thing")
    feet = [anna.skeleton().joint_names.index(f"foot.{side}") for side in "LR"]
    places = []
    for _ in range(900):
        world.step(8)
        if anna.walker.activity == "reaching":
            places.append(anna.skeleton().joints[feet])
        if anna.walker.activity == "standing":
            break
    assert np.ptp(np.array(places[1:]), axis=0).max() < 0.005
    assert anna.walker.holds == "thing"
    world.close()


def test_one_squats_for_what_is_low() -> None:
    low = placed("low", box("low", (0.1, 0.1, 0.14)), 1.0, 1.2, static=True)
    world, anna = room(thing(1.0, 1.2, 0.14), low)
    assert anna.walker.take("thing")
    seen, lowest = until_standing(world, anna), 9.0
    assert seen == ["walking", "reaching", "standing"]
    assert anna.walker.holds == "thing"
    assert anna.walker.put_on("near")
    for _ in range(900):
        world.step(8)
        rig = anna.skeleton()
        lowest = min(lowest, float(rig.joints[:, 2].min()))
        if anna.walker.activity == "standing":
            break
    assert lowest > -0.01
    assert anna.walker.holds == ""
    world.close()


@pytest.mark.parametrize(
    "more",
    [
        (thing(0.2, 0.2, 0.7, (0.3, 0.3, 0.1)),),
        (thing(0.2, 0.2, 0.7, (0.05, 0.05, 0.6)),),
        (placed("thing", box("b", (0.05, 0.05, 0.1)), 0.2, 0.9, static=True),),
        (),
    ],
    ids=["too wide", "too long", "static", "not there"],
)
def test_what_no_hand_takes_is_refused(more: tuple[Placement, ...]) -> None:
    world, anna = room(*more)
    assert not anna.walker.take("thing")
    assert not anna.walker.put_on("far")
    assert anna.walker.activity == "standing"
    world.close()


def test_what_is_too_high_stays_where_it_is() -> None:
    shelf = furniture("shelf", "shelf", [((0.4, 0.6, 2.1), (0.0, 0.0, 0.0))])
    world, anna = room(placed("shelf", shelf, -1.5, -1.5, static=True), thing(-1.4, -1.5, 2.1))
    assert not anna.walker.take("thing")
    assert anna.walker.activity == "standing"
    assert body(world, "thing").pose().position_m[2] == pytest.approx(2.1, abs=0.01)
    world.close()


def test_nothing_is_carried_to_where_no_hand_gets() -> None:
    high = furniture("shelf", "shelf", [((0.4, 0.6, 2.1), (0.0, 0.0, 0.0))])
    world, anna = room(thing(0.2, 0.2, 0.7), placed("high", high, -1.5, -1.5, static=True))
    assert anna.walker.take("thing")
    until_standing(world, anna)
    assert not anna.walker.put_on("high")
    assert anna.walker.holds == "thing"
    world.close()


def test_what_is_held_and_removed_or_put_away_is_forgotten() -> None:
    world, anna = room(thing(0.2, 0.2, 0.7))
    assert anna.walker.take("thing")
    until_standing(world, anna)
    world.despawn(world.find("thing"))
    world.step(8)
    assert anna.walker.holds == ""
    world.close()


def test_spots_are_free_of_what_stands_there() -> None:
    world, _ = room(thing(0.25, 0.0, 0.7))
    spots = free_spots(body(world, "near"), [body(world, "thing")], 0.05)
    assert len(spots) > 3
    for spot in spots:
        assert spot[2] == pytest.approx(0.7, abs=1e-6)
        assert abs(spot[0]) < 0.35 - 0.05
        assert np.hypot(spot[0] - 0.25, spot[1]) > 0.035 + 0.05
    world.close()


def test_an_outside_all_around_is_not_in_the_way() -> None:
    outside = replace(box("outside", (9.0, 9.0, 4.0), "outside"), collision=())
    world, anna = room(
        thing(0.2, 0.2, 0.7),
        placed("outside", outside, 0.0, 0.0, static=True),
        placed("bed", furniture("bed", "bed", [((2.0, 0.9, 0.45), (0, 0, 0))]), -2.0, 0.0),
    )
    assert anna.walker.beds() == ("bed",)
    assert anna.walker.take("thing")
    until_standing(world, anna)
    assert anna.walker.put_on("far")
    world.close()


def test_the_behaviour_carries_a_thing_and_ends() -> None:
    world = world_of(
        person("anna", 0.8, 0.6, "fetch", objects=["thing"], to=["far"], pause=[0.1, 0.2]),
        placed("near", table(), 0.0, 0.0, static=True),
        placed("far", table(0.5), 1.9, 0.0, static=True),
        thing(0.2, 0.2, 0.7),
    )
    anna, mug = one(world, "anna"), body(world, "thing")
    for _ in range(600):
        world.step(12)
        if anna.walker.activity == "standing" and mug.pose().position_m[2] < 0.6:
            break
    world.step(240)
    assert mug.pose().position_m[2] == pytest.approx(0.5, abs=0.004)
    assert anna.walker.activity == "standing"
    assert anna.walker.holds == ""
    world.close()
