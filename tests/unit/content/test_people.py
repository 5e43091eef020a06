"""People who are made of fetched data: their looks, meshes, clothes, keypoints in a frame."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from sailenv_content.people.fetch_bodies import body_data, fetch_bodies
from sailenv_content.people.figures import Build, figure
from sailenv_content.people.growth import stature_m
from sailenv_content.people.looks import people
from sailenv_content.people.makehuman import BODY_VERTICES, BodyData
from sailenv_content.people.making import make_person
from sailenv_content.people.source import IN_PARTS, PeopleSource
from sailenv_ros import AgentSpec, CameraIntrinsics, Simulation
from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.sources import installed_sources
from sailenv_ros.dataset.formats.coco import _keypoints
from sailenv_ros.errors import AssetError, UnknownName
from sailenv_ros.postures.figure import figure_of
from sailenv_ros.postures.footsteps import moment_of, standing_feet
from sailenv_ros.postures.skeleton import joint_frames, skin_matrices
from sailenv_ros.postures.walking import walking_posture
from sailenv_ros.scene.randomise.things import random_people
from sailenv_ros.types.geometry import look_at
from sailenv_ros.types.model import Asset
from sailenv_ros.types.rig import Rig
from sailenv_ros.types.skeleton import COCO_KEYPOINTS
from sailenv_ros.world.skin import skin_over

SCENE = """
version: 1
objects:
  - {name: ground, asset: plane, static: true}
  - {name: anna, asset: person_01, position: [2, 0, 0], rotation: [0, 0, 180]}
  - {name: box, asset: cube, position: [1, 0, 0.3], scale: [0.1, 1.0, 0.6], static: true}
"""


@pytest.fixture(scope="module")
def data() -> BodyData:
    fetch_bodies()
    found = body_data()
    assert found is not None
    return found


def test_people_are_those_that_chance_may_choose() -> None:
    assert tuple(people()) == random_people.PEOPLE
    assert random_people.IN_PARTS == IN_PARTS
    assert len(people()) >= 24


@pytest.mark.parametrize(
    ("years", "female", "tall_m"),
    [(4, 0.0, 1.025), (9, 1.0, 1.33), (30, 1.0, 1.632), (20, 0, 1.768)],
)
def test_bodies_are_as_tall_as_people_are(
    data: BodyData, years: float, female: float, tall_m: float
) -> None:
    assert stature_m(years, female) == pytest.approx(tall_m, abs=0.001)
    build = Build(female=female, age_years=years, stature_m=tall_m)
    body = figure(data, build)[:BODY_VERTICES]
    assert body[:, 2].min() == pytest.approx(0.0)
    assert body[:, 2].max() == pytest.approx(tall_m, abs=1e-5)


def test_two_of_a_hundred_are_taller_than_two_standard_deviations() -> None:
    assert stature_m(20, 0.0, 1.0) == pytest.approx(1.768 * 1.08)
    assert stature_m(20, 0.0, 0.0) == pytest.approx(1.768 * 0.92)


def test_a_person_is_the_same_bytes_and_wears_what_is_said(data: BodyData) -> None:
    look = people()["person_09"]
    first, second = (make_person("someone", look, data, labelled=True) for _ in range(2))
    for one, other in zip(first.model.parts, second.model.parts, strict=True):
        assert one.mesh.positions.tobytes() == other.mesh.positions.tobytes()
    assert {part.name for part in first.parts} == {"hair", "shirt", "skirt", "shoes"}
    assert first.model.triangle_count < 16000
    assert first.rig is not None
    for bones, weights in zip(first.rig.bones, first.rig.weights, strict=True):
        assert np.allclose(weights.sum(axis=1), 1.0, atol=1e-5)
        assert int(bones.max()) < len(first.rig.names)
    assert [point.name for point in first.rig.points] == list(COCO_KEYPOINTS)
    assert abs(float(first.model.bounds()[0, 2])) < 0.002


def test_a_person_is_made_once_for_all_processes(
    data: BodyData, monkeypatch: pytest.MonkeyPatch
) -> None:
    """To make one takes some seconds: another source reads what the first one kept."""
    made = make_person("person_02", people()["person_02"], data)
    PeopleSource().load("person_02")
    monkeypatch.setattr("sailenv_content.people.making.make_person", None)
    read = PeopleSource().load("person_02")
    assert made.rig is not None
    assert read.rig is not None
    assert read.rig.points == made.rig.points
    assert read.rig.heads.tobytes() == made.rig.heads.tobytes()
    assert (read.mass_kg, read.collision) == (made.mass_kg, made.collision)
    for one, other in zip(read.model.parts, made.model.parts, strict=True):
        assert one.mesh.positions.tobytes() == other.mesh.positions.tobytes()
        assert one.material.base_colour == other.material.base_colour


def test_without_data_there_are_no_people(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr("sailenv_content.people.source.body_data", lambda: None)
    source = PeopleSource()
    assert dict(source.display_names) == {}
    with pytest.raises(AssetError, match="sailenv assets people"):
        source.load("person_01")


def test_people_stand_in_no_list_but_have_names() -> None:
    """Whoever looks at all objects of the catalogue would have to make them all: some minutes."""
    library = AssetLibrary(installed_sources())
    assert not [name for name in library.names if name.startswith("person_")]
    assert library.canonical("person_01_in_parts") == "person_01_in_parts"
    assert not library.has("person_99")
    with pytest.raises(UnknownName, match="person must be one of: person_01, "):
        library.canonical("person_99")


def test_keypoints_say_what_hides_them(data: BodyData, tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE)
    lens = CameraIntrinsics(width=320, height=240, vertical_fov_deg=60.0)
    eye = AgentSpec(name="eye", intrinsics=lens, following=False)
    with Simulation(path, mode="lockstep", agent=eye) as simulation:
        simulation.set_pose(look_at((-1.0, 0.0, 1.0), (2.0, 0.0, 0.9)), teleport=True)
        simulation.step(2)
        frame = simulation.capture(["depth", "instance", "category"])
        ids = {one.name: one.id for one in simulation.info.instances}
    points = frame.keypoints(ids["anna"])
    place = {name: number for number, name in enumerate(points.names)}
    assert points.visible[place["nose"]]
    assert points.hidden_by[place["nose"]] == 0
    for side in ("left", "right"):
        assert points.hidden_by[place[f"{side} ankle"]] == ids["box"]
    u, v = np.rint(points.pixels[place["nose"]]).astype(int)
    assert frame["instance"][v, u] == ids["anna"]
    # She faces the camera: her left is on the right of the picture.
    left, right = (points.pixels[place[f"{side} shoulder"]] for side in ("left", "right"))
    assert left[0] > right[0] + 10
    told = _keypoints(frame, ids["anna"])["keypoints"]
    assert told[2] == 2
    assert told[3 * COCO_KEYPOINTS.index("left ankle") + 2] == 1
    assert len(frame.joints(ids["anna"]).names) == 58
    row = frame.objects.row(ids["anna"])
    assert frame.objects.box_sizes[row][1] < 0.75  # her arms hang


@pytest.mark.parametrize("name", ["person_08", "person_24"])
def test_hands_of_one_who_stands_hang_beside_the_clothes(data: BodyData, name: str) -> None:
    asset = make_person(name, people()[name], data, labelled=True)
    assert asset.rig is not None
    hangs, touches = (
        hand_off_clothes(asset, rig) for rig in (asset.rig, replace(asset.rig, arms_out=0.0))
    )
    assert hangs > 0.008
    assert touches < 0.002


def hand_off_clothes(asset: Asset, rig: Rig) -> float:
    """How far hands are from the cloth around hips and legs; below 0 within it [m]."""
    feet = standing_feet(0.0, 0.0, 0.0, figure_of(rig).stride)
    frames = joint_frames(rig, walking_posture(rig, moment_of(feet), 0.0))
    moved = skin_over(asset.model, rig, skin_matrices(rig, *frames)).meshes
    is_hand = [name.startswith(("wrist", "finger")) for name in rig.names]
    main = rig.bones[1][np.arange(len(rig.bones[1])), rig.weights[1].argmax(axis=1)]
    hands = moved[1].positions[np.array(is_hand)[main]]
    off = [9.0]
    for part in asset.parts:
        for place in part.meshes if part.name == "trousers" else ():
            triangles = asset.model.parts[place].mesh.triangles
            middles, facing = (
                values[triangles].mean(axis=1)
                for values in (moved[place].positions, moved[place].normals)
            )
            away, near = cKDTree(middles).query(hands, distance_upper_bound=0.05)
            some = np.isfinite(away)
            between = hands[some] - middles[near[some]]
            off += np.einsum("ij,ij->i", between, facing[near[some]]).tolist()
    return min(off)
