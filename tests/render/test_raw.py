"""The view `raw`: arithmetic on the light of a scene, one exposure with the picture beside it."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.render.contract import RenderBackend, RenderRequest
from sailenv_ros.render.picture.raw_data import raw_data
from sailenv_ros.render.picture.sensor import sensor_light
from sailenv_ros.types.bayer import BLACK_LEVEL, WHITE_LEVEL, mosaic
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.colour import linear_from_srgb
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Environment
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.snapshot import Observation, WorldSnapshot
from sailenv_ros.types.views import RENDERED_VIEWS
from tests.render.conftest import Render
from tests.support.tiny_scenes import (
    SUN,
    Thing,
    box_mesh,
    camera_at,
    model_of,
    snapshot_of,
    wall_mesh,
)

SPAN = WHITE_LEVEL - BLACK_LEVEL
LINEAR = PictureSettings(tone_curve="linear")
COLOUR = (0.125, 0.25, 0.5)  # exact in half precision


def of_light(radiance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the value of a pixel of that radiance, before it is rounded."""
    return np.clip(BLACK_LEVEL + SPAN * radiance, 0.0, WHITE_LEVEL)


def plain(colour: tuple[float, float, float]) -> WorldSnapshot:
    """Return nothing before a background of one radiance."""
    return snapshot_of([], environment=Environment(background="colour", background_colour=colour))


def room() -> WorldSnapshot:
    """Return a box before a wall in the sun."""
    wall = model_of(wall_mesh(3.0, 2.0), base_colour=(0.6, 0.5, 0.3, 1.0))
    box = model_of(box_mesh(0.6), base_colour=(0.2, 0.5, 0.7, 1.0))
    turned = Pose.from_rpy_deg((1.4, 0.2, 0.0), (20.0, 30.0, 40.0))
    return snapshot_of([Thing(wall, Pose((2.0, 0.0, 0.0))), Thing(box, turned)], lights=(SUN,))


def eye(settings: PictureSettings = LINEAR, *, name: str = "eye") -> Camera:
    """Return a camera of 96 by 72 pixels."""
    return replace(camera_at(), picture=settings, name=name)


@pytest.mark.parametrize(("width", "height"), [(16, 16), (17, 9)])
@pytest.mark.parametrize(("exposure", "gain"), [(0.0, 0.0), (-1.0, 1.5), (0.5, 2.0), (-4.0, 0.0)])
def test_each_pixel_counts_the_light_of_its_own_colour(
    render: Render, width: int, height: int, exposure: float, gain: float
) -> None:
    """Red in the corner, blue across, green between; full at white and no further."""
    camera = replace(
        camera_at(width=width, height=height),
        picture=replace(LINEAR, exposure=exposure, gain=gain, vignetting=0.0),
    )
    raw = render(plain(COLOUR), camera, "raw")["raw"]
    assert raw.shape == (height, width)
    assert raw.dtype == np.uint16
    red, green, blue = np.rint(of_light(np.array(COLOUR) * 2.0 ** (exposure + gain)))
    assert (raw[0::2, 0::2] == red).all()
    assert (raw[0::2, 1::2] == green).all()
    assert (raw[1::2, 0::2] == green).all()
    assert (raw[1::2, 1::2] == blue).all()


def test_black_is_the_black_level(render: Render) -> None:
    """And light without end the white one."""
    assert (render(plain((0.0, 0.0, 0.0)), eye(), "raw")["raw"] == BLACK_LEVEL).all()
    assert (render(plain((9.0, 40.0, 1.5)), eye(), "raw")["raw"] == WHITE_LEVEL).all()


def test_light_falls_off_by_the_cosine_s_fourth_power(render: Render) -> None:
    """To half precision, by the ray of each pixel."""
    camera = eye(replace(LINEAR, vignetting=1.0))
    raw = render(plain((0.5, 0.5, 0.5)), camera, "raw")["raw"]
    cosine = 1.0 / np.linalg.norm(camera.intrinsics.rays(), axis=-1)
    expected = of_light(0.5 * cosine**4)
    assert np.abs(raw - expected).max() <= 0.5 + SPAN * 0.5 * 2.0**-11
    assert expected.max() - expected.min() > 1000.0


@pytest.mark.parametrize(
    "settings",
    [
        LINEAR,
        replace(LINEAR, supersampling=2),
        replace(LINEAR, bloom=0.2, vignetting=0.5, lateral_colour=0.005),
        replace(LINEAR, full_well=3000.0, read_noise=4.0, gain=1.0, exposure=-1.0),
    ],
)
def test_the_picture_beside_it_is_of_the_same_exposure(
    render: Render, settings: PictureSettings
) -> None:
    """What RAW data say is the picture's own colour there, by the linear curve: noise, too."""
    views = render(room(), eye(settings), "rgb", "raw")
    linear = (views["raw"].astype(np.float64) - BLACK_LEVEL) / SPAN
    codes = mosaic(views["rgb"]).astype(np.float64)
    assert 0.05 < linear.mean() < 0.9
    low, high = (linear_from_srgb(np.clip((codes + d) / 255.0, 0.0, 1.0)) for d in (-0.5, 0.5))
    # Half precision, and the steps of 16 bits; what is less than black is black in a picture.
    slack = 2.0**-10 * np.abs(linear) + 2.0 / SPAN
    assert (linear.clip(0.0) >= low - slack).all()
    assert (linear <= high + slack).all()
    alone = render(room(), eye(settings), "raw")
    np.testing.assert_array_equal(alone["raw"], views["raw"])
    np.testing.assert_array_equal(render(room(), eye(settings), "rgb")["rgb"], views["rgb"])


def test_light_of_an_exposure_s_instants_is_averaged(renderer: RenderBackend) -> None:
    """Alone, and with a picture beside it."""
    instants = [
        Observation(snapshot=plain((level, level, level)), camera=eye()) for level in (0.25, 0.75)
    ]
    for views in (("raw",), ("rgb", "raw")):
        made = renderer.render(
            RenderRequest(instants[0].snapshot, eye(), views, samples=instants)
        ).views
        assert (made["raw"] == np.rint(of_light(np.array(0.5)))).all()


def test_other_views_keep_their_bytes(render: Render) -> None:
    """Beside it and without it; neither tone curve nor JPEG reaches it."""
    others = [name for name in RENDERED_VIEWS if name != "raw"]
    beside, alone = render(room(), eye(), *others, "raw"), render(room(), eye(), *others)
    for name in others:
        assert beside[name].tobytes() == alone[name].tobytes(), name
    developed = eye(PictureSettings(tone_curve="filmic", jpeg_quality=20))
    np.testing.assert_array_equal(render(room(), developed, "raw")["raw"], beside["raw"])


def test_edges_are_smooth_in_it(render: Render) -> None:
    """A border's pixels lie between both sides; without smooth edges none does."""
    white = model_of(
        wall_mesh(1.0, 1.0), emission=(0.5, 0.5, 0.5), base_colour=(0.0, 0.0, 0.0, 1.0)
    )
    turned = Pose.from_rpy_deg((2.0, 0.0, 0.0), (10.0, 0.0, 0.0))
    dark = Environment(
        background="colour",
        sky_zenith=(0.0, 0.0, 0.0),
        sky_horizon=(0.0, 0.0, 0.0),
        sky_ground=(0.0, 0.0, 0.0),
    )
    scene = snapshot_of([Thing(white, turned)], lights=(), environment=dark)
    between = {}
    for smooth in (True, False):
        settings = replace(LINEAR, smooth_edges=smooth, occlusion_strength=0.0)
        raw = render(scene, eye(settings), "raw")["raw"].astype(np.float64)
        low, high = raw.min(), raw.max()
        assert high - low > 0.1 * SPAN
        between[smooth] = (
            (raw > low + 0.1 * (high - low)) & (raw < high - 0.1 * (high - low))
        ).sum()
    assert between[True] > 40
    assert between[False] == 0


def test_equal_instants_have_equal_noise(render: Render) -> None:
    """Another instant and another camera have other noise."""
    noisy = eye(replace(LINEAR, full_well=500.0, read_noise=3.0))
    scene = plain(COLOUR)
    first = render(scene, noisy, "raw")["raw"]
    np.testing.assert_array_equal(render(scene, noisy, "raw")["raw"], first)
    later = replace(scene, sim_time_ns=50_000_000)
    for other in (render(later, noisy, "raw"), render(scene, replace(noisy, name="b"), "raw")):
        assert (other["raw"] != first).mean() > 0.95


def test_noise_has_the_law_s_mean_and_variance() -> None:
    """Of dark pixels, too: read-out noise below black is not cut off. To four standard errors."""
    settings = replace(LINEAR, full_well=400.0, read_noise=5.0, exposure=1.0, gain=0.5)
    for radiance in (0.0, 0.03125, 0.125):
        light = np.full((512, 512, 4), radiance, np.float16)
        raw = raw_data(light, settings, "eye", 7).astype(np.float64) - BLACK_LEVEL
        electrons = radiance * 2.0 * settings.full_well
        per_electron = SPAN * 2.0**settings.gain / settings.full_well
        deviation = per_electron * np.sqrt(electrons + settings.read_noise**2)
        count = raw.size
        assert abs(raw.mean() - electrons * per_electron) < 4.0 * deviation / np.sqrt(count)
        assert abs(raw.std() / deviation - 1.0) < 4.0 / np.sqrt(2.0 * count)
        neighbours = np.corrcoef(raw[:, :-1].ravel(), raw[:, 1:].ravel())[0, 1]
        assert abs(neighbours) < 4.0 / np.sqrt(count)


def test_its_noise_is_the_picture_s() -> None:
    """The numbers that the native library adds to the picture's radiance, to half precision."""
    settings = replace(LINEAR, full_well=200.0, read_noise=2.0)
    light = np.full((37, 51, 4), 0.5, np.float16)
    expected = of_light(mosaic(sensor_light(light, settings, "eye", 11)).astype(np.float64))
    raw = raw_data(light, settings, "eye", 11)
    assert np.abs(raw - expected).max() <= 0.5 + SPAN * 2.0**-11
    assert raw.std() > 1000.0


def test_opencv_reads_the_pattern(render: Render) -> None:
    """Its demosaicing gives each colour of a plain back."""
    raw = render(plain(COLOUR), eye(), "raw")["raw"]
    rgb = cv2.cvtColor(raw, cv2.COLOR_BayerRGGB2RGB)
    assert (rgb[2:-2, 2:-2] == np.rint(of_light(np.array(COLOUR)))).all()
