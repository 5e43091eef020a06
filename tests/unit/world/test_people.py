"""People of the world: feet that stand, ways round furniture and each other, seats, truth."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sailenv_content.people.fetch_bodies import fetch_bodies
from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.sources import installed_sources
from sailenv_ros.behaviours import start_behaviour
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.geometry import Pose
from sailenv_ros.world.placement import Placement
from sailenv_ros.world.skin import contact_skin
from tests.support.blocks import furniture
from tests.support.peopled_worlds import (
    CATEGORIES,
    STICK,
    box,
    bytes_of,
    chair,
    nearest_crossing,
    one,
    person,
    placed,
    world_of,
)

FEET = tuple(STICK.rig.joint_of[f"foot.{side}"] for side in "LR") if STICK.rig else ()
TOES = tuple(STICK.rig.joint_of[f"toe1-1.{side}"] for side in "LR") if STICK.rig else ()


def test_feet_do_not_slide_and_do_not_sink() -> None:
    with_feet: list[np.ndarray] = []
    world = world_of(person("anna", -1.5, 0.0), placed("block", box("b", (0.3, 0.3, 0.5)), 3, 3))
    anna = one(world, "anna")
    world.step(1)
    assert anna.walker.walk_to((1.5, 0.8))
    while anna.walker.activity == "walking":
        joints = anna.skeleton().joints
        with_feet.append(np.concatenate([joints[list(TOES)], joints[list(FEET)]]))
        world.step(2)
    feet = np.array(with_feet)
    assert np.hypot(*(feet[-1, 2:].mean(axis=0)[:2] - [1.5, 0.8])) < 0.05
    # While a toe is at its height on the floor its place does not change.
    toes = feet[:, :2]
    assert STICK.rig is not None
    low = toes[..., 2] < STICK.rig.head("toe1-1.L")[2] + 0.0015
    stays = low[1:] & low[:-1]
    slides = np.linalg.norm(np.diff(toes, axis=0)[..., :2], axis=-1)
    assert stays.mean() > 0.3
    assert slides[stays].max() < 0.01
    assert toes[..., 2].min() > STICK.rig.head("toe1-1.L")[2] - 0.005
    world.close()


def test_ways_lead_round_furniture() -> None:
    wall = placed("wall", box("w", (0.2, 3.0, 1.0)), 0.0, 0.0, static=True)
    world = world_of(person("anna", -1.5, 0.0), wall)
    anna = one(world, "anna")
    world.step(1)
    assert anna.walker.walk_to((1.5, 0.0))
    nearest = 9.0
    while anna.walker.activity == "walking":
        x, y = anna.pose().position_m[:2]
        away = np.hypot(max(abs(x) - 0.1, 0.0), max(abs(y) - 1.5, 0.0))
        nearest = min(nearest, float(away))
        world.step(6)
    assert np.hypot(anna.pose().position_m[0] - 1.5, anna.pose().position_m[1]) < 0.05
    assert nearest > 0.18
    assert anna.walker.problem == ""
    world.close()


def test_hands_stay_out_of_what_one_passes() -> None:
    """Where there is room they swing farther than the cylinder that ways are found for."""
    gap_m = 0.36  # from the middle of the way to the walls at its sides
    walls = [
        placed(f"wall_{y}", box(f"w{y}", (4.0, 0.2, 1.8)), 0.0, y, static=True)
        for y in (gap_m + 0.1, -gap_m - 0.1)
    ]
    ends = placed("end", box("e", (0.2, 1.0, 1.8)), 1.6, 0.0, static=True)
    beside, ahead = [], []
    for around in ([*walls, ends], []):
        world = world_of(person("anna", -1.2, 0.0), *around)
        anna = one(world, "anna")
        world.step(1)
        assert anna.walker.walk_to((1.1, 0.0))
        places = []
        while anna.walker.activity == "walking":
            rig, joints = STICK.rig, anna.skeleton().joints
            assert rig is not None
            hands = joints[[rig.joint_of[f"wrist.{side}"] for side in "LR"]]
            places.append(hands - [anna.pose().position_m[0], 0.0, 0.0])
            world.step(6)
        beside.append(np.abs(np.array(places)[..., 1]).max())
        ahead.append(np.array(places)[..., 0].max())
        world.close()
    assert beside[0] < gap_m - 0.03
    assert ahead[0] < 0.6 * ahead[1]


@pytest.mark.parametrize("turn_deg", [0.0, 180.0])
def test_hands_of_one_who_is_put_beside_a_wall_stay_out_of_it(turn_deg: float) -> None:
    """There is no way yet that could say how much room there is."""
    gap_m = 0.26
    wall = placed("wall", box("w", (4.0, 0.2, 1.8)), 0.0, gap_m + 0.1, static=True)
    world = world_of(person("anna", 0.0, -1.5), wall)
    anna = one(world, "anna")
    world.step(1)
    hangs_m = np.abs(_wrists(anna)[:, 1] + 1.5).max()  # where there is room
    anna.put(Pose((0.0, 0.0, 0.0), (0.0, 0.0, *_half_turn(turn_deg))))
    world.step(1)
    assert hangs_m > gap_m - 0.06
    assert _wrists(anna)[:, 1].max() < gap_m - 0.09
    world.close()


def _half_turn(degrees: float) -> tuple[float, float]:
    half = np.radians(degrees) / 2.0
    return float(np.sin(half)), float(np.cos(half))


def _wrists(body: Any) -> np.ndarray:
    assert STICK.rig is not None
    return np.asarray(body.skeleton().joints[[STICK.rig.joint_of[f"wrist.{s}"] for s in "LR"]])


def test_people_do_not_walk_through_each_other() -> None:
    world = world_of(
        person("anna", -2.0, 0.0),
        person("ben", 2.0, 0.05),
        placed("far", box("b", (0.3, 0.3, 0.5)), 4, 4),
    )
    anna, ben = one(world, "anna"), one(world, "ben")
    world.step(1)
    assert anna.walker.walk_to((2.0, 0.0))
    assert ben.walker.walk_to((-2.0, 0.0))
    assert nearest_crossing(world, anna, ben) > 0.3
    assert anna.walker.problem or np.hypot(anna.pose().position_m[0] - 2.0, 0.0) < 0.1
    world.close()


def test_one_sits_upon_a_seat_and_gets_up() -> None:
    world = world_of(
        person("anna", 1.5, 0.6),
        placed("seat", chair(), 0.0, 0.0, 30.0, static=True),
        placed("far", box("b", (0.3, 0.3, 0.5)), 4, 4),
    )
    anna = one(world, "anna")
    world.step(1)
    assert anna.walker.seats() == ("seat",)
    assert anna.walker.sit_on("seat")
    seen = []
    for _ in range(400):
        world.step(12)
        seen.append(anna.walker.activity)
        if anna.walker.activity == "seated":
            break
    assert list(dict.fromkeys(seen)) == ["walking", "sitting down", "seated"]
    rig, joints = STICK.rig, anna.skeleton().joints
    assert rig is not None
    hips = joints[[rig.joint_of["upperleg01.L"], rig.joint_of["upperleg01.R"]]].mean(axis=0)
    own = world.body(world.find("seat")).world_from_body()
    on_seat = own[:3, :3].T @ (hips - own[:3, 3])
    assert 0.46 < on_seat[2] < 0.60
    assert -0.21 < on_seat[0] < 0.25
    assert abs(on_seat[1]) < 0.1
    assert anna.walker.seats() == ("seat",)  # it is her own
    anna.walker.get_up()
    for _ in range(60):
        world.step(12)
    assert anna.walker.activity == "standing"
    world.close()


def test_the_same_seed_gives_the_same_bytes() -> None:
    found = []
    for _ in range(2):
        world = world_of(
            person("anna", -1.0, 0.0, "walk_around", pause=(0.1, 0.4)),
            person("ben", 1.0, 1.0, "sit", sitting=(0.5, 1.0)),
            placed("seat", chair(), 0.0, -2.0, 90.0, static=True),
        )
        world.step(1500)
        found.append(bytes_of(world))
        world.close()
    assert found[0] == found[1]


def test_what_stands_still_of_a_person_is_the_same_bytes() -> None:
    world = world_of(person("anna", 0.0, 0.0))
    world.step(5)
    first = next(iter(world.snapshot().deformations.values())).meshes[0].positions
    world.step(30)
    second = next(iter(world.snapshot().deformations.values())).meshes[0].positions
    assert STICK.rig is not None
    bones = STICK.rig.bones[0][:, 0]
    legs = np.isin(bones, [*FEET, *TOES])
    assert (first[legs] == second[legs]).all()
    assert (first[~legs] != second[~legs]).any()  # it breathes
    world.close()


def test_limbs_push_what_stands_in_their_way() -> None:
    ball = Placement(
        name="ball",
        asset=AssetLibrary().get("sphere"),
        category_id=CATEGORIES.named("sphere").id,
        pose=Pose((0.35, 0.0, 0.06)),
        scale=(0.1, 0.1, 0.1),
        mass_kg=0.3,
    )
    world = world_of(person("anna", -0.8, 0.0), ball)
    anna = one(world, "anna")
    world.step(1)
    before = world.body(world.find("ball")).pose().position_m
    anna.walker._follow([(-0.8, 0.0), (1.2, 0.0)], None)
    touched = set()
    while anna.walker.activity == "walking":
        world.step(4)
        for contact in world.contacts(0.05):
            touched.add((contact.first, contact.second))
    moved = np.subtract(world.body(world.find("ball")).pose().position_m, before)
    assert np.hypot(*moved[:2]) > 0.02
    assert touched
    world.close()


def test_behaviours_of_people_are_refused_for_things() -> None:
    world = world_of(person("anna", 0.0, 0.0), placed("block", box("b", (0.3, 0.3, 0.5)), 3, 3))
    block = world.body(world.find("block"))
    with pytest.raises(InvalidRequest, match="a person for the behaviour 'walk_around'"):
        block.attach(start_behaviour("walk_around", {}, seed=1, object_name="block", place=0))
    world.close()


def test_one_who_is_stout_sits_higher_and_not_in_the_seat() -> None:
    fetch_bodies()
    asset = AssetLibrary(installed_sources()).get("person_19")
    world = world_of(
        placed("ben", asset, 1.2, 0.3),
        placed("bench", box("bench", (0.5, 1.2, 0.45), "bench"), 0, 0),
    )
    ben = one(world, "ben")
    world.step(1)
    assert ben.walker.sit_on("bench")
    while ben.walker.activity != "seated":
        world.step(12)
    matrix = ben.world_from_body()
    skin = contact_skin(asset).places(ben.walker.posture) @ matrix[:3, :3].T + matrix[:3, 3]
    over = (np.abs(skin[:, 0]) < 0.2) & (np.abs(skin[:, 1]) < 0.6) & (skin[:, 2] > 0.2)
    assert 0.425 < float(skin[over, 2].min()) < 0.45  # it presses in by 2 cm
    world.close()


def test_one_who_cannot_pass_another_takes_the_seat_on_this_side() -> None:
    sofa = furniture(
        "sofa", "couch", [((0.9, 2.0, 0.45), (0, 0, 0)), ((0.2, 2.0, 0.9), (-0.35, 0, 0))]
    )
    world = world_of(
        person("anna", 0.87, 0.85),
        person("ben", 0.87, -0.2),
        placed("sofa", sofa, 0.0, 0.0, static=True),
        placed("wall", box("w", (0.1, 4.0, 1.0), "wall"), 1.34, 0.0, static=True),
        placed("end", box("e", (1.8, 0.1, 1.0), "wall"), 0.5, 1.4, static=True),
    )
    anna = one(world, "anna")
    world.step(1)
    assert [seat.y for seat in anna.walker.crowd.seats()] == [-0.5, 0.5]
    assert anna.walker.sit_on("sofa")
    for _ in range(300):
        world.step(12)
        if anna.walker.activity == "seated":
            break
    assert anna.walker.activity == "seated"
    assert anna.pose().position_m[1] > 0.0
    world.close()


def test_one_who_gives_up_stands_even_beside_others() -> None:
    """Ben and Cleo are nearer than people go by: what Anna may do is to stand, and to walk away."""
    walls = [
        placed(f"wall {n}", box(f"w{n}", (3.0, 0.1, 1.0), "wall"), 0.5, y, static=True)
        for n, y in enumerate((-0.45, 0.45))
    ]
    world = world_of(
        person("anna", 0.0, 0.0),
        person("ben", 0.5, 0.0),
        person("cleo", 1.0, 0.0),
        placed("end", box("e", (0.1, 1.0, 1.0), "wall"), 2.05, 0.0, static=True),
        *walls,
    )
    anna = one(world, "anna")
    world.step(1)
    assert anna.walker.walk_to((1.7, 0.0))
    for _ in range(60):
        world.step(12)
    assert anna.walker.activity == "standing"
    assert anna.walker.problem == "someone stands in the way"
    assert anna.walker.walk_to((-1.4, 0.0))
    for _ in range(120):
        world.step(12)
    assert anna.pose().position_m[0] == pytest.approx(-1.4, abs=0.05)
    world.close()
