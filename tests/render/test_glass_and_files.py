"""Vignetting, lateral colour, gain and JPEG: by the formulas that they claim."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sailenv_ros.frame.pictures.codecs import decode_picture, encode_jpeg
from sailenv_ros.render.picture.optics import through_lens
from sailenv_ros.render.picture.sensor import sensor_light
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.picture_settings import PictureSettings
from tests.render.conftest import Render
from tests.support.tiny_scenes import two_instants

LENSES = (
    CameraIntrinsics(width=160, height=120, vertical_fov_deg=80.0, cx_offset_px=12.0),
    CameraIntrinsics(
        width=160,
        height=120,
        distortion_model="equidistant",
        distortion=(0.0, 0.0, 0.0, 0.0),
        fx_px=60.0,
        fy_px=60.0,
    ),
)


@pytest.mark.parametrize("lens", LENSES, ids=["pinhole", "equidistant"])
@pytest.mark.parametrize("strength", [0.4, 1.0])
def test_light_falls_off_with_the_fourth_power_of_the_cosine(
    lens: CameraIntrinsics, strength: float
) -> None:
    """Of a grey picture, at each pixel, to half precision; the fourth number stays."""
    grey = np.full((120, 160, 4), 0.5, np.float16)
    light = through_lens(grey, lens, PictureSettings(vignetting=strength))
    cosine = lens.unit_rays()[..., 2].clip(0.0, 1.0)
    expected = 0.5 * (1.0 - strength * (1.0 - cosine**4))
    np.testing.assert_allclose(light[..., :3], expected[..., None].repeat(3, -1), atol=5e-4)
    np.testing.assert_array_equal(light[..., 3], grey[..., 3])


def test_red_and_blue_pictures_have_other_sizes_around_the_axis() -> None:
    """A ramp from the axis: what red shows at p, green shows at p / 1.01."""
    lens = LENSES[0]
    u, v = np.meshgrid(np.arange(160.0), np.arange(120.0))
    ramp = np.zeros((120, 160, 4), np.float16)
    ramp[..., :3] = (4.0 + 0.01 * (u - lens.cx) + 0.02 * (v - lens.cy))[..., None]
    light = through_lens(ramp, lens, PictureSettings(lateral_colour=0.01)).astype(np.float64)
    inside = (slice(2, -2), slice(2, -2))
    away = light[..., 1] - 4.0
    np.testing.assert_array_equal(light[..., 1], ramp[..., 1].astype(np.float64))
    np.testing.assert_allclose(light[..., 0][inside], 4.0 + away[inside] / 1.01, atol=5e-3)
    np.testing.assert_allclose(light[..., 2][inside], 4.0 + away[inside] / 0.99, atol=5e-3)


def test_gain_brightens_as_exposure_does_but_not_the_electrons() -> None:
    """Without noise the same picture; with noise that of the light that was collected."""
    grey = np.full((100, 100, 4), 0.05, np.float16)
    gained = PictureSettings(gain=2.0, full_well=1000.0, read_noise=2.0)
    noisy = sensor_light(grey, gained, "eye", 0)[..., 0].astype(np.float64)
    assert abs(noisy.mean() - 0.05) < 2e-4
    assert noisy.std() == pytest.approx(np.sqrt(0.05 / 1000 + (2.0 / 1000) ** 2), rel=0.03)


def test_gain_and_exposure_give_one_picture_without_noise(render: Render) -> None:
    """The tone curve gets the product of both."""
    _, scene, _, camera = two_instants()
    views = [
        render(scene, replace(camera, picture=settings), "rgb")["rgb"]
        for settings in (
            PictureSettings(gain=1.5),
            PictureSettings(exposure=1.5),
            PictureSettings(),
        )
    ]
    np.testing.assert_array_equal(views[0], views[1])
    assert (views[0] != views[2]).any()


def test_a_picture_has_been_in_a_jpeg_file(render: Render) -> None:
    """The bytes that decoding a file of that quality gives; depth stays."""
    _, scene, _, camera = two_instants()
    plain = render(scene, camera, "rgb", "depth")
    settings = PictureSettings(jpeg_quality=60)
    kept = render(scene, replace(camera, picture=settings), "rgb", "depth")
    np.testing.assert_array_equal(kept["rgb"], decode_picture(encode_jpeg(plain["rgb"], 60)))
    np.testing.assert_array_equal(kept["depth"], plain["depth"])
