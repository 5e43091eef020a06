"""A room in the pictures: openings show the outside, walls have their ids and exact depth."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose, look_at
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.render.conftest import Render
from tests.support.built_world import built_snapshot

ROOM = {
    "size": [4.4, 3.6, 2.6],
    "walls": "white_tiles",
    "floor": "oak_parquet",
    "openings": [
        {"type": "window", "wall": "north", "at": 0.4, "width": 1.4, "height": 1.3, "sill": 0.9},
        {"type": "door", "wall": "east", "at": -0.8},
    ],
}


@pytest.fixture(scope="module")
def room() -> WorldSnapshot:
    """The room, with a window to the north and a closed door to the east."""
    return built_snapshot({"room": ROOM})


def camera(pose: Pose, **keys: Any) -> Camera:
    return Camera(intrinsics=CameraIntrinsics(width=320, height=240, **keys), pose=pose)


def id_of(room: WorldSnapshot, name: str) -> int:
    (found,) = (d.instance.id for d in room.contents.instances if d.instance.name == name)
    return found


@pytest.mark.parametrize(
    ("name", "towards", "distance"),
    [
        ("north wall", (-1.8, 5.0, 2.3), 1.8),
        ("east wall", (5.0, 1.0, 2.3), 2.2),
        ("south wall", (0.0, -5.0, 1.0), 1.8),
        ("west wall", (-5.0, 0.0, 1.0), 2.2),
    ],
)
def test_a_wall_has_its_id_and_its_exact_depth(
    render: Render, room: WorldSnapshot, name: str, towards: tuple[float, ...], distance: float
) -> None:
    """Looking straight at a wall's inner face: one id, one category, one depth to 1e-6."""
    eye = (0.0, towards[1], towards[2]) if abs(towards[0]) == 5.0 else (towards[0], 0.0, towards[2])
    views = render(
        room, camera(look_at(eye, towards), vertical_fov_deg=5.0), "depth", "instance", "category"
    )
    assert (views["instance"] == id_of(room, name)).all()
    assert (views["category"] == 51).all()
    np.testing.assert_allclose(views["depth"], distance, rtol=1e-6)


def test_floor_and_ceiling_are_where_they_should_be(render: Render, room: WorldSnapshot) -> None:
    for name, category, pitch, distance in (("floor", 52, 90.0, 1.5), ("ceiling", 53, -90.0, 1.1)):
        pose = Pose.from_rpy_deg((0.0, 0.0, 1.5), (0.0, pitch, 0.0))
        views = render(room, camera(pose, vertical_fov_deg=20.0), "depth", "instance", "category")
        assert (views["instance"] == id_of(room, name)).all()
        assert (views["category"] == category).all()
        np.testing.assert_allclose(views["depth"], distance, rtol=1e-6)


def test_rays_through_the_panes_hit_nothing(render: Render, room: WorldSnapshot) -> None:
    """Both casements of the window show the background, and the mullion between them is it."""
    for along, expected in ((0.05, 0), (0.75, 0), (0.4, id_of(room, "window 1"))):
        pose = look_at((along, 0.0, 1.6), (along, 5.0, 1.6))
        views = render(room, camera(pose, vertical_fov_deg=2.0), "depth", "instance")
        assert (views["instance"] == expected).all()
        assert np.isinf(views["depth"]).all() == (expected == 0)


def test_a_closed_door_fills_its_opening(render: Render, room: WorldSnapshot) -> None:
    pose = look_at((0.0, -0.8, 1.2), (5.0, -0.8, 1.2))
    views = render(room, camera(pose, vertical_fov_deg=15.0), "instance")
    assert (views["instance"] == id_of(room, "door 1")).all()


def test_nothing_shows_through_the_joints(render: Render, room: WorldSnapshot) -> None:
    """From many places inside, the background is seen through the panes and nowhere else."""
    generator = np.random.default_rng(3)
    for _ in range(12):
        eye = generator.uniform([-1.8, -1.4, 0.3], [1.8, 1.4, 2.3])
        target = eye + generator.normal(size=3)
        shot = camera(look_at(tuple(eye), tuple(target)), vertical_fov_deg=90.0)
        nothing = render(room, shot, "instance")["instance"] == 0
        rows, columns = np.nonzero(nothing)
        rays = np.stack(
            [
                (columns - shot.intrinsics.cx) / shot.intrinsics.fx,
                (rows - shot.intrinsics.cy) / shot.intrinsics.fy,
                np.ones(len(rows)),
            ]
        )
        world = shot.world_from_camera[:3, :3] @ rays
        away = (1.8 - eye[1]) / world[1]
        hit = eye[:, None] + away * world
        assert (world[1] > 0).all()
        assert (np.abs(hit[0] - 0.4) < 0.7).all()
        assert (np.abs(hit[2] - 1.55) < 0.65).all()


def test_surfaces_are_seen_in_the_picture(render: Render, room: WorldSnapshot) -> None:
    """Tiles have joints every 15 cm: along a row of pixels they repeat with that period."""
    pose = look_at((0.0, 0.0, 1.275), (0.0, -5.0, 1.275))
    shot = camera(pose, vertical_fov_deg=30.0)
    rgb = render(room, shot, "rgb")["rgb"][..., 1].astype(float)
    profile = rgb.mean(axis=0) - rgb.mean()
    period_px = 0.15 * shot.intrinsics.fx / 1.8
    frequency = np.abs(np.fft.rfft(profile * np.hanning(len(profile)), 16384))
    peak = 16384 / (np.argmax(frequency[200:]) + 200)
    harmonic = period_px / peak
    assert harmonic == pytest.approx(round(harmonic), abs=0.06)
    assert round(harmonic) >= 1


def test_no_sun_shines_through_the_ceiling_of_a_hall(render: Render) -> None:
    """A hall of 16 by 14 m without windows is as dark with the sun as without it."""
    lights = [{"name": "sun", "type": "directional", "direction": [0.3, 0.2, -1], "intensity": 4}]
    shot = camera(look_at((0.0, 0.0, 2.0), (4.0, 3.0, 0.0)))
    hall = {"size": [16, 14, 4], "skirting": False}
    dark, sunny = (
        render(built_snapshot({"room": hall, "lights": shining}), shot, "rgb")["rgb"]
        for shining in ([], lights)
    )
    np.testing.assert_array_equal(sunny, dark)
    roofless = built_snapshot({"room": {**hall, "ceiling": False}, "lights": lights})
    assert render(roofless, shot, "rgb")["rgb"].mean() > dark.mean() + 20
