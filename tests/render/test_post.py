"""What is done to pictures: by the formulas it claims, the same every time, and to nothing else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.render.picture.ambient_occlusion import ambient_visibility
from sailenv_ros.render.picture.sensor import sensor_light
from sailenv_ros.render.picture.tone import code_table, filmic, tone_mapped
from sailenv_ros.render.picture.tone_map import apply_visibility, tone_map
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.colour import srgb_from_linear
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Environment
from sailenv_ros.types.picture_settings import LIMITS, PictureSettings, ToneCurve
from sailenv_ros.types.views import LIT_VIEWS, RENDERED_VIEWS
from tests.render.conftest import Render
from tests.support.tiny_scenes import (
    SUN,
    Thing,
    box_mesh,
    camera_at,
    model_of,
    snapshot_of,
    two_instants,
    wall_mesh,
    white_furnace,
)

OFF = PictureSettings(occlusion_strength=0.0, smooth_edges=False)
ALL = PictureSettings(
    exposure=0.7,
    tone_curve="linear",
    occlusion_strength=1.0,
    occlusion_radius_m=0.5,
    smooth_edges=True,
    supersampling=3,
    bloom=0.3,
    full_well=500.0,
    read_noise=4.0,
)
NONE_BAKED = np.zeros(65536, np.uint8)
CURVES: tuple[ToneCurve, ...] = ("filmic", "linear")


@pytest.mark.parametrize("curve", CURVES)
@pytest.mark.parametrize("exposure", [-2.0, 0.0, 1.5])
def test_a_radiance_becomes_what_the_curve_says(
    render: Render, curve: ToneCurve, exposure: float
) -> None:
    """Pixels of one known radiance, in the picture: to half precision and one step of 255."""
    settings = PictureSettings(tone_curve=curve, exposure=exposure)
    camera = replace(camera_at(width=16, height=16), picture=settings)
    for colour in ((0.0, 0.002, 0.01), (0.05, 0.2, 0.4), (0.8, 1.5, 40.0)):
        plain = Environment(background="colour", background_colour=colour, exposure=0.5)
        rgb = render(snapshot_of([], environment=plain), camera, "rgb")["rgb"]
        expected = 255.0 * tone_mapped(np.asarray(colour) * 2.0**0.5, curve, exposure)
        assert (rgb == rgb[0, 0]).all()
        assert np.abs(rgb[0, 0] - expected).max() <= 0.55


@pytest.mark.parametrize("curve", CURVES)
def test_more_light_is_never_darker(curve: ToneCurve) -> None:
    """Over all numbers of half precision; what is none, or negative, is black."""
    table = code_table(PictureSettings(tone_curve=curve)).astype(int)
    assert (np.diff(table[:0x7C01]) >= 0).all()
    assert table[0] == 0
    assert table[0x7C00] == 255
    assert not table[0x7C01:].any()


def test_the_linear_curve_is_the_srgb_standard() -> None:
    """Every stored value, decoded as IEC 61966-2-1 says, is its radiance again."""
    codes = np.arange(256) / 255.0
    radiance = np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)
    np.testing.assert_allclose(srgb_from_linear(radiance), codes, atol=1e-6)
    table = code_table(PictureSettings(tone_curve="linear"))
    assert (table[radiance.astype(np.float16).view(np.uint16)] == np.arange(256)).all()
    assert filmic(0.0) == 0.0
    assert filmic(np.inf) == 1.0


def test_ground_truth_knows_nothing_of_the_picture(render: Render) -> None:
    """All other views are the same bytes with every setting on and off, asked together or alone."""
    before, after, past, now = two_instants()
    truth = [name for name in RENDERED_VIEWS if name not in LIT_VIEWS]
    seen = [
        render(after, replace(now, picture=settings), *names, past=(before, past))
        for settings in (OFF, ALL)
        for names in (truth, ["rgb", *truth])
    ]
    for name in truth:
        assert len({views[name].tobytes() for views in seen}) == 1, name
    assert (seen[1]["rgb"] != seen[3]["rgb"]).mean() > 0.5


def test_a_white_furnace_is_uniform_without_occlusion(render: Render) -> None:
    """White boxes before a white wall in uniform light cannot be seen."""
    scene = white_furnace()
    plain, dark = (
        render(scene, replace(camera_at(), picture=settings), "rgb")["rgb"].astype(int)
        for settings in (OFF, replace(OFF, occlusion_strength=1.0, occlusion_radius_m=0.5))
    )
    assert np.ptp(plain) <= 3
    assert (plain - dark).max() > 20
    assert (plain - dark).min() >= 0


def test_occlusion_leaves_light_that_comes_straight_from_a_lamp(render: Render) -> None:
    """In sun alone, without sky, corners are as they are without occlusion."""
    black = (0.0, 0.0, 0.0)
    night = Environment(ambient=black, sky_zenith=black, sky_horizon=black, sky_ground=black)
    floor = Thing(model_of(wall_mesh(8, 8)), Pose.from_rpy_deg((4.0, 0, -1.0), (0, 90, 0)))
    box = Thing(model_of(box_mesh(0.8)), Pose((4.0, 0.0, -0.6)))
    scene = snapshot_of([floor, box], lights=(SUN,), environment=night)
    plain, occluded = (
        render(scene, replace(camera_at(), picture=settings), "rgb")["rgb"]
        for settings in (OFF, replace(OFF, occlusion_strength=1.0))
    )
    np.testing.assert_array_equal(plain, occluded)


def corner(width: int = 160, height: int = 120) -> tuple[np.ndarray, CameraIntrinsics]:
    """Depth and ids of a back wall at 3 m (id 1) on a floor 1 m below the camera (id 2)."""
    intrinsics = CameraIntrinsics(width=width, height=height)
    rays = intrinsics.rays()
    floor = 1.0 / np.maximum(rays[..., 1], 1e-9)
    surface = np.stack([np.minimum(floor, 3.0), np.where(floor < 3.0, 2.0, 1.0)], axis=-1)
    return surface.astype(np.float32), intrinsics


def test_corners_are_dark_and_what_is_free_is_not() -> None:
    """Within the radius of the joint of wall and floor light is lost; beyond it none."""
    surface, intrinsics = corner(320, 240)
    share, inverse = ambient_visibility(
        surface, intrinsics, strength=1.0, radius_m=0.4, known=NONE_BAKED
    )
    points = intrinsics.unproject(surface[..., 0])[::2, ::2]
    away = np.hypot(points[..., 1] - 1.0, points[..., 2] - 3.0)
    # Averaging carries it a little farther.
    assert (share[away > 0.6] == 255).all()
    assert share[away < 0.06].mean() < 180
    # The sides of the picture lack neighbours.
    inner = slice(20, -20)
    profile = [
        share[:, inner][(away[:, inner] >= a) & (away[:, inner] < a + 0.08)].mean()
        for a in (0.08, 0.16, 0.24, 0.32)
    ]
    assert (np.diff(profile) > 0).all()
    np.testing.assert_allclose(inverse, 1.0 / surface[::2, ::2, 0], rtol=1e-6)


@pytest.mark.parametrize("yaw_deg", [0.0, 35.0, 60.0, 80.0])
def test_a_plane_does_not_darken_itself(yaw_deg: float) -> None:
    """However it is turned, and up to the picture's borders."""
    intrinsics = CameraIntrinsics(width=97, height=72)
    normal = np.array([np.sin(np.radians(yaw_deg)), 0.2, np.cos(np.radians(yaw_deg))])
    with np.errstate(divide="ignore"):
        z = 3.0 * normal[2] / (intrinsics.rays() @ normal)
    surface = np.stack([np.where(z > 0.0, z, np.inf), np.ones_like(z)], axis=-1)
    share, _ = ambient_visibility(
        surface.astype(np.float32), intrinsics, strength=1.0, radius_m=2.0, known=NONE_BAKED
    )
    assert (share == 255).all()


def test_what_was_baked_is_left_alone() -> None:
    """Two baked surfaces do not darken each other; one that moves darkens both."""
    surface, intrinsics = corner()
    known = NONE_BAKED.copy()
    known[[1, 2]] = 1
    keys = {"strength": 1.0, "radius_m": 0.4}
    assert (ambient_visibility(surface, intrinsics, known=known, **keys)[0] == 255).all()
    known[1] = 0
    share = ambient_visibility(surface, intrinsics, known=known, **keys)[0]
    wall = surface[::2, ::2, 1] == 1
    every = ambient_visibility(surface, intrinsics, known=NONE_BAKED, **keys)[0]
    np.testing.assert_array_equal(share[wall], every[wall])
    assert share[~wall].min() < 160


@pytest.mark.parametrize(("width", "height"), [(8, 8), (9, 11), (33, 8), (97, 61)])
def test_any_size_two_threads_make_what_one_makes(width: int, height: int) -> None:
    """Visibility and picture do not depend on how the rows are shared out."""
    surface, intrinsics = corner(width, height)
    surface[: height // 3, :, 0], surface[: height // 3, :, 1] = np.inf, 0
    radiance = np.random.default_rng(1).random((height, width, 4)).astype(np.float16)
    table = code_table(PictureSettings())
    pictures = []
    for threads in (1, 2):
        shade = ambient_visibility(
            surface, intrinsics, strength=1.0, radius_m=1.0, known=NONE_BAKED, threads=threads
        )
        pictures.append(tone_map(radiance, table, shade, surface, threads=threads))
    np.testing.assert_array_equal(pictures[0], pictures[1])
    assert shade[0].shape == ((height + 1) // 2, (width + 1) // 2)


def test_shade_takes_its_share_of_the_light() -> None:
    """Half closed, a pixel keeps 1 - share / 2 of its light, to half precision."""
    radiance = np.random.default_rng(2).random((20, 30, 4)).astype(np.float16)
    radiance[..., :3] *= 20
    surface = np.ones((20, 30, 2), np.float32)
    half = np.full((10, 15), 102, np.uint8)  # 0.4 arrives
    kept = apply_visibility(radiance, half, np.ones((10, 15), np.float32), surface)
    expected = radiance[..., :3].astype(float) * (1.0 - 0.6 * radiance[..., 3:].astype(float))
    np.testing.assert_allclose(kept[..., :3].astype(float), expected, rtol=2**-10, atol=1e-6)
    elsewhere = apply_visibility(radiance, half, np.full((10, 15), -0.5, np.float32), surface)
    np.testing.assert_array_equal(elsewhere, radiance)


@pytest.mark.parametrize("exposure", [0.0, 2.0])
@pytest.mark.parametrize("level", [0.02, 0.3, 2.0])
def test_noise_has_the_variance_of_its_formula(level: float, exposure: float) -> None:
    """Mean x and variance x / full_well + (read_noise / full_well)^2 of exposed radiance x."""
    settings = PictureSettings(full_well=2000.0, read_noise=3.0, exposure=exposure)
    grey = np.full((300, 400, 4), level, np.float16)
    value = float(grey[0, 0, 0]) * 2.0**exposure
    seen = sensor_light(grey, settings, "eye", 0)[..., :3].astype(float) * 2.0**exposure
    variance = value / 2000.0 + (3.0 / 2000.0) ** 2
    assert seen.mean() == pytest.approx(value, abs=5 * np.sqrt(variance / seen.size))
    # Half precision rounds by a part in 2^11 at most, evenly: less than a hundredth of this.
    assert seen.var() == pytest.approx(variance, rel=0.02)
    assert abs(np.corrcoef(seen[..., 0].ravel(), seen[..., 1].ravel())[0, 1]) < 0.02


def test_noise_comes_from_the_camera_and_the_time(render: Render) -> None:
    """The same agent at the same simulated time: the same bytes; any other: other ones."""
    grainy = PictureSettings(full_well=300.0, read_noise=2.0)
    wall = [Thing(model_of(wall_mesh(60, 60)), Pose((3.0, 0, 0)))]

    def shot(name: str, time_ns: int) -> bytes:
        camera = replace(camera_at(), picture=grainy, name=name)
        return render(snapshot_of(wall, time_ns=time_ns), camera, "rgb")["rgb"].tobytes()

    assert shot("left", 50_000_000) == shot("left", 50_000_000)
    assert len({shot("left", 0), shot("right", 0), shot("left", 50_000_000)}) == 3


def test_bloom_moves_light_and_makes_none() -> None:
    """A uniform picture stays; a bright spot loses its share to its surroundings."""
    grey = np.full((64, 96, 4), 0.5, np.float16)
    half = PictureSettings(bloom=0.5)
    np.testing.assert_array_equal(sensor_light(grey, half, "eye", 0), grey)
    spot = np.zeros((129, 129, 4), np.float16)
    spot[60:68, 60:68, :3] = 10.0
    spread = sensor_light(spot, PictureSettings(bloom=0.25), "eye", 0).astype(float)
    assert spread[..., :3].sum() == pytest.approx(10.0 * 64 * 3, rel=0.02)
    assert 7.4 < spread[64, 64, 0] < 10.0
    assert spread[64, 90, 0] > 0.0
    assert spread[64, 75, 0] > spread[64, 90, 0]


@pytest.mark.parametrize("name", LIMITS)
def test_numbers_out_of_range_are_refused(name: str) -> None:
    """Each number's limits are accepted, what is beyond them is not."""
    low, high = LIMITS[name].least, LIMITS[name].most
    assert low is not None
    assert high is not None
    for accepted in (low, high):
        assert getattr(PictureSettings(**{name: accepted}), name) == accepted
    for refused in (low - 0.1, high * 1.1, float("nan"), "1", True):
        with pytest.raises(InvalidRequest, match=name):
            PictureSettings(**{name: refused})


@pytest.mark.parametrize("refused", [0, 5, 2.0, True, "2", float("nan")])
def test_supersampling_is_a_small_whole_number(refused: object) -> None:
    for accepted in (1, 4, np.int64(2)):
        assert PictureSettings(supersampling=accepted).supersampling == accepted  # type: ignore[arg-type]
    with pytest.raises(InvalidRequest, match="supersampling must be an integer from 1 to 4"):
        PictureSettings(supersampling=refused)  # type: ignore[arg-type]


def test_unknown_words_are_refused() -> None:
    with pytest.raises(UnknownName, match="filmic, linear"):
        PictureSettings(tone_curve="log")  # type: ignore[arg-type]
    with pytest.raises(InvalidRequest, match="smooth_edges"):
        PictureSettings(smooth_edges=1)  # type: ignore[arg-type]
    assert Camera().picture == PictureSettings()
