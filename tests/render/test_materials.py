"""Materials: factors, maps, filtering and many of them, told from the picture's linear radiance."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Environment, Light
from sailenv_ros.types.model import Material, Model, ModelPart
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.render.conftest import Render
from tests.support.picture import linear
from tests.support.tiny_scenes import (
    FORWARD,
    Thing,
    camera_at,
    mesh_of,
    model_of,
    snapshot_of,
    wall_mesh,
)

AHEAD = Pose((3.0, 0.0, 0.0))
WALL = wall_mesh(60.0, 60.0)
RED, GREEN = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
HALF = (0.5, 0.5, 0.5)
UNIFORM = Environment(sky_zenith=HALF, sky_horizon=HALF, sky_ground=HALF)
BLACK = Environment(sky_zenith=(0, 0, 0), sky_horizon=(0, 0, 0), sky_ground=(0, 0, 0))


def plain(*rgba: int, size: int = 64) -> NDArray[np.uint8]:
    """A texture of one value."""
    return np.broadcast_to(np.asarray(rgba, np.uint8), (size, size, 4)).copy()


def seen(
    render: Render,
    environment: Environment = UNIFORM,
    lights: tuple[Light, ...] = (),
    **material: Any,
) -> NDArray[np.float64]:
    """Radiance of a wall ahead, (3,), the picture's mean."""
    scene = snapshot_of(
        [Thing(model_of(WALL, **material), AHEAD)], lights=lights, environment=environment
    )
    return linear(render(scene, camera_at(), "rgb")["rgb"]).mean(axis=(0, 1))


@pytest.mark.parametrize("value", [40, 120, 200, 255])
def test_colour_maps_are_srgb(render: Render, value: int) -> None:
    """A map of one sRGB grey looks as the linear factor that it stands for."""
    c = value / 255
    factor = c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4
    by_map = seen(
        render,
        base_colour=(1, 1, 1, 1),
        roughness=1.0,
        base_colour_texture=plain(value, value, value, 255),
    )
    by_factor = seen(render, base_colour=(factor, factor, factor, 1), roughness=1.0)
    # In the dark one grey level of the picture, 8e-4 of radiance, is more than 2 %.
    np.testing.assert_allclose(by_map, by_factor, rtol=0.02, atol=8e-4)


def test_factors_multiply_maps(render: Render) -> None:
    """Half the red factor on a white map is half the red, the rest untouched."""
    white = plain(255, 255, 255, 255)
    both = seen(render, base_colour=(0.4, 0.8, 0.8, 1), roughness=1.0, base_colour_texture=white)
    alone = seen(render, base_colour=(0.4, 0.8, 0.8, 1), roughness=1.0)
    np.testing.assert_allclose(both, alone, rtol=0.02)


@pytest.mark.parametrize(("green", "blue"), [(60, 0), (200, 0), (120, 255)])
def test_roughness_is_the_map_s_green_and_metalness_its_blue(
    render: Render, green: int, blue: int
) -> None:
    """A map of one value looks as the two factors that it stands for."""
    lamp = Light(name="lamp", type="directional", direction=(1.0, 0.2, -0.3), intensity=1.0)
    common: dict[str, Any] = {
        "environment": UNIFORM,
        "lights": (lamp,),
        "base_colour": (0.8, 0.5, 0.3, 1),
    }
    texture = plain(17, green, blue, 255)
    by_map = seen(render, **common, metallic=1.0, roughness=1.0, metallic_roughness_texture=texture)
    by_factor = seen(render, **common, metallic=blue / 255, roughness=green / 255)
    np.testing.assert_allclose(by_map, by_factor, rtol=0.03)


def test_fine_patterns_fade_to_their_mean(render: Render) -> None:
    """A checker of single texels, far below a pixel, is even grey: mip-maps, not sparkle."""
    texture = plain(255, 255, 255, 255, size=512)
    texture[(np.indices((512, 512)).sum(axis=0) % 2) == 0, :3] = 0
    small = wall_mesh(1.0, 1.0)
    uvs = np.asarray(small.uvs) * 40
    mesh = type(small)(
        positions=small.positions * 60, normals=small.normals, uvs=uvs, triangles=small.triangles
    )
    model = model_of(mesh, base_colour_texture=texture, base_colour=(1, 1, 1, 1), roughness=1.0)
    scene = snapshot_of([Thing(model, Pose((30.0, 0, 0)))], lights=(), environment=UNIFORM)
    rgb = render(scene, camera_at(), "rgb")["rgb"].astype(int)
    assert np.ptp(rgb) <= 3


@pytest.mark.parametrize("shape", [(64, 64), (7, 300), (300, 7), (1500, 1000), (1, 1)])
def test_a_texture_of_any_size_covers_its_wall(render: Render, shape: tuple[int, int]) -> None:
    """Left half red, right half green, whatever the texture's size and shape."""
    texture = np.zeros((*shape, 4), np.uint8)
    texture[..., 3] = 255
    middle = shape[1] // 2
    texture[:, :middle, 0], texture[:, middle:, 1] = 255, 255
    wall = model_of(wall_mesh(2.0, 2.0), base_colour_texture=texture, roughness=1.0)
    scene = snapshot_of([Thing(wall, Pose((2.0, 0, 0)))], lights=(), environment=UNIFORM)
    rgb = render(scene, camera_at(), "rgb")["rgb"]
    if shape[1] > 1:
        assert rgb[36, 28].argmax() == 0
    assert rgb[36, 68].argmax() == 1


def test_a_hundred_materials_keep_apart(render: Render) -> None:
    """Ten by ten walls, each with a map of its own: each shows its own."""
    values = np.linspace(30, 250, 100).astype(int)
    things = []
    for i, value in enumerate(values.tolist()):
        texture = plain(value, value, value, 255, size=(16, 200, 600)[i % 3])
        wall = model_of(
            wall_mesh(0.2, 0.2),
            base_colour=(1, 1, 1, 1),
            roughness=1.0,
            base_colour_texture=texture,
        )
        things.append(Thing(wall, Pose((2.5, 0.9 - 0.2 * (i % 10), 0.9 - 0.2 * (i // 10)))))
    scene, camera = (
        snapshot_of(things, lights=(), environment=UNIFORM),
        camera_at(width=320, height=240),
    )
    rgb = render(scene, camera, "rgb")["rgb"]
    centres = [camera.camera_from_world @ [*thing.pose.position_m, 1.0] for thing in things]
    u, v = np.round(camera.intrinsics.project(np.asarray(centres)[:, :3])).astype(int).T
    assert (np.diff(rgb[v, u].astype(int), axis=0) >= 0).all()
    assert len(np.unique(rgb[v, u, 0])) > 90


@pytest.mark.parametrize(("alpha", "drawn"), [(100, False), (130, True)])
def test_the_alpha_cutoff_decides(render: Render, alpha: int, drawn: bool) -> None:
    """A masked texel counts from its cut-off of one half on; factor and map multiply."""
    leaf = model_of(
        WALL, alpha="mask", base_colour_texture=plain(9, 9, 9, alpha), base_colour=(1, 1, 1, 1)
    )
    ids = render(snapshot_of([Thing(leaf, AHEAD)]), camera_at(), "instance")["instance"]
    assert ids.all() == drawn
    assert ids.any() == drawn
    thin = model_of(
        WALL, alpha="mask", base_colour_texture=plain(9, 9, 9, alpha), base_colour=(1, 1, 1, 0.5)
    )
    assert not render(snapshot_of([Thing(thin, AHEAD)]), camera_at(), "instance")["instance"].any()


def test_a_texture_that_changes_hands_is_not_mixed_up(render: Render) -> None:
    """New materials after old ones, and back: each scene shows its own."""
    red, green = (
        {"base_colour_texture": plain(*c, 255), "roughness": 1.0}
        for c in ((255, 0, 0), (0, 255, 0))
    )
    for _ in range(2):
        assert seen(render, **red).argmax() == 0
        assert seen(render, **green).argmax() == 1


def test_a_spot_lights_its_cone_and_a_lamp_its_range(render: Render) -> None:
    """Inside the inner cone full, outside the outer none; beyond the range nothing."""
    grey = Thing(model_of(WALL, base_colour=(0.5, 0.5, 0.5, 1), roughness=1.0), AHEAD)
    camera = camera_at(width=121, height=91)
    spot = Light(
        name="spot",
        type="spot",
        intensity=20.0,
        position_m=(0, 0, 0),
        direction=(1, 0, 0),
        inner_cone_deg=8.0,
        outer_cone_deg=14.0,
    )
    rgb = render(snapshot_of([grey], lights=(spot,), environment=BLACK), camera, "rgb")["rgb"]
    rays = camera.intrinsics.rays()
    angle = np.degrees(np.arctan(np.hypot(rays[..., 0], rays[..., 1])))
    assert rgb[angle < 7.5].min() > 100
    assert rgb[angle > 15.0].max() == 0
    assert (np.diff(rgb[45, 60:, 0].astype(int)) <= 1).all()
    lamp = Light(name="lamp", type="point", intensity=20.0, position_m=(0, 0, 0), range_m=2.9)
    dark = render(snapshot_of([grey], lights=(lamp,), environment=BLACK), camera, "rgb")["rgb"]
    assert not dark.any()


def test_an_area_light_shines_forward(render: Render) -> None:
    """A panel's light falls where it faces, and as its area and cosine say on its axis."""
    grey = Thing(model_of(WALL, base_colour=(0.5, 0.5, 0.5, 1), roughness=1.0), AHEAD)
    panel = {
        "name": "panel",
        "type": "area",
        "intensity": 30.0,
        "width_m": 0.5,
        "height_m": 0.4,
        "range_m": 500.0,
    }
    camera = camera_at(width=97, height=73)
    for direction, expected in (((1, 0, 0), 0.5 / np.pi * 30.0 * 0.2 / 9.0), ((-1, 0, 0), 0.0)):
        light = Light(**panel, position_m=(0, 0, 0), direction=direction)
        rgb = render(snapshot_of([grey], lights=(light,), environment=BLACK), camera, "rgb")["rgb"]
        np.testing.assert_allclose(linear(rgb[36, 48]).mean(), expected, rtol=0.08, atol=1e-3)


def test_lights_beyond_what_is_drawn_are_told(
    render: Render, caplog: pytest.LogCaptureFixture
) -> None:
    """Of twenty lamps the sixteen strongest shine; one warning says so, not one a frame."""
    lamps = tuple(Light(name=f"{i}", type="point", intensity=float(i)) for i in range(1, 21))
    scene = snapshot_of([Thing(model_of(WALL), AHEAD)], lights=lamps)
    for _ in range(3):
        render(scene, camera_at(), "rgb")
    said = [r.getMessage() for r in caplog.records if "lights" in r.getMessage()]
    assert said == ["only the 16 strongest of 20 lights are drawn"]


def sheets(yaw_deg: float, *, reverse: bool) -> WorldSnapshot:
    """A red sheet that faces -x and a green one at the same place that faces +x, of two sides."""
    corners = [(0.0, y, z) for y in np.linspace(-2, 2, 6) for z in np.linspace(-1.7, 1.7, 5)]
    uvs = [(0.0, 0.0)] * len(corners)
    squares = [(k, k + 1, k + 6, k + 5) for row in range(5) for k in range(5 * row, 5 * row + 4)]
    faces = [face for a, b, c, d in squares for face in ((a, b, c), (a, c, d))]
    parts = []
    for x, turned, colour in ((-1, faces, RED), (1, [f[::-1] for f in faces], GREEN)):
        mesh = mesh_of(corners, [(x, 0, 0)] * len(corners), uvs, turned)
        look = Material(base_colour=(*colour, 1.0), double_sided=True)
        parts.append(ModelPart(mesh=mesh, material=look))
    both = Model(name="both", parts=tuple(parts[::-1] if reverse else parts))
    pose = Pose.from_rpy_deg((2.0, 0.0, 0.0), (0.0, 0.0, yaw_deg))
    return snapshot_of([Thing(both, pose)], lights=(), environment=UNIFORM)


def assert_faces_the_eye(render: Render, camera: Camera) -> None:
    for reverse in (False, True):
        for yaw, wanted in ((0.0, RED), (25.0, RED), (180.0, GREEN), (205.0, GREEN)):
            views = render(sheets(yaw, reverse=reverse), camera, "albedo", "instance")
            found = views["albedo"][views["instance"] > 0]
            assert len(found) > 300
            assert (np.abs(found - wanted) < 0.01).all()


def test_of_two_sheets_back_to_back_the_one_that_faces_the_eye_is_seen(render: Render) -> None:
    """Models of furniture have walls without thickness, whose inner side is dark."""
    assert_faces_the_eye(render, camera_at())


@pytest.mark.parametrize(
    "lens",
    [
        {"distortion_model": "orthographic", "fx_px": 20.0, "fy_px": 20.0},
        {
            "distortion_model": "equidistant",
            "distortion": (0.0, 0.0, 0.0, 0.0),
            "fx_px": 30.0,
            "fy_px": 30.0,
            "max_angle_deg": 95.0,
        },
    ],
    ids=["parallel", "fisheye"],
)
def test_so_it_is_through_other_lenses(native: NativeRenderer, lens: dict[str, Any]) -> None:
    """Rays that are parallel, and those of a fisheye."""

    def render(snapshot: WorldSnapshot, camera: Camera, *views: str) -> dict[str, NDArray[Any]]:
        return dict(native.render(RenderRequest(snapshot, camera, views)).views)

    camera = Camera(intrinsics=CameraIntrinsics(width=96, height=72, **lens), pose=FORWARD)
    assert_faces_the_eye(render, camera)
