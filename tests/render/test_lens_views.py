"""Views through lenses that bend straight lines, against rays and arithmetic of the tests' own.

Rays come from the lens alone; what they meet, and where points go, is told by `ray_cast` and
`embree_cast`, which share no code with the rasteriser.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest

from sailenv_ros.frame.lens_rays import (
    depth_shares,
    fine_sample_places,
    rays_of_fine_samples,
    unit_rays,
)
from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.cpu.amodal_renderer import AmodalRenderer
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.render.scene.opening_window import OpeningWindows
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose, look_at
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.snapshot import Observation, WorldSnapshot
from tests.support.embree_cast import RayCast
from tests.support.picture_edges import grown, near_edges
from tests.support.ray_cast import cast, flow_by_arithmetic
from tests.support.room_of_things import CAMERA_PATHS, room_of_things, room_that_moves, seen
from tests.support.tiny_scenes import (
    FORWARD,
    FRAME_NS,
    Thing,
    model_of,
    snapshot_of,
    wall_mesh,
)

WIDTH, HEIGHT = 203, 151

LENSES: dict[str, dict[str, Any]] = {
    "plumb_bob": {
        "distortion_model": "plumb_bob",
        "distortion": (-0.28, 0.07, 1e-3, -2e-3, 0.0),
        "fx_px": 120.0,
        "fy_px": 118.0,
        "cx_offset_px": 3.3,
        "cy_offset_px": -2.1,
    },
    "rational": {
        "distortion_model": "rational_polynomial",
        "distortion": (0.3, -0.1, 1e-3, -2e-3, 0.02, 0.5, -0.02, 0.01),
        "fx_px": 130.0,
        "fy_px": 130.0,
    },
    "thin prism": {
        "distortion_model": "rational_polynomial",
        "distortion": (
            *(0.3, -0.1, 1e-3, -2e-3, 0.02, 0.5, -0.02, 0.01),
            *(4e-3, -1e-3, -3e-3, 8e-4),
        ),
        "fx_px": 130.0,
        "fy_px": 128.0,
    },
    "fisheye 190": {
        "distortion_model": "equidistant",
        "distortion": (0.0, 0.0, 0.0, 0.0),
        "fx_px": 0.5 * HEIGHT / np.radians(95.0),
        "fy_px": 0.5 * HEIGHT / np.radians(95.0),
        "max_angle_deg": 95.0,
    },
    "fisheye 220": {
        "distortion_model": "equidistant",
        "distortion": (0.02, -0.01, 0.001, 0.0),
        "fx_px": 40.0,
        "fy_px": 41.0,
        "max_angle_deg": 110.0,
        "cx_offset_px": -4.2,
    },
    "double sphere": {
        "distortion_model": "double_sphere",
        "distortion": (-0.2, 0.6),
        "fx_px": 55.0,
        "fy_px": 55.0,
        "max_angle_deg": 100.0,
    },
    "mei": {
        "distortion_model": "mei",
        "distortion": (1.1, -0.1, 0.02, 1e-3, -1e-3),
        "fx_px": 90.0,
        "fy_px": 90.0,
        "max_angle_deg": 95.0,
    },
    "equirectangular": {
        "distortion_model": "equirectangular",
        "distortion": (),
        "fx_px": WIDTH / (2.0 * np.pi),
        "fy_px": HEIGHT / np.pi,
    },
}


def camera_through(name: str, pose: Pose = FORWARD, **more: Any) -> Camera:
    """A camera with one of the lenses."""
    numbers = {"width": WIDTH, "height": HEIGHT, **LENSES[name], **more}
    return Camera(intrinsics=CameraIntrinsics(**numbers), pose=pose)


@pytest.mark.parametrize("name", LENSES)
def test_rays_between_pixels_are_those_of_the_lens(name: str) -> None:
    """To 1e-4 px beside what the law says there; those of pixels' centres are the same bytes."""
    lens = camera_through(name).intrinsics
    rays = rays_of_fine_samples(lens)
    exact = lens.unit_rays_through(fine_sample_places(lens))
    np.testing.assert_array_equal(rays[1::2, 1::2], unit_rays(lens))
    there = np.isfinite(exact[..., 2])
    np.testing.assert_array_equal(np.isfinite(rays[..., 2]), there)
    off = np.linalg.norm(rays - exact, axis=-1)[there]
    assert off.max() * max(lens.fx, lens.fy) < 1e-4


@pytest.mark.parametrize("name", LENSES)
def test_ids_range_depth_and_normals_are_what_rays_meet(native: NativeRenderer, name: str) -> None:
    """At every pixel away from edges: ids, and to 1e-5 range, depth and normal of the plane."""
    scene = snapshot_of(room_of_things())
    camera = camera_through(name, Pose.from_rpy_deg((0.1, 0.2, 0.1), (3.0, 8.0, 20.0)))
    views = seen(native, scene, camera, "instance", "range", "depth", "normals", "lens_valid")
    hits = cast(scene, camera)
    rays = unit_rays(camera.intrinsics)
    valid = np.isfinite(rays[..., 2])
    np.testing.assert_array_equal(views["lens_valid"], valid)
    assert not views["instance"][~valid].any()
    assert np.isnan(views["depth"][~valid]).all()
    assert np.isnan(views["range"][~valid]).all()
    ids = np.where(hits.row >= 0, hits.row + 1, 0)
    away = hits.away_from_edges() & valid
    assert away.sum() > 0.5 * valid.sum()
    assert (views["instance"][away] == ids[away]).all()
    wrong = valid & (views["instance"] != ids)
    assert wrong.sum() <= 1e-4 * valid.sum()
    np.testing.assert_allclose(views["range"][away], hits.depth[away], rtol=1e-5)
    depth = hits.depth * rays[..., 2]
    np.testing.assert_allclose(views["depth"][away], depth[away], rtol=1e-5)
    np.testing.assert_allclose(views["normals"][away], hits.normal[away], atol=1e-5)


@pytest.mark.parametrize("name", ["plumb_bob", "fisheye 190", "equirectangular"])
def test_a_furnished_room_is_what_rays_meet(
    native: NativeRenderer, room_01: WorldSnapshot, name: str
) -> None:
    """All ids and distances of room_01, away from edges, through the middle of each pixel."""
    rays = RayCast(room_01)
    for turn in (0.4, 2.5):
        pose = look_at((1.1 * np.cos(turn), np.sin(turn), 1.5), (-np.cos(turn), -np.sin(turn), 0.9))
        camera = camera_through(name, pose)
        views = seen(native, room_01, camera, "instance", "range")
        ids, distance, masked = rays.look(camera)
        valid = np.isfinite(unit_rays(camera.intrinsics)[..., 2])
        inside = valid & ~near_edges(ids, distance, 0.002) & ~grown(masked)
        assert inside.sum() > 0.4 * valid.sum()
        assert (views["instance"][inside] == ids[inside]).all()
        np.testing.assert_allclose(views["range"][inside], distance[inside], rtol=1e-4)


def test_a_lens_with_a_pin_holes_rays_makes_its_views(
    native: NativeRenderer, room_01: WorldSnapshot
) -> None:
    """Without distortion: equal ids, depth to 1e-6, and the picture to 1 of 255.

    Both round to single precision, which grazing surfaces show: few depths differ by more. At the
    border of a shadow a pixel may have the light of its neighbour; where the room's borders lie
    depends on how its things have come to rest.
    """
    pose = look_at((1.1, 0.4, 1.5), (-1.2, -0.3, 0.8))
    straight = Camera(intrinsics=CameraIntrinsics(width=WIDTH, height=HEIGHT), pose=pose)
    focal = straight.intrinsics.fx
    bent = replace(
        straight,
        intrinsics=CameraIntrinsics(
            width=WIDTH,
            height=HEIGHT,
            distortion_model="plumb_bob",
            distortion=(0.0, 0.0, 0.0, 0.0, 0.0),
            fx_px=focal,
            fy_px=focal,
        ),
    )
    assert not bent.intrinsics.is_pinhole
    for smooth in (False, True):
        names = ("instance", "depth", "range", "normals", "albedo", "rgb")
        picture = replace(straight.picture, smooth_edges=smooth)
        plain = seen(native, room_01, replace(straight, picture=picture), *names)
        other = seen(native, room_01, replace(bent, picture=picture), *names)
        differs = plain["instance"] != other["instance"]
        assert differs.sum() <= 3
        same = ~grown(differs)
        for view in ("depth", "range"):
            off = np.abs(other[view][same] / plain[view][same].astype(np.float64) - 1.0)
            assert (off > 1e-6).mean() < 1e-3
            assert off.max() < 5e-6
        off = np.abs(other["normals"] - plain["normals"])[same].max(axis=-1)
        assert (off > 2e-5).mean() < 5e-3
        assert np.quantile(off, 0.9999) < 2e-3
        around = np.ones((3, 3), np.uint8)
        low, high = cv2.erode(plain["rgb"], around), cv2.dilate(plain["rgb"], around)
        found = other["rgb"].astype(int)
        beyond = np.maximum(low.astype(int) - found, found - high)[same]
        assert (beyond > 1).mean() < 3e-4, np.bincount(beyond.clip(0).reshape(-1))
        steps = np.abs(found - plain["rgb"])[same]
        assert (steps > 1).mean() < 2e-3, np.bincount(steps.reshape(-1))


def test_faces_of_the_cube_leave_no_seam(native: NativeRenderer) -> None:
    """Within an evenly lit sphere of one colour every pixel that the lens sees is the same."""
    wall = model_of(wall_mesh(12.0, 12.0), base_colour=(0.5, 0.4, 0.3, 1.0), double_sided=True)
    things = [replace(thing, model=wall) for thing in room_of_things()[:6]]
    camera = camera_through("fisheye 220", Pose.from_rpy_deg((0.0, 0.0, 0.0), (5.0, 12.0, 25.0)))
    views = seen(native, snapshot_of(things), camera, "instance", "albedo")
    valid = np.isfinite(unit_rays(camera.intrinsics)[..., 2])
    assert (views["instance"][valid] > 0).all()
    albedo = views["albedo"][valid]
    np.testing.assert_array_equal(albedo, np.broadcast_to(albedo[0], albedo.shape))


@pytest.mark.parametrize("smooth", [False, True])
def test_what_the_lens_does_not_see_is_black(native: NativeRenderer, smooth: bool) -> None:
    """Beyond the image circle the picture is black; within it nothing is."""
    camera = camera_through("fisheye 190")
    camera = replace(camera, picture=PictureSettings(smooth_edges=smooth))
    scene = snapshot_of(room_of_things())
    valid = np.isfinite(unit_rays(camera.intrinsics)[..., 2])
    rgb = seen(native, scene, camera, "rgb")["rgb"]
    assert not rgb[~valid].any()
    assert (rgb[valid].max(axis=-1) > 0).mean() > 0.999


@pytest.mark.parametrize("name", LENSES)
@pytest.mark.parametrize("motion", ["turn", "shift", "things", "still"])
def test_flow_is_what_arithmetic_says(native: NativeRenderer, name: str, motion: str) -> None:
    """To 0.01 px away from edges; exactly 0 where nothing has moved."""
    before, after = room_that_moves(motion == "things")
    then = camera_through(name, CAMERA_PATHS["still"])
    now = replace(then, pose=CAMERA_PATHS.get(motion, then.pose))
    past = Observation(snapshot=before, camera=then)
    views = dict(
        native.render(RenderRequest(after, now, ("flow", "flow_valid", "occlusion"), past)).views
    )
    hits = cast(after, now)
    expected = flow_by_arithmetic(hits, after, now, before, then)
    away = hits.away_from_edges() & np.isfinite(unit_rays(now.intrinsics)[..., 2])
    exists = away & np.isfinite(expected[..., 0])
    assert exists.sum() > 5000
    np.testing.assert_array_equal(views["flow_valid"][away], exists[away])
    off_px = (views["flow"][exists] - expected[exists]) * FRAME_NS * 1e-9
    assert np.abs(off_px).max() < 0.01
    if motion == "still":
        assert not views["flow"][exists].any()
        assert not views["occlusion"][exists].any()


def test_depth_of_planes_to_the_border(native: NativeRenderer) -> None:
    """A wall ahead has one depth, to 1e-5, as far as the lens sees it."""
    wall = model_of(wall_mesh(4000.0, 4000.0))
    scene = snapshot_of([Thing(wall, Pose((2.0, 0.0, 0.0)))])
    for name in LENSES:
        camera = camera_through(name, far_m=5000.0)
        views = seen(native, scene, camera, "depth", "range")
        there = np.isfinite(views["range"])
        np.testing.assert_allclose(views["depth"][there], 2.0, rtol=1e-5)
        shares = depth_shares(camera.intrinsics)
        reachable = 2.0 / np.where(shares > 0.0, shares, np.nan) < 1900.0
        assert there[reachable].all()


@pytest.mark.parametrize("name", ["plumb_bob", "fisheye 220", "equirectangular"])
def test_objects_alone_cover_the_pixels_that_they_have(native: NativeRenderer, name: str) -> None:
    """What nothing hides: each thing drawn alone has the pixels and depths of the picture."""
    things = room_of_things()
    camera = camera_through(name, Pose.from_rpy_deg((0.1, 0.2, 0.1), (3.0, 8.0, 20.0)))
    renderer = AmodalRenderer()
    masks = renderer.draw(snapshot_of(things), camera)
    drawn = [int(number) for number in masks.ids[masks.pixels > 20] if number > 6]
    assert len(drawn) >= 2
    for number in drawn:
        alone = seen(native, snapshot_of([things[number - 1]]), camera, "instance", "depth")
        covered = alone["instance"] > 0
        np.testing.assert_array_equal(masks.mask(number), covered)
        np.testing.assert_array_equal(masks.depth(number)[covered], alone["depth"][covered])
    renderer.close()


@pytest.mark.parametrize("name", ["plumb_bob", "fisheye 190", "equirectangular"])
def test_more_samples_make_the_same_picture(
    native: NativeRenderer, room_01: WorldSnapshot, name: str
) -> None:
    """Labels keep their bytes; smooth edges come nearer to 4 x 4 samples than one sample does."""
    camera = camera_through(name, look_at((1.1, 0.4, 1.5), (-1.2, -0.3, 0.8)))
    plain = PictureSettings(smooth_edges=False)
    made = [
        seen(native, room_01, replace(camera, picture=picture), "rgb", "instance")
        for picture in (plain, PictureSettings(), replace(plain, supersampling=4))
    ]
    valid = np.isfinite(unit_rays(camera.intrinsics)[..., 2])
    inner = cv2.erode(valid.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(bool)
    for other in made[1:]:
        np.testing.assert_array_equal(other["instance"], made[0]["instance"])
    best = made[2]["rgb"][inner].astype(float)
    off = [np.abs(views["rgb"][inner] - best).mean() for views in made[:2]]
    assert off[1] < 0.75 * off[0] < 4.0


@pytest.mark.parametrize("name", ["plumb_bob", "fisheye 190"])
def test_a_mirror_shows_what_a_pin_holes_does(native: NativeRenderer, name: str) -> None:
    """A wall of one colour, seen in a mirror, has the colour of a pin-hole's picture."""
    red = model_of(wall_mesh(60.0, 60.0), base_colour=(0.8, 0.1, 0.1, 1.0))
    glass = model_of(wall_mesh(2.0, 2.0), metallic=1.0, roughness=0.0)
    scene = snapshot_of(
        [
            Thing(glass, Pose((2.0, 0.0, 0.0))),
            Thing(red, Pose.from_rpy_deg((-3.0, 0, 0), (0, 0, 180))),
        ]
    )
    straight = Camera(intrinsics=CameraIntrinsics(width=WIDTH, height=HEIGHT))
    bent = camera_through(name)
    middle = np.s_[70:80, 95:105]
    pictures = [seen(native, scene, camera, "rgb")["rgb"][middle] for camera in (straight, bent)]
    assert pictures[0][..., 0].min() > 2 * pictures[0][..., 1].max()
    assert np.abs(pictures[1].astype(int).mean((0, 1)) - pictures[0].mean((0, 1))).max() < 2.0


@pytest.mark.parametrize("name", ["plumb_bob", "fisheye 220", "equirectangular"])
def test_places_on_objects_are_where_rays_meet_them(native: NativeRenderer, name: str) -> None:
    """The view `object_coords`: to 0.2 mm, also behind the camera."""
    things = room_of_things()
    scene = snapshot_of(things)
    camera = camera_through(name, Pose.from_rpy_deg((0.1, 0.2, 0.1), (3.0, 8.0, 20.0)))
    views = seen(native, scene, camera, "range", "instance", "object_coords")
    hits = cast(scene, camera)
    away = hits.away_from_edges() & np.isfinite(hits.depth)
    rays = unit_rays(camera.intrinsics)
    eye = rays[away] * hits.depth[away][:, None]
    world = eye @ camera.world_from_camera[:3, :3].T + camera.world_from_camera[:3, 3]
    own = np.empty_like(world)
    for row, pose in enumerate(scene.world_from_body):
        chosen = hits.row[away] == row
        own[chosen] = (world[chosen] - pose[:3, 3]) @ pose[:3, :3]
    np.testing.assert_allclose(views["object_coords"][away], own, atol=2e-4)


def test_the_window_around_openings_changes_no_pixel(
    native: NativeRenderer, room_01: WorldSnapshot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What lies outside is drawn within the openings' rectangle: the views stay the same."""
    windows = OpeningWindows()
    narrowed = 0
    for number in range(24):
        turn = 0.7 * number
        eye = (0.9 * np.cos(1.3 * number), 0.8 * np.sin(1.3 * number), 0.9 + 0.05 * number)
        target = (eye[0] + np.cos(turn), eye[1] + np.sin(turn), eye[2] + 0.3 * np.sin(2.1 * number))
        camera = camera_through("plumb_bob", look_at(eye, target))
        found = windows.of(room_01, camera)
        if found is None:
            continue
        left, top, right, bottom = found[1]
        narrowed += (right - left + 1) * (bottom - top + 1) < 0.9 * WIDTH * HEIGHT
        made = seen(native, room_01, camera, "rgb", "instance", "range")
        with monkeypatch.context() as patched:
            patched.setattr(OpeningWindows, "of", lambda *_: None)
            whole = seen(native, room_01, camera, "rgb", "instance", "range")
        for view, values in whole.items():
            np.testing.assert_array_equal(made[view], values, err_msg=f"{view} of view {number}")
    assert narrowed > 5
