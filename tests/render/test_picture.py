"""The picture: plausible light, right textures, untouched ground truth; goldens for shading."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.render.contract import RenderBackend, RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.render.gl.renderer import Renderer
from sailenv_ros.types.geometry import Pose, look_at
from sailenv_ros.types.lights import Environment, Light
from tests.render.conftest import Render
from tests.support.picture import linear
from tests.support.tiny_scenes import (
    SUN,
    Thing,
    box_mesh,
    camera_at,
    checker,
    contents_of,
    model_of,
    moved,
    snapshot_of,
    wall_mesh,
)

GOLDENS = Path(__file__).parent / "goldens"
WALL = wall_mesh(60.0, 60.0)
GREY = (0.5, 0.5, 0.5)
DIM = Environment(
    sky_zenith=(0.1, 0.2, 0.4), sky_horizon=(0.3, 0.35, 0.4), sky_ground=(0.1, 0.1, 0.1)
)
UNIFORM = Environment(ambient=(0.0, 0.0, 0.0), sky_zenith=GREY, sky_horizon=GREY, sky_ground=GREY)
DARK = Environment(
    ambient=(0, 0, 0), sky_zenith=(0, 0, 0), sky_horizon=(0, 0, 0), sky_ground=(0, 0, 0)
)
MATT = model_of(WALL, base_colour=(0.5, 0.5, 0.5, 1), roughness=1.0)


@pytest.mark.parametrize("roughness", [0.1, 0.5, 1.0])
@pytest.mark.parametrize("metallic", [0.0, 1.0])
def test_white_furnace(render: Render, roughness: float, metallic: float) -> None:
    """A white surface in uniform light is as bright as it, whatever its finish."""
    white = model_of(WALL, base_colour=(1, 1, 1, 1), roughness=roughness, metallic=metallic)
    turned = Pose.from_rpy_deg((3.0, 0, 0), (0, 0, 35))
    scene = snapshot_of([Thing(white, turned)], lights=(), environment=UNIFORM)
    radiance = linear(render(scene, camera_at(), "rgb")["rgb"]).mean(axis=-1)
    assert radiance.max() <= 0.5 * 1.02
    assert radiance.min() >= 0.5 * 0.97


@pytest.mark.parametrize("roughness", [0.2, 0.4, 0.6, 0.9])
@pytest.mark.parametrize("angle_deg", [5, 50, 75])
def test_black_in_uniform_light_mirrors_what_its_lobe_does(
    render: Render, roughness: float, angle_deg: float
) -> None:
    """Against 200,000 rays of GGX's lobe, and what comes back of further bounces."""
    black = model_of(WALL, base_colour=(0, 0, 0, 1), roughness=roughness)
    turned = Pose.from_rpy_deg((3.0, 0, 0), (0, 0, angle_deg))
    bright = replace(UNIFORM, exposure=2.0)
    scene = snapshot_of([Thing(black, turned)], lights=(), environment=bright)
    rgb = render(scene, camera_at(width=97, height=73), "rgb")["rgb"]
    scale, bias = _lobe_shares(roughness, np.cos(np.radians(angle_deg)))
    once, lost, mean = 0.04 * scale + bias, 1.0 - scale - bias, 0.04 + 0.96 / 21.0
    expected = 2.0 * once * (1.0 + lost * mean / (1.0 - mean * lost))
    assert linear(rgb[36, 48]).mean() == pytest.approx(expected, rel=0.08)


def _lobe_shares(roughness: float, cosine: float) -> tuple[float, float]:
    """Shares of even light that are mirrored: times the reflectance head-on, and besides.

    Heitz 2014, "Understanding the masking-shadowing function": height-correlated Smith.
    """
    random = np.random.default_rng(5)
    a2 = roughness**4
    u, turn = random.random(200_000), 2.0 * np.pi * random.random(200_000)
    up = np.sqrt((1.0 - u) / (1.0 + (a2 - 1.0) * u))
    along = np.sqrt(1.0 - up**2) * np.cos(turn) * np.sqrt(1.0 - cosine**2) + up * cosine
    sent = 2.0 * along * up - cosine
    lit = (sent > 0.0) & (along > 0.0)
    out = np.where(lit, sent, 1.0)
    smith = out * np.sqrt(cosine**2 * (1.0 - a2) + a2) + cosine * np.sqrt(out**2 * (1.0 - a2) + a2)
    share = np.where(lit, 2.0 * out * along / (smith * up), 0.0)
    grazing = (1.0 - np.clip(along, 0.0, 1.0)) ** 5
    return float((share * (1.0 - grazing)).mean()), float((share * grazing).mean())


def test_a_lambertian_wall_under_a_lamp(render: Render) -> None:
    """Head-on at 2 m from a lamp of 8 W/sr: radiance albedo/pi · 8/4, less what is reflected."""
    lamp = Light(name="lamp", type="point", intensity=8.0, position_m=(1.0, 0, 0), range_m=1000.0)
    scene = snapshot_of([Thing(MATT, Pose((3.0, 0, 0)))], lights=(lamp,), environment=DARK)
    rgb = render(scene, camera_at(width=97, height=73), "rgb")["rgb"]
    assert linear(rgb[36, 48]).mean() == pytest.approx(0.5 / np.pi * 2.0, rel=0.06)


def test_light_is_linear_in_intensity(render: Render) -> None:
    """Half the lamp gives half the radiance, to the picture's 8 bits."""
    seen = []
    for intensity in (1.0, 0.5):
        sun = Light(name="sun", type="directional", direction=(1, 0, 0), intensity=intensity)
        scene = snapshot_of([Thing(MATT, Pose((3.0, 0, 0)))], lights=(sun,), environment=DARK)
        seen.append(linear(render(scene, camera_at(), "rgb")["rgb"]).mean())
    assert seen[1] / seen[0] == pytest.approx(0.5, rel=0.02)


def test_a_body_casts_a_shadow_where_the_sun_is_hidden(render: Render) -> None:
    """A floor under a box is darker where the ray to the sun meets the box, and there alone."""
    floor = Thing(model_of(wall_mesh(8, 8)), Pose.from_rpy_deg((4.0, 0, -1.0), (0, 90, 0)))
    box = Thing(model_of(box_mesh(0.8)), Pose((4.0, 0.0, 0.4)))
    sun = Light(name="sun", type="directional", direction=(0.0, 0.5, -1.0), intensity=1.5)
    camera = camera_at(look_at((0.5, 0, 2.5), (4.0, 0, -1.0)), width=200, height=150)
    dim = Environment(sky_zenith=(0.1,) * 3, sky_horizon=(0.1,) * 3, sky_ground=(0.1,) * 3)
    scene = snapshot_of([floor, box], lights=(sun,), environment=dim)
    views = render(scene, camera, "rgb", "instance", "depth")
    points = camera.intrinsics.unproject(views["depth"])
    world = points @ camera.world_from_camera[:3, :3].T + camera.world_from_camera[:3, 3]
    on_floor = views["instance"] == 1
    # Up the ray to the sun to the height of the box's middle.
    at_box = world + (0.4 - world[..., 2:]) / 1.0 * np.array([0.0, -0.5, 1.0])
    aside = np.maximum(np.abs(at_box[..., 0] - 4.0), np.abs(at_box[..., 1]))
    deep, clear = (
        on_floor & (aside < 0.3),
        on_floor & (aside > 0.8) & (np.abs(world[..., 0] - 4) < 2),
    )
    brightness = views["rgb"].astype(float).mean(axis=-1)
    assert deep.sum() > 100
    assert brightness[deep].max() < 0.8 * brightness[clear].min()


def test_shadows_follow_what_creeps(
    make_renderer: Callable[[], RenderBackend], renderer: RenderBackend
) -> None:
    """Steps too small to be seen add up: the picture is always that of a new renderer."""
    floor = Thing(model_of(wall_mesh(8, 8)), Pose.from_rpy_deg((4.0, 0, -1.0), (0, 90, 0)))
    box = Thing(model_of(box_mesh(0.8)), Pose((4.0, 0.0, 0.4)))
    sun = Light(name="sun", type="directional", direction=(0.0, 0.5, -1.0), intensity=1.5)
    contents = contents_of([floor, box], lights=(sun,))
    camera = camera_at(look_at((0.5, 0, 2.5), (4.0, 0, -1.0)), width=200, height=150)

    def picture(by: RenderBackend, away_m: float) -> NDArray[np.int16]:
        there = moved([floor, box], floor.pose, Pose((4.0, away_m, 0.4)))
        velocities = np.zeros((2, 2, 3))
        velocities[1, 0, 1] = 0.02
        snapshot = replace(snapshot_of(there, contents=contents), velocities=velocities)
        return by.render(RenderRequest(snapshot, camera, ["rgb"])).views["rgb"].astype(np.int16)

    first = picture(renderer, 0.0)
    for step in range(1, 430):
        last = picture(renderer, 0.7e-3 * step)
        if step % 60 == 59:
            fresh = make_renderer()
            try:
                wanted = picture(fresh, 0.7e-3 * step)
            finally:
                fresh.close()
            assert np.array_equal(last, wanted)
    assert (np.abs(first - last).max(axis=-1) > 20).mean() > 0.02


def test_shadows_of_what_comes_to_rest_stay(
    make_renderer: Callable[[], RenderBackend], renderer: RenderBackend
) -> None:
    """One thing after the other stops, one goes on: pictures are those of new renderers."""
    floor = Thing(model_of(wall_mesh(8, 8)), Pose.from_rpy_deg((4.0, 0, -1.0), (0, 90, 0)))
    boxes = [Thing(model_of(box_mesh(0.5)), Pose((4.0, y, 0.4))) for y in (-1.2, 0.0, 1.2)]
    sun = Light(name="sun", type="directional", direction=(0.3, 0.5, -1.0), intensity=1.5)
    contents = contents_of([floor, *boxes], lights=(sun,))
    camera = camera_at(look_at((0.5, 0, 2.5), (4.0, 0, -1.0)), width=120, height=90)

    def picture(by: RenderBackend, step: int) -> NDArray[np.uint8]:
        ends = 5, 12, 99
        poses = [
            Pose((4.0 + 0.02 * min(step, end), box.pose.position_m[1], 0.4))
            for box, end in zip(boxes, ends, strict=True)
        ]
        there = moved([floor, *boxes], floor.pose, *poses)
        velocities = np.zeros((4, 2, 3))
        for row, end in enumerate(ends, start=1):
            velocities[row, 0, 0] = 0.5 if step < end else 0.0
        snapshot = replace(snapshot_of(there, contents=contents), velocities=velocities)
        return by.render(RenderRequest(snapshot, camera, ["rgb"])).views["rgb"]

    for step in range(45):
        last = picture(renderer, step)
        if step % 11 == 10:
            fresh = make_renderer()
            try:
                wanted = picture(fresh, step)
            finally:
                fresh.close()
            assert np.array_equal(last, wanted)


def test_a_texture_is_neither_mirrored_nor_upside_down(render: Render) -> None:
    """Each quarter of a picture appears in its own corner of the wall that shows it."""
    texture = np.zeros((64, 64, 4), np.uint8)
    texture[..., 3] = 255
    texture[:32, :32], texture[:32, 32:] = (255, 0, 0, 255), (0, 255, 0, 255)
    texture[32:, :32], texture[32:, 32:] = (0, 0, 255, 255), (255, 255, 255, 255)
    wall = model_of(wall_mesh(2.0, 2.0), base_colour_texture=texture, roughness=1.0)
    rgb = render(snapshot_of([Thing(wall, Pose((2.0, 0, 0)))], lights=()), camera_at(), "rgb")[
        "rgb"
    ]
    assert rgb[20, 30].argmax() == 0
    assert rgb[20, 66].argmax() == 1
    assert rgb[52, 30].argmax() == 2
    assert np.ptp(rgb[52, 66].astype(int)) < 40


def test_a_normal_map_turns_the_surface_as_it_says(render: Render) -> None:
    """A map that leans to the right (+u) brightens a wall lit from the right, and up likewise."""

    def brightness(map_xy: tuple[int, int], towards: tuple[float, float, float]) -> float:
        texture = np.full((16, 16, 4), 255, np.uint8)
        texture[..., 0], texture[..., 1], texture[..., 2] = (*map_xy, 220)
        wall = model_of(WALL, normal_texture=texture, roughness=1.0)
        sun = Light(name="sun", type="directional", direction=tuple(-t for t in towards))
        scene = snapshot_of([Thing(wall, Pose((3.0, 0, 0)))], lights=(sun,))
        return float(render(scene, camera_at(), "rgb")["rgb"].mean())

    from_right, from_above = (-1.0, -0.6, 0.0), (-1.0, 0.0, 0.6)
    assert brightness((210, 128), from_right) > brightness((46, 128), from_right) + 5
    assert brightness((128, 210), from_above) > brightness((128, 46), from_above) + 5


def test_what_shines_is_bright_in_the_dark(render: Render) -> None:
    """An emitting wall shows its own radiance without any light."""
    dark = Environment(
        ambient=(0, 0, 0), sky_zenith=(0, 0, 0), sky_horizon=(0, 0, 0), sky_ground=(0, 0, 0)
    )
    wall = model_of(WALL, emission=(1.0, 0.5, 0.25))
    scene = snapshot_of([Thing(wall, Pose((3.0, 0, 0)))], lights=(), environment=dark)
    radiance = linear(render(scene, camera_at(), "rgb")["rgb"]).mean(axis=(0, 1))
    np.testing.assert_allclose(radiance, (1.0, 0.5, 0.25), rtol=0.06)


def test_exposure_doubles_per_stop_and_the_background_is_as_asked(render: Render) -> None:
    """A plain background of 0.1 is 0.2 a stop brighter."""
    for stops, expected in ((0.0, 0.1), (1.0, 0.2)):
        plain = Environment(background="colour", background_colour=(0.1, 0.1, 0.1), exposure=stops)
        rgb = render(snapshot_of([], environment=plain), camera_at(), "rgb")["rgb"]
        np.testing.assert_allclose(linear(rgb).mean(), expected, rtol=0.02)


def test_edges_are_smooth_and_the_inside_is_untouched(render: Render) -> None:
    """Along a slanted bright edge there are pixels in between; labels have none."""
    white = model_of(box_mesh(1.0), base_colour=(1, 1, 1, 1))
    black = Environment(background="colour", background_colour=(0, 0, 0))
    scene = snapshot_of(
        [Thing(white, Pose.from_rpy_deg((2.0, 0, 0), (8, 0, 0)))], environment=black
    )
    views = render(scene, camera_at(width=200, height=150), "rgb", "instance")
    grey = views["rgb"].mean(axis=-1)
    inside = np.median(grey[views["instance"] == 1])
    between = (grey > 0.15 * inside) & (grey < 0.85 * inside)
    assert between.sum() > 100
    assert set(np.unique(views["instance"])) == {0, 1}


def test_a_picture_does_not_touch_ground_truth(render: Render) -> None:
    """Labels, depth and flow are the same bytes with and without rgb."""
    things = [
        Thing(
            model_of(box_mesh(1.0), base_colour_texture=checker()),
            Pose.from_rpy_deg((3, 0, 0), (10, 20, 30)),
        )
    ]
    before, after = snapshot_of(things), snapshot_of(things, time_ns=50_000_000)
    now = camera_at(Pose.from_rpy_deg((0, 0.1, 0), (0, 0, 1)))
    truth = ("depth", "category", "instance", "flow", "normals")
    alone = render(after, now, *truth, past=(before, camera_at()))
    beside = render(after, now, *truth, "rgb", past=(before, camera_at()))
    for name in truth:
        np.testing.assert_array_equal(alone[name], beside[name], err_msg=name)


def test_two_renderers_agree_to_the_byte(
    make_renderer: Callable[[], RenderBackend], render: Render
) -> None:
    """A second context gives identical views, the picture included."""
    other = make_renderer()
    scene, camera = gallery(), camera_at(width=160, height=120)
    views = ("rgb", "depth", "category", "instance", "normals")
    first, second = (
        render(scene, camera, *views),
        other.render(RenderRequest(scene, camera, views)).views,
    )
    for name in views:
        assert first[name].tobytes() == second[name].tobytes(), name
    other.close()
    other.close()


def test_contexts_come_and_go(render: Render) -> None:
    """Twenty renderers, one after the other, and the first still works."""
    scene, camera = gallery(), camera_at()
    expected = render(scene, camera, "rgb")["rgb"]
    for _ in range(20):
        passing = Renderer()
        passing.render(RenderRequest(scene, camera, ["rgb"]))
        passing.close()
    np.testing.assert_array_equal(render(scene, camera, "rgb")["rgb"], expected)


def test_only_what_is_wanted_is_made(renderer: RenderBackend) -> None:
    """Without rgb nothing is lit, and no other view comes back."""
    rendered = renderer.render(RenderRequest(gallery(), camera_at(), ["instance"]))
    assert set(rendered.views) == {"instance"}
    assert not {"shadow", "lighting", "post"} & set(rendered.timings_s)
    lit = renderer.render(RenderRequest(gallery(), camera_at(), ["rgb"]))
    assert {"shadow", "post"} <= set(lit.timings_s)


def gallery():  # type: ignore[no-untyped-def]  # a snapshot
    """Every kind of material and light in one small scene."""
    cube, floor = box_mesh(0.8), wall_mesh(9, 9)
    lights = (
        SUN,
        Light(
            name="lamp", type="point", colour=(1.0, 0.6, 0.3), intensity=3.0, position_m=(3, 1, 0.6)
        ),
        Light(
            name="spot",
            type="spot",
            intensity=14.0,
            position_m=(2, -1.5, 2),
            direction=(0.6, 0.3, -1),
        ),
        Light(
            name="panel", type="area", intensity=4.0, position_m=(4, 0, 2.5), direction=(0, 0, -1)
        ),
    )
    things = [
        Thing(
            model_of(floor, base_colour_texture=checker(4), roughness=0.6),
            Pose.from_rpy_deg((4, 0, -0.8), (0, 90, 0)),
        ),
        Thing(
            model_of(cube, base_colour=(0.7, 0.1, 0.1, 1)),
            Pose.from_rpy_deg((3.4, 0.9, -0.4), (0, 0, 30)),
        ),
        Thing(
            model_of(cube, base_colour=(0.95, 0.8, 0.4, 1), metallic=1.0, roughness=0.25),
            Pose.from_rpy_deg((3.2, -0.2, -0.3), (0, 20, 60)),
        ),
        Thing(
            model_of(cube, base_colour_texture=checker(2)),
            Pose.from_rpy_deg((4.2, -1.3, -0.1), (20, 20, 10)),
        ),
        Thing(model_of(cube, emission=(0.2, 0.5, 1.0)), Pose((5.5, 0.6, -0.2)), (0.5, 0.5, 0.5)),
    ]
    return snapshot_of(things, contents=contents_of(things, lights=lights, environment=DIM))


def test_shading_is_as_it_was(renderer: RenderBackend, render: Render) -> None:
    """The gallery's picture, 128 x 96, equals the stored one but for one grey level.

    ``SAILENV_UPDATE_GOLDENS=1`` stores the present one instead.
    """
    native = isinstance(renderer, NativeRenderer)
    assert native or "llvmpipe" in renderer.description, "goldens are of software rasterisers"
    camera = camera_at(look_at((0, 0, 0.5), (4, 0, -0.3)), width=128, height=96)
    rgb = render(gallery(), camera, "rgb")["rgb"]
    path = GOLDENS / ("gallery_native.png" if native else "gallery.png")
    if os.environ.get("SAILENV_UPDATE_GOLDENS"):
        GOLDENS.mkdir(exist_ok=True)
        cv2.imwrite(str(path), rgb[..., ::-1])
    golden = cv2.imread(str(path))[..., ::-1]
    difference = np.abs(rgb.astype(int) - golden.astype(int)).max(axis=-1)
    assert (difference > 1).mean() <= 0.002, f"{(difference > 1).sum()} pixels differ"
