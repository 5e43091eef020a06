"""Depth sensors err as the publications say that their files name."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.errors import SceneError, UnknownName
from sailenv_ros.render.depth_sensors import DepthSensor, Surfaces, depth_sensor
from sailenv_ros.render.depth_sensors.sensor_file import read_depth_sensor
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.depth_sensor_names import depth_sensor_file, depth_sensor_names

NAMES = depth_sensor_names()[1:]
NARROW = CameraIntrinsics(width=200, height=150, vertical_fov_deg=8.0)
WIDE = CameraIntrinsics(width=320, height=240, vertical_fov_deg=46.0)
WHITE = 0.8


def plane(
    lens: CameraIntrinsics, distance_m: float, angle_deg: float, *, albedo: float = WHITE
) -> Surfaces:
    """Return a plane through a point of the axis, turned about the vertical."""
    angle = math.radians(angle_deg)
    normal = np.array([math.sin(angle), 0.0, -math.cos(angle)])
    rays = lens.rays()
    depth = normal[2] * distance_m / (rays @ normal)
    return surfaces(lens, np.where(depth > 0, depth, np.inf), normal, albedo)


def surfaces(
    lens: CameraIntrinsics,
    depth: NDArray[np.float64],
    normal: NDArray[np.float64],
    albedo: float,
    roughness: float = 1.0,
) -> Surfaces:
    """Return surfaces of one normal and one material."""
    shape = (lens.height, lens.width)
    return Surfaces(
        lens=lens,
        depth=depth.astype(np.float32),
        normals=np.broadcast_to(normal.astype(np.float32), (*shape, 3)),
        albedo=np.full((*shape, 3), albedo, np.float32),
        metallic_roughness=np.broadcast_to(np.array([0, roughness], np.float32), (*shape, 2)),
    )


def nguyen(z: NDArray[np.float64], angle: NDArray[np.float64], _: object) -> NDArray[np.float64]:
    """Return Nguyen, Izadi and Lovell's standard deviation of Kinect v1."""
    flat = angle / (math.pi / 2 - angle)
    return 0.0012 + 0.0019 * (z - 0.4) ** 2 + 0.0001 / np.sqrt(z) * flat**2


def stereo(z: NDArray[np.float64], _: object, __: object) -> NDArray[np.float64]:
    """Return Intel's: a subpixel error of 0.08 px, 424 px, 50 mm."""
    return z**2 * 0.08 / (424 * 0.05)


def photons(
    z: NDArray[np.float64], angle: NDArray[np.float64], lengths: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return shot noise that reaches 17 mm at 3.86 m on 15 % reflectance, along the axis."""
    at_one_metre = 0.017 * math.sqrt(0.15) / 3.86
    return at_one_metre * z / np.sqrt(WHITE * np.cos(angle)) + 0 * lengths


PUBLISHED: dict[str, Callable[..., NDArray[np.float64]]] = {
    "kinect_v1": nguyen,
    "realsense_d435": stereo,
    "azure_kinect": photons,
}
SPANS = {"kinect_v1": (0.8, 4.0), "realsense_d435": (0.5, 5.0), "azure_kinect": (0.8, 3.4)}


@pytest.mark.parametrize("name", NAMES)
def test_noise_follows_the_published_curve(name: str) -> None:
    """On planes at five distances and four angles, within a tenth."""
    for distance in np.linspace(*SPANS[name], 5):
        for angle in (0.0, 20.0, 40.0, 60.0):
            seen = plane(NARROW, distance, angle)
            rays = NARROW.rays()
            lengths = np.linalg.norm(rays, axis=-1)
            incidence = np.arccos(seen.cosine.astype(np.float64))
            truth = seen.depth.astype(np.float64)
            error = depth_sensor(name).measure(seen, 5) - truth
            found = error / PUBLISHED[name](truth, incidence, lengths)
            found = found[np.isfinite(found)]
            assert len(found) > 5_000, (distance, angle)
            assert abs(found.mean()) < 0.1, (distance, angle)
            assert 0.9 < found.std() < 1.1, (distance, angle, found.std())


@pytest.mark.parametrize("name", NAMES)
def test_holes_grow_with_angle_distance_and_darkness(name: str) -> None:
    """Each at a time, from next to none to nearly all."""
    sensor = depth_sensor(name)

    def lost(distance: float, angle: float, albedo: float) -> float:
        measured = sensor.measure(plane(NARROW, distance, angle, albedo=albedo), 1)
        return float(np.isnan(measured).mean())

    nearest, farthest = sensor.range
    middle = 0.5 * (nearest + min(farthest, 4.0))
    by_angle = [lost(middle, angle, WHITE) for angle in (0, 30, 60, 75, 82, 88)]
    assert by_angle == sorted(by_angle)
    # Beside what the second view does not see.
    assert by_angle[0] < 0.4
    assert by_angle[-1] > 0.6
    by_light = [lost(0.9 * farthest, 0.0, albedo) for albedo in (0.8, 0.04, 0.02, 0.001)]
    assert by_light == sorted(by_light)
    assert by_light[-1] > 0.99
    assert lost(1.5 * farthest, 0.0, WHITE) == lost(0.8 * nearest, 0.0, WHITE) == 1.0


def step_edge(gap_m: float = 1.0) -> Surfaces:
    """Return a wall 2 m away, before which a board stands in the middle third."""
    depth = np.full((WIDE.height, WIDE.width), 2.0)
    depth[:, 107:213] = 2.0 - gap_m
    return surfaces(WIDE, depth, np.array([0.0, 0.0, -1.0]), WHITE)


def test_the_second_view_leaves_a_shadow_beside_near_things() -> None:
    """At their left for a baseline to the right, as wide as the disparities differ."""
    for name in ("kinect_v1", "realsense_d435"):
        sensor = depth_sensor(name)
        measured = sensor.measure(step_edge(), 3)
        lost = np.isnan(measured).mean(axis=0)
        width = WIDE.fx * sensor.method.baseline * (1 / 1.0 - 1 / 2.0)
        left = lost[107 - round(width) + 2 : 107 - 2]
        right = lost[213 + 3 : 213 + 3 + len(left)]
        assert left.min() > 0.7
        assert right.max() < 0.3


def test_time_of_flight_mixes_near_and_far_at_outlines() -> None:
    """Flying pixels lie between the two; surfaces that are far apart give holes instead."""
    sensor = depth_sensor("azure_kinect")
    mixed = sensor.measure(step_edge(0.2), 3)[:, [106, 107]]
    flying = (mixed > 1.83) & (mixed < 1.97)
    assert flying.mean() > 0.9
    assert np.isnan(sensor.measure(step_edge(1.0), 3)[:, [106, 107]]).all()
    inside = sensor.measure(step_edge(0.2), 3)[:, 110:210]
    assert np.nanmax(np.abs(inside - 1.8)) < 0.03


def test_equal_seeds_give_equal_bytes_and_others_do_not() -> None:
    """For each sensor; neighbours of a matched window share their noise."""
    seen = plane(WIDE, 2.0, 20.0)
    for name in NAMES:
        first, again, other = (depth_sensor(name).measure(seen, seed) for seed in (7, 7, 8))
        np.testing.assert_array_equal(first, again)
        assert not np.array_equal(first, other, equal_nan=True)
    error = depth_sensor("realsense_d435").measure(plane(NARROW, 2.0, 0.0), 1) - 2.0
    error = np.where(np.isfinite(error), error, 0.0)
    near, far = (np.mean(error[:, :-k] * error[:, k:]) / error.var() for k in (1, 20))
    assert near > 0.6
    assert abs(far) < 0.1


def test_a_file_of_a_sensor_is_checked_as_a_whole(tmp_path: Path) -> None:
    """Each error with its line and column."""
    with pytest.raises(UnknownName, match="kinect_v1"):
        depth_sensor_file("kinect_v9")
    text = depth_sensor_file("kinect_v1").read_text()
    path = tmp_path / "mine.yaml"
    path.write_text(text)
    assert isinstance(read_depth_sensor(path), DepthSensor)
    path.write_text(
        text.replace("[0.5, 5.0]", "[5.0, 0.5]")
        .replace("focal_length: 585", "focal_length: -1")
        .replace("correlation: 3", "corelation: 3")
    )
    with pytest.raises(SceneError) as raised:
        read_depth_sensor(path)
    places = {(found.line, found.field) for found in raised.value.diagnostics}
    assert all(line > 0 for line, _ in places)
    assert {"range", "method.focal_length", "method.corelation"} <= {field for _, field in places}
