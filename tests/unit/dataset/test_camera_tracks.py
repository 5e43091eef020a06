"""Where cameras of a recipe are: each kind keeps the ranges that the recipe says, exactly."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
import yaml

from sailenv_ros.dataset.camera_tracks import Track, track_of, turning
from sailenv_ros.dataset.recipe_cameras import FixedCamera, OrbitCamera, RuleCamera, WalkCamera
from sailenv_ros.errors import NoFreeSpace
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.types.geometry import Pose, look_at
from tests.support.lockstep_core import lockstep_core

CRATES = {"a": (1.2, 0.9), "b": (-1.4, -0.6), "c": (0.2, -1.1)}
ROOM: dict[str, Any] = {
    "version": 1,
    "room": {"size": [5, 4, 3]},
    "objects": [
        {"name": name, "asset": "cube", "position": [x, y, 0.4], "scale": 0.8, "static": True}
        for name, (x, y) in CRATES.items()
    ],
}  # fmt: skip
TIMES = np.arange(12) / 10.0
SEEDS = range(8)


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Iterator[SynchronousSimulation]:
    path = tmp_path_factory.mktemp("scene") / "room.yaml"
    path.write_text(yaml.safe_dump(ROOM))
    core = lockstep_core(path)
    yield core
    core.close()


def tracks(camera: Any, scene: SynchronousSimulation) -> list[Track]:
    """The camera's way by several seeds."""
    return [track_of(camera, scene, TIMES, np.random.default_rng(seed)) for seed in SEEDS]


def places(track: Track) -> np.ndarray:
    return np.array([pose.position_m for pose in track])


def test_a_fixed_camera_stands_still() -> None:
    """At its position, facing what it looks at, in every frame."""
    camera = FixedCamera(type="fixed", position=(1.0, 2.0, 1.5), look_at=(0.0, 0.0, 0.5))
    nothing: Any = None  # it asks for no scene
    track = track_of(camera, nothing, TIMES, np.random.default_rng(1))
    assert list(track) == [look_at((1.0, 2.0, 1.5), (0.0, 0.0, 0.5))] * len(TIMES)


def test_a_rule_s_camera_turns_where_it_stands() -> None:
    """At a rate of its range, about the vertical; pitch and roll stay."""
    start = Pose.from_rpy_deg((1.0, 0.0, 1.2), (3.0, 10.0, 20.0))
    camera = RuleCamera(type="rule", rule="free_view", turn=(-30.0, -10.0))
    track = turning(start, camera, TIMES, np.random.default_rng(2))
    angles = np.array([pose.rpy_deg for pose in track])
    np.testing.assert_allclose(places(track), np.tile(start.position_m, (len(TIMES), 1)))
    np.testing.assert_allclose(angles[:, :2], [[3.0, 10.0]] * len(TIMES), atol=1e-9)
    rates = np.diff(angles[:, 2]) / np.diff(TIMES)
    np.testing.assert_allclose(rates, rates[0], rtol=1e-9)
    assert -30.0 <= rates[0] <= -10.0


def test_an_orbit_keeps_its_ranges(scene: SynchronousSimulation) -> None:
    """Distance, elevation and rate around a point that it faces from every place."""
    middle = np.array([0.0, 0.6, 1.5])
    camera = OrbitCamera(
        type="orbit", point=tuple(middle), distance=(0.6, 1.0), elevation=(5.0, 30.0),
        turn=(40.0, 60.0),
    )  # fmt: skip
    found = set()
    for track in tracks(camera, scene):
        ways = places(track) - middle
        away = np.linalg.norm(ways, axis=1)
        elevation = np.degrees(np.arcsin(ways[:, 2] / away))
        azimuth = np.unwrap(np.arctan2(ways[:, 1], ways[:, 0]))
        rates = np.degrees(np.diff(azimuth)) / np.diff(TIMES)
        for values, low, high in ((away, 0.6, 1.0), (elevation, 5.0, 30.0), (rates, 40.0, 60.0)):
            np.testing.assert_allclose(values, values[0], rtol=1e-9)
            assert low <= values[0] <= high
        forward = np.array([pose.matrix()[:3, 0] for pose in track])
        np.testing.assert_allclose(forward, -ways / away[:, None], atol=1e-9)
        found.add(round(float(away[0]), 6))
    assert len(found) == len(SEEDS)


def test_an_orbit_sees_its_object_all_the_way(scene: SynchronousSimulation) -> None:
    """One of the objects that are meant is the first thing on the line to its middle."""
    camera = OrbitCamera(type="orbit", object=("a", "c"), distance=(1.0, 1.6), turn=(90.0, 90.0))
    seen = set()
    ids = {one.name: one.id for one in scene.info.instances}
    for track in tracks(camera, scene):
        eyes = places(track)
        forward = np.array([pose.matrix()[:3, 0] for pose in track])
        hits = set(scene.cast_rays(eyes, forward).instance_ids.tolist())
        assert len(hits) == 1
        seen |= hits
    assert seen == {ids["a"], ids["c"]}


def test_where_nothing_is_in_sight_it_says_so(scene: SynchronousSimulation) -> None:
    """From beyond the walls, and of what is not there."""
    far = OrbitCamera(type="orbit", object=("a",), distance=(20.0, 21.0))
    other = OrbitCamera(type="orbit", object=("sofa",))
    for camera, sentence in ((far, "no free sight of 'a'"), (other, "no object and no category")):
        with pytest.raises(NoFreeSpace, match=sentence):
            track_of(camera, scene, TIMES, np.random.default_rng(1))


def test_a_walk_keeps_its_ranges(scene: SynchronousSimulation) -> None:
    """Height, pitch, speed, and the distance from everything, also between frames."""
    camera = WalkCamera(
        type="walk", eye_height=(1.1, 1.4), pitch=(5.0, 20.0), speed=(0.5, 0.9), clearance=0.3
    )
    for track in tracks(camera, scene):
        eyes = places(track)
        angles = np.array([pose.rpy_deg for pose in track])
        assert 1.1 <= eyes[0, 2] <= 1.4
        assert 5.0 <= angles[0, 1] <= 20.0
        np.testing.assert_allclose(eyes[:, 2], eyes[0, 2], atol=1e-9)
        np.testing.assert_allclose(angles[:, :2], [[0.0, angles[0, 1]]] * len(TIMES), atol=1e-6)
        # Corners are cut between two frames: never faster, and mostly as fast.
        speeds = np.linalg.norm(np.diff(eyes, axis=0), axis=1) / np.diff(TIMES)
        assert speeds.max() <= 0.9 + 1e-9
        assert np.median(speeds) >= 0.5 - 1e-9
        between = np.concatenate([eyes[:-1] + share * np.diff(eyes, axis=0)
                                  for share in (0.0, 0.5, 1.0)])  # fmt: skip
        # The map says of cells' middles what is free.
        least = 0.3 - 0.05 * math.sqrt(0.5)
        assert (np.abs(between[:, :2]) <= np.array([2.5, 2.0]) - least).all()
        for x, y in CRATES.values():
            over = np.maximum(np.abs(between[:, :2] - (x, y)) - 0.4, 0.0)
            assert np.linalg.norm(over, axis=1).min() >= least
