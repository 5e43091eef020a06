"""Animals of the world: paws that stand, ways round furniture and others, whom behaviours suit."""

from __future__ import annotations

import numpy as np
import pytest

from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.sources import installed_sources
from sailenv_ros.behaviours import start_behaviour
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.model import Asset
from sailenv_ros.world.person_body import PersonBody
from sailenv_ros.world.placement import Placement
from tests.support.peopled_worlds import (
    box,
    bytes_of,
    nearest_crossing,
    one,
    person,
    placed,
    world_of,
)

PAWS = ("forepaw.L", "forepaw.R", "hindpaw.L", "hindpaw.R")


@pytest.fixture(scope="module")
def cat() -> Asset:
    return AssetLibrary(installed_sources()).get("cat_03")


@pytest.fixture(scope="module")
def dog() -> Asset:
    return AssetLibrary(installed_sources()).get("dog_03")


def paws_of(body: PersonBody) -> np.ndarray:
    joints = body.skeleton()
    return np.array([joints.joints[joints.joint_names.index(name)] for name in PAWS])


def skin_of(body: PersonBody) -> np.ndarray:
    """The first mesh in the world: the body without the head."""
    own = body.deformation().meshes[0].positions.astype(np.float64)
    matrix = body.world_from_body()
    return own @ matrix[:3, :3].T + matrix[:3, 3]


@pytest.mark.parametrize("name", ["cat_03", "dog_02"])
def test_paws_that_stand_do_not_move_and_soles_are_on_the_floor(name: str) -> None:
    asset = AssetLibrary(installed_sources()).get(name)
    assert asset.rig is not None
    world = world_of(
        placed("tom", asset, -1.2, 0.0, 160.0), placed("far", box("b", (0.3,) * 3), 3, 3)
    )
    tom = one(world, "tom")
    world.step(1)
    soles = []
    bones = asset.rig.bones[0][:, 0]
    low = asset.model.parts[0].mesh.positions[:, 2] < 1e-6
    for paw in PAWS:
        soles.append(np.flatnonzero(low & (bones == asset.rig.joint_of[paw])))
        assert len(soles[-1]) > 5
    assert tom.walker.walk_to((1.2, 0.9))  # it turns first
    standing, checked = None, np.zeros(4, int)
    while tom.walker.activity == "walking":
        moment = tom.walker._moment()
        paws, skin = paws_of(tom), skin_of(tom)
        for number, place in enumerate(moment.feet):
            if number == moment.swinging:
                continue
            # On its print, with a flat sole that stays as it is.
            assert np.abs(paws[number, :2] - [place.x, place.y]).max() < 1e-9
            assert np.abs(skin[soles[number], 2]).max() < 1e-5
            if standing is not None and moment.feet[number] is standing[0][number]:
                slide = np.abs(skin[soles[number]] - standing[1][soles[number]]).max()
                assert slide < 2e-6
                checked[number] += 1
        assert skin[:, 2].min() > -0.005
        standing = (moment.feet, skin)
        world.step(6)
    assert np.hypot(*np.subtract(tom.pose().position_m[:2], (1.2, 0.9))) < 0.05
    assert (checked > 20).all()
    world.close()


def test_an_animal_walks_round_furniture_and_keeps_out_of_it(cat: Asset) -> None:
    wall = placed("wall", box("w", (0.2, 1.6, 0.6)), 0.0, 0.0, static=True)
    pillar = placed("pillar", box("p", (0.3, 0.3, 0.6)), 0.7, 1.2, 30.0, static=True)
    world = world_of(placed("tom", cat, -1.0, 0.0), wall, pillar)
    tom = one(world, "tom")
    world.step(1)
    assert tom.walker.walk_to((1.0, 0.0))
    turned = np.radians(30.0)
    own = np.array([[np.cos(turned), np.sin(turned)], [-np.sin(turned), np.cos(turned)]])
    deepest = 0.0
    while tom.walker.activity == "walking":
        skin = skin_of(tom)
        in_wall = np.minimum(0.1 - np.abs(skin[:, 0]), 0.8 - np.abs(skin[:, 1]))
        beside = np.abs((skin[:, :2] - [0.7, 1.2]) @ own.T)
        in_pillar = (0.15 - beside).min(axis=1)
        deepest = max(deepest, float(in_wall.max()), float(in_pillar.max()))
        world.step(12)
    assert np.hypot(tom.pose().position_m[0] - 1.0, tom.pose().position_m[1]) < 0.05
    assert deepest < 0.02
    world.close()


def test_a_dog_turns_in_a_circle_of_half_its_length_and_takes_in_its_tail() -> None:
    asset = AssetLibrary(installed_sources()).get("dog_02")
    assert asset.rig is not None
    nose, tail = (float(asset.rig.head(name)[0]) for name in ("nose", "tail01"))
    assert nose == pytest.approx(-tail)
    # A closet: too narrow for one that would turn about the middle of its feet.
    walls = [
        placed(f"wall {number}", box(f"w{number}", size, "wall"), *at, static=True)
        for number, (size, at) in enumerate([
            ((2.4, 0.1, 0.8), (0.0, 0.6)), ((2.4, 0.1, 0.8), (0.0, -0.6)),
            ((0.1, 1.1, 0.8), (-1.15, 0.0)), ((0.1, 1.1, 0.8), (1.15, 0.0)),
        ])
    ]  # fmt: skip
    world = world_of(placed("rex", asset, -0.55, 0.0), *walls)
    rex = one(world, "rex")
    world.step(1)
    for goal in (0.55, -0.55, 0.55):
        deepest = 0.0  # in the first one it takes in its tail
        assert rex.walker.walk_to((goal, 0.0))
        while rex.walker.activity == "walking":
            world.step(12)
            skin = np.abs(skin_of(rex)[:, :2])
            if rex.walker.activity == "walking":
                deepest = max(deepest, float((skin - [1.1, 0.55]).max()))
    assert np.hypot(rex.pose().position_m[0] - 0.55, rex.pose().position_m[1]) < 0.05
    assert deepest < 0.02
    world.close()


def test_animals_and_people_do_not_walk_through_each_other(dog: Asset) -> None:
    world = world_of(
        placed("rex", dog, -1.5, 0.0),
        person("ben", 1.5, 0.05),
        placed("far", box("b", (0.3, 0.3, 0.5)), 4, 4),
    )
    rex, ben = one(world, "rex"), one(world, "ben")
    world.step(1)
    assert rex.walker.walk_to((1.5, 0.0))
    assert ben.walker.walk_to((-1.5, 0.0))
    assert nearest_crossing(world, rex, ben) > 0.35
    assert abs(ben.pose().position_m[0] - 1.5) > 0.5
    world.close()


def test_legs_of_one_that_stands_are_the_same_bytes(cat: Asset) -> None:
    assert cat.rig is not None
    world = world_of(placed("tom", cat, 0.0, 0.0))
    world.step(5)
    first = next(iter(world.snapshot().deformations.values())).meshes[0].positions
    world.step(90)
    second = next(iter(world.snapshot().deformations.values())).meshes[0].positions
    shanks = [cat.rig.joint_of[f"{bone}.{side}"] for bone in ("wrist", "hock") for side in "LR"]
    own = [*shanks, *(cat.rig.joint_of[paw] for paw in PAWS)]
    legs = (np.isin(cat.rig.bones[0], own) * cat.rig.weights[0]).sum(axis=1) > 0.999
    assert legs.sum() > 100
    assert (first[legs] == second[legs]).all()
    assert (first != second).any()  # it breathes
    world.close()


@pytest.mark.parametrize("name", ["cat_02", "dog_01"])
def test_one_sits_down_on_the_floor_and_gets_up(name: str) -> None:
    asset = AssetLibrary(installed_sources()).get(name)
    world = world_of(placed("tom", asset, 0.0, 0.0), placed("far", box("b", (0.3, 0.3, 0.5)), 3, 3))
    tom = one(world, "tom")
    world.step(1)
    assert tom.walker.seats() == ("floor",)
    assert not tom.walker.sit_on("far")
    before = paws_of(tom)
    assert tom.walker.sit_on("floor")
    seen = []
    for _ in range(60):
        world.step(12)
        seen.append(tom.walker.activity)
    assert list(dict.fromkeys(seen)) == ["walking", "sitting down", "seated"]
    paws = paws_of(tom)
    assert np.abs(paws[:2] - before[:2]).max() < 1e-9  # it stands on those in front
    assert np.abs(paws[:, 2] - before[:, 2]).max() < 1e-9
    skeleton = tom.skeleton()
    root, chest = (skeleton.joints[skeleton.joint_names.index(n)] for n in ("root", "spine03"))
    assert root[2] < 0.5 * chest[2]
    low = min(float(mesh.positions[:, 2].min()) for mesh in tom.deformation().meshes)
    assert abs(low) < 0.006  # upon the floor
    tom.walker.get_up()
    for _ in range(30):
        world.step(12)
    assert tom.walker.activity == "standing"
    assert tom.walker.walk_to((1.0, 0.5))
    world.close()


@pytest.mark.parametrize("name", ["cat_02", "dog_02"])
def test_one_lies_down_upon_its_belly_and_gets_up(name: str) -> None:
    asset = AssetLibrary(installed_sources()).get(name)
    world = world_of(placed("tom", asset, 0.0, 0.0), placed("far", box("b", (0.3, 0.3, 0.5)), 3, 3))
    tom = one(world, "tom")
    world.step(1)
    assert tom.walker.beds() == ("floor",)
    assert not tom.walker.lie_on("far")
    assert tom.walker.lie_on("floor")
    seen, stood, fastest = [], None, 0.0
    before = [mesh.positions for mesh in tom.deformation().meshes]
    for _ in range(110):
        world.step(12)
        seen.append(tom.walker.activity)
        skin = [mesh.positions for mesh in tom.deformation().meshes]
        if seen[-1] != "walking":
            fastest = max(fastest, float(np.abs(skin[0] - before[0]).max()))
        before = skin
        assert min(float(points[:, 2].min()) for points in skin) > -0.004
        if seen[-1] != "walking":
            paws = paws_of(tom)
            stood = paws if stood is None else stood
            assert np.abs(paws - stood).max() < 1e-9
    assert list(dict.fromkeys(seen)) == ["walking", "lying down", "lying"]
    assert fastest < 0.05  # in 1/20 s: no bone turns over
    assert asset.rig is not None
    own = asset.rig.joint_of
    trunk = np.isin(asset.rig.bones[0][:, 0], [own[n] for n in ("belly", "spine02", "spine03")])
    assert abs(float(skin[0][trunk, 2].min())) < 0.006  # the belly is upon the floor
    skeleton = tom.skeleton()
    elbow, root = (
        skeleton.joints[skeleton.joint_names.index(name)][2] for name in ("forearm.L", "root")
    )
    assert elbow < 0.2 * asset.rig.head("forearm.L")[2] + 0.02
    assert root < 0.6 * asset.rig.head("root")[2]
    tom.walker.get_up()
    for _ in range(40):
        world.step(12)
    assert tom.walker.activity == "standing"
    assert tom.walker.walk_to((1.0, 0.5))
    world.close()


def tail_tips(name: str, *others: Placement) -> tuple[np.ndarray, np.ndarray]:
    """Where joints of a tail are in ten seconds, (T, 2, 3), and where the head points [deg]."""
    asset = AssetLibrary(installed_sources()).get(name)
    world = world_of(placed("tom", asset, 0.0, 0.0), *others)
    tom = one(world, "tom")
    joints, tips, turned = tom.skeleton().joint_names, [], []
    for _ in range(300):
        world.step(8)
        places = tom.skeleton().joints
        tips.append([places[joints.index(part)] for part in ("tail05", "tail07")])
        nose = places[joints.index("nose")] - places[joints.index("head")]
        turned.append(float(np.degrees(np.arctan2(nose[1], nose[0]))))
    world.close()
    return np.array(tips), np.array(turned)


@pytest.mark.parametrize("name", ["cat_01", "dog_02"])
def test_the_tail_of_one_who_sees_somebody_tells_it(name: str) -> None:
    alone, _ = tail_tips(name, placed("far", box("b", (0.3, 0.3, 0.5)), 3, 3))
    tips, turned = tail_tips(name, person("ben", 1.0, 1.2))
    at_him = np.abs(turned - np.degrees(np.arctan2(1.2, 1.0))) < 12.0
    assert at_him.sum() > 90  # it looks at him, now and then
    glad = tips[at_him]
    held, held_alone = (float(np.median(part[:, 0, 2])) for part in (glad, alone))
    assert held > held_alone + 0.01
    assert np.ptp(glad[:, 1, 1]) > (1.2 if name == "cat_01" else 3.0) * np.ptp(alone[:, 1, 1])
    # Nothing jumps: from frame to frame the tip goes a small part of its way.
    steps = np.linalg.norm(np.diff(tips[:, 1], axis=0), axis=1)
    assert steps.max() < 0.3 * np.ptp(tips[:, 1, 1])


def test_behaviours_that_need_hands_are_refused(cat: Asset) -> None:
    world = world_of(placed("tom", cat, 0.0, 0.0))
    tom = world.body(world.find("tom"))
    tom.attach(start_behaviour("walk_around", {}, seed=1, object_name="tom", place=0))
    orders = {"objects": ["a"], "to": ["b"]}
    fetches = start_behaviour("fetch", orders, seed=1, object_name="tom", place=1)
    with pytest.raises(InvalidRequest, match="a person for the behaviour 'fetch'"):
        tom.attach(fetches)
    world.close()


def test_the_same_seed_gives_the_same_bytes(cat: Asset) -> None:
    found = []
    for _ in range(2):
        strolls = start_behaviour(
            "walk_around", {"pause": (0.1, 0.4)}, seed=3, object_name="tom", place=0
        )
        world = world_of(
            placed("tom", cat, -1.0, 0.0, behaviours=(strolls,)),
            placed("far", box("b", (0.3, 0.3, 0.5)), 2, 2),
        )
        world.step(900)
        found.append(bytes_of(world))
        world.close()
    assert found[0] == found[1]
