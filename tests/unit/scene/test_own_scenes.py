"""The scenes of the package load without an error and are what they say."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np
import pytest

from sailenv_ros.assets import AssetLibrary, ObjectFit, load_categories
from sailenv_ros.assets.skies import sky_files
from sailenv_ros.assets.sources import installed_packs, installed_sources
from sailenv_ros.assets.surfaces import surface_names
from sailenv_ros.behaviours import behaviour_errors
from sailenv_ros.errors import SceneError
from sailenv_ros.scene import SceneCatalogue, SceneKnowledge, SceneSpec, load_scene
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose, interpolate

LIBRARY = AssetLibrary(installed_sources())
KNOWLEDGE = SceneKnowledge(
    assets=LIBRARY.all_names,
    categories=tuple(category.name for category in load_categories().values()),
    behaviour_errors=behaviour_errors,
    object_errors=ObjectFit(LIBRARY),
    surfaces=surface_names(),
    skies=tuple(sky_files(pack.folder for pack in installed_packs())),
)
NAMES = ("object_view", "optical", "solid_benchmark")


def _load(name: str) -> SceneSpec:
    return load_scene(SceneCatalogue().path(name), knowledge=KNOWLEDGE)


def test_the_package_has_these_scenes() -> None:
    assert set(NAMES) <= set(SceneCatalogue().names)


def test_scenes_of_the_package_have_no_fault() -> None:
    """They load, say what they are, and name the schema for editors in their first line."""
    faults = {}
    for name in SceneCatalogue().names:
        first = SceneCatalogue().path(name).read_text(encoding="utf-8").partition("\n")[0]
        try:
            spec = _load(name)
        except SceneError as problem:
            faults[name] = str(problem)
            continue
        if first != "# yaml-language-server: $schema=scene.schema.json":
            faults[name] = first
        if not (spec.name == name and spec.title and spec.description):
            faults[name] = f"{spec.name!r} has title {spec.title!r}, {spec.description!r}"
    assert faults == {}


def test_optical_is_rotating_cubes_of_one_colour_and_a_cylinder_above_a_plane() -> None:
    moving = [entry for entry in _load("optical").objects if not entry.static]
    assert [entry.asset for entry in moving].count("cylinder") == 1
    assert [entry.asset for entry in moving].count("cube") == len(moving) - 1 >= 4
    for entry in moving:
        assert [behaviour.type for behaviour in entry.behaviours] == ["rotate_rigidbody"]
        assert entry.colour is not None
        assert not entry.gravity
    assert len({entry.colour for entry in moving}) == len(moving)
    assert len({entry.scale for entry in moving}) == len(moving)


def _radius(spec: SceneSpec, index: int) -> float:
    """Of the ball around an object that holds it however it turns."""
    entry = spec.objects[index]
    bounds = LIBRARY.get(entry.asset).model.bounds() * np.asarray(entry.scale)
    return float(np.linalg.norm(np.abs(bounds).max(axis=0)))


def test_nothing_in_optical_can_touch_anything_however_it_turns() -> None:
    spec = _load("optical")
    turning = [i for i, entry in enumerate(spec.objects) if not entry.static]
    for i, j in itertools.combinations(turning, 2):
        apart = np.linalg.norm(np.subtract(spec.objects[i].position, spec.objects[j].position))
        assert apart > _radius(spec, i) + _radius(spec, j)
    for i in turning:
        assert spec.objects[i].position[2] > _radius(spec, i)


def _track(spec: SceneSpec) -> Iterator[Pose]:
    (mover,) = spec.all_movers
    poses = mover.waypoint_poses
    assert mover.loop
    assert len(poses) >= 5
    for start, end in zip(poses, (*poses[1:], poses[0]), strict=True):
        for fraction in (0.0, 0.25, 0.5, 0.75):
            yield interpolate(start, end, fraction)


@pytest.mark.parametrize("name", NAMES)
def test_the_mover_never_enters_an_object(name: str) -> None:
    spec = _load(name)
    near_m = CameraIntrinsics().near_m
    for pose in _track(spec):
        for index, entry in enumerate(spec.objects):
            apart = np.linalg.norm(np.subtract(pose.position_m, entry.position))
            assert entry.asset == "plane" or apart > _radius(spec, index) + near_m


@pytest.mark.parametrize("name", NAMES)
def test_from_everywhere_on_the_track_most_objects_are_in_the_picture(name: str) -> None:
    spec = _load(name)
    centres = [(*entry.position, 1.0) for entry in spec.objects if entry.asset != "plane"]
    for pose in _track(spec):
        camera = Camera(pose=pose)
        seen = camera.intrinsics.project((camera.camera_from_world @ np.transpose(centres))[:3].T)
        inside = (seen >= 0).all(axis=1) & (seen <= [639, 479]).all(axis=1)
        assert inside.mean() > 0.5
