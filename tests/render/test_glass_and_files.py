"""Vignetting, lateral colour, gain and JPEG: by the formulas that they claim."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sailenv_ros.frame.pictures.codecs import decode_picture, encode_jpeg
from sailenv_ros.render.picture.optics import dirt_cover, through_lens
from sailenv_ros.render.picture.sensor import sensor_light
from sailenv_ros.render.picture.white_balance import balance_factors
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.colour import linear_from_srgb
from sailenv_ros.types.picture_settings import PictureSettings
from tests.render.conftest import Render
from tests.support.tiny_scenes import two_instants

XYZ_FROM_RGB = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750],
     [0.0193339, 0.1191920, 0.9503041]]
)  # fmt: skip
"""Linear sRGB: IEC 61966-2-1."""

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


def test_dirt_holds_light_back_and_lifts_the_dark() -> None:
    """By its cover; a part of what is held back is spread over the whole picture."""
    lens = LENSES[0]
    half = np.zeros((120, 160, 4), np.float16)
    half[:, 80:, :3] = 0.5
    cover = dirt_cover(160, 120).astype(np.float64)
    assert (cover >= 0.0).all()
    assert 0.1 < cover.mean() < 0.6
    assert cover.max() <= 1.0
    for dirt in (0.3, 1.0):
        light = through_lens(half, lens, PictureSettings(dirt=dirt))[..., :3].astype(np.float64)
        held = dirt * cover * half[..., 0]
        expected = half[..., 0] - held + 0.5 * held.mean()
        np.testing.assert_allclose(light, expected[..., None].repeat(3, -1), atol=5e-4)
    np.testing.assert_allclose(  # the same dirt in half the pixels
        dirt_cover(320, 240).reshape(120, 2, 160, 2).mean(axis=(1, 3)), cover, atol=0.08
    )


def test_a_white_balance_for_other_light_tints_the_picture(render: Render) -> None:
    """The camera divides by a black body's colour; CIE's illuminant A is at 2,856 K."""
    assert balance_factors(0.0) == (1.0, 1.0, 1.0)
    for mired in (-100.0, -30.0, 20.0, 100.0):
        red, green, blue = balance_factors(mired)
        assert green == 1.0
        assert (red > 1.0 > blue) is (mired > 0.0)
    # x, y of illuminant A (CIE 15): 0.44758, 0.40745. It is balanced for when light is bluer.
    white = np.linalg.inv(XYZ_FROM_RGB) @ (np.array([0.44758, 0.40745, 0.14497]) / 0.40745)
    daylight = np.linalg.inv(XYZ_FROM_RGB) @ (np.array([0.31352, 0.32363, 0.36285]) / 0.32363)
    expected = daylight / white
    factors = balance_factors(1e6 / 6504.0 - 1e6 / 2856.0 + 1e-9)
    np.testing.assert_allclose(factors, expected / expected[1], rtol=0.01)
    _, scene, _, camera = two_instants()
    views = {
        mired: render(
            scene,
            replace(camera, picture=PictureSettings(white_balance=mired, tone_curve="linear")),
            "rgb",
        )["rgb"]
        for mired in (0.0, 60.0)
    }
    plain, warm = (linear_from_srgb(views[mired] / 255.0) for mired in (0.0, 60.0))
    seen = (plain.min(axis=-1) > 0.05) & (warm.max(axis=-1) < 0.95)
    ratio = warm[seen] / plain[seen]
    np.testing.assert_allclose(np.median(ratio, axis=0), balance_factors(60.0), rtol=0.02)


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
