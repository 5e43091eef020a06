"""Smooth edges: a pixel's light is that of the surfaces that it covers, by their shares.

The native renderer knows the share of a straight edge exactly if it is an eighth at least, and may
miss a smaller corner; OpenGL tells it by nine samples.
"""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.render.contract import RenderBackend, RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.render.picture.half_pixels import pixel_shares
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.colour import linear_from_srgb
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Environment
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.render.conftest import Render
from tests.support.tiny_scenes import (
    Thing,
    box_mesh,
    camera_at,
    checker,
    model_of,
    snapshot_of,
    wall_mesh,
)

GLOW = 0.5
BLACK = Environment(
    background="colour", background_colour=(0.0, 0.0, 0.0), ambient=(0.0, 0.0, 0.0), sky_share=0.0
)
LEAST_SHARE = 1 / 8
FINE = 32
"""Points on a side of a pixel by which the tests know shares."""


def camera(*, smooth: bool = True, size: tuple[int, int] = (64, 48)) -> Camera:
    """At the origin; the picture holds radiance as it is."""
    picture = PictureSettings(tone_curve="linear", occlusion_strength=0.0, smooth_edges=smooth)
    return replace(camera_at(width=size[0], height=size[1]), picture=picture)


def glowing(width_m: float, height_m: float, pose: Pose) -> Thing:
    """A rectangle that faces the camera and has one radiance."""
    look = {"base_colour": (0, 0, 0, 1), "emission": (GLOW, GLOW, GLOW), "roughness": 1.0}
    return Thing(model_of(wall_mesh(width_m, height_m), **look), pose)


def dark(*things: Thing) -> WorldSnapshot:
    """Things that nothing lights."""
    return snapshot_of(things, lights=(), environment=BLACK)


def shares_seen(rgb: NDArray[np.uint8]) -> NDArray[np.float64]:
    """How much of each pixel's light is there."""
    return np.asarray(linear_from_srgb(rgb[..., 1] / 255.0) / GLOW)


def shares_of(lens_of: Camera, corners_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """How much of each pixel a polygon covers, by `FINE` x `FINE` points in each."""
    lens = lens_of.intrinsics
    corners = lens.project(corners_m)
    x = (np.arange(lens.width * FINE) + 0.5) / FINE - 0.5
    y = (np.arange(lens.height * FINE) + 0.5) / FINE - 0.5
    inside = np.ones((len(y), len(x)), np.bool_)
    for first, second in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        along = second - first
        side = along[0] * (y[:, None] - first[1]) - along[1] * (x[None, :] - first[0])
        inside &= side > 0.0
    return np.asarray(inside.reshape(lens.height, FINE, lens.width, FINE).mean(axis=(1, 3)))


def corners_of(
    width_m: float, height_m: float, depth_m: float, roll_deg: float
) -> NDArray[np.float64]:
    """The corners in the optical frame, clockwise as the camera sees them."""
    angle = np.radians(roll_deg)
    flat = 0.5 * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (width_m, height_m)
    turned = flat @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return np.column_stack([turned, np.full(4, depth_m)])


@pytest.mark.parametrize("roll_deg", [0.0, 1.0, 7.0, 30.0, 45.0, 88.0])
def test_an_edge_covers_its_share_of_a_pixel(
    renderer: RenderBackend, render: Render, roll_deg: float
) -> None:
    """Along the sides of a rectangle, whatever their slope; inside and outside nothing changes."""
    size_m = 1.131, 0.877
    thing = glowing(*size_m, Pose.from_rpy_deg((2.0, 0, 0), (roll_deg, 0, 0)))
    seen = shares_seen(render(dark(thing), camera(), "rgb")["rgb"])
    expected = shares_of(camera(), corners_of(*size_m, 2.0, roll_deg))
    edge = (expected > 0.0) & (expected < 1.0)
    assert edge.sum() > 60
    around = cv2.dilate(edge.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    np.testing.assert_array_equal(seen[~around & (expected == 0.0)], 0.0)
    np.testing.assert_allclose(seen[~around & (expected == 1.0)], 1.0, atol=0.02)
    off = np.abs(seen - expected)[around]
    if isinstance(renderer, NativeRenderer):
        large = np.abs(expected[around] - 0.5) < 0.5 - LEAST_SHARE
        # But in the four corners.
        assert np.sort(off[large])[:-8].max() < 0.025
        assert np.sort(off)[:-8].max() < LEAST_SHARE
    assert off.max() < 0.27
    assert off.mean() < 0.13


def test_a_bar_narrower_than_a_pixel_is_seen_in_every_row(render: Render) -> None:
    """0.6 pixels wide, it is neither lost nor broken; without smoothing it is in 6 of 10 rows."""
    lens = camera().intrinsics
    bar = glowing(0.6 * 2.0 / lens.fx, 3.0, Pose.from_rpy_deg((2.0, 0.013, 0), (3, 0, 0)))
    smooth, plain = (
        shares_seen(render(dark(bar), camera(smooth=how), "rgb")["rgb"]).sum(axis=1)
        for how in (True, False)
    )
    assert plain.min() == 0.0
    assert smooth.min() > 0.45
    assert smooth.max() < 1.1
    assert smooth.mean() == pytest.approx(0.6, abs=0.05)


@pytest.mark.parametrize("upright", [True, False])
def test_a_bar_of_a_third_of_a_pixel_is_not_broken_into_dashes(upright: bool) -> None:
    """Nearly along an axis, it is in every row or column that it crosses, and nearly as strong."""
    native = NativeRenderer()
    scene_of = camera(size=(64, 64))
    width_m = 0.3 * 2.0 / scene_of.intrinsics.fx
    turned = Pose.from_rpy_deg((2.0, 0.013, 0.009), (0.6 if upright else 90.6, 0, 0))
    seen = native.render(RenderRequest(dark(glowing(width_m, 3.0, turned)), scene_of, ("rgb",)))
    native.close()
    sums = shares_seen(seen.views["rgb"]).sum(axis=1 if upright else 0)
    assert sums.min() > 0.15
    assert sums.max() < 0.55
    assert sums.mean() == pytest.approx(0.3, abs=0.03)


def test_where_two_walls_cross_each_has_its_share(renderer: RenderBackend, render: Render) -> None:
    """Their meeting is nobody's edge: one wall runs through the other."""
    turned = Pose.from_rpy_deg((2.0, 0, 0), (0, 0, 60))
    walls = [glowing(6.0, 6.0, Pose((2.0, 0, 0))), Thing(model_of(wall_mesh(2.0, 6.0)), turned)]
    rolled = replace(camera(), pose=Pose.from_rpy_deg((0, 0, 0), (8, 0, 0)))
    seen = shares_seen(render(dark(*walls), rolled, "rgb")["rgb"])
    # The meeting runs through the middle of the picture, 8 degrees from upright.
    ys, xs = np.mgrid[0:48, 0:64].astype(float)
    off_px = (xs - 31.5) * np.cos(np.radians(8)) - (ys - 23.5) * np.sin(np.radians(8))
    near = (np.abs(off_px) < 2.0) & (np.abs(ys - 23.5) < 20)
    slopes = np.cos(np.radians(8)), np.sin(np.radians(8))
    expected = np.mean(
        [
            off_px + dx * slopes[0] - dy * slopes[1] < 0.0
            for dx in (np.arange(FINE) + 0.5) / FINE - 0.5
            for dy in (np.arange(FINE) + 0.5) / FINE - 0.5
        ],
        axis=0,
    )
    expected = expected if seen[24, 28] > 0.5 else 1.0 - expected
    off, large = np.abs(seen - expected), np.abs(expected - 0.5) < 0.5 - LEAST_SHARE
    native = isinstance(renderer, NativeRenderer)
    assert off[near & large].max() < (0.03 if native else 0.27)
    assert off[near].max() < (LEAST_SHARE if native else 0.27)


def test_within_a_surface_nothing_is_smoothed(render: Render) -> None:
    """Texture and shading of a box's faces are those of pixel centres."""
    box = model_of(box_mesh(1.2), base_colour_texture=checker(), roughness=0.4)
    scene = snapshot_of([Thing(box, Pose.from_rpy_deg((2.2, 0, 0), (10, 20, 30)))])
    views = render(scene, camera(size=(200, 150)), "rgb", "normals")
    plain = render(scene, camera(smooth=False, size=(200, 150)), "rgb")["rgb"]
    turns = np.ptp(
        [np.roll(views["normals"], (v, u), (0, 1)) for v in (-1, 0, 1) for u in (-1, 0, 1)], axis=0
    ).max(axis=-1)
    inside = turns < 1e-3
    off = np.abs(views["rgb"].astype(int) - plain).max(axis=-1)
    assert inside.mean() > 0.7
    # OpenGL's textures depend on differences between neighbouring samples.
    assert (off[inside] > 1).mean() < 0.02
    assert off[inside].max() <= 8
    assert off[~inside].max() > 20


def test_a_mirror_has_smooth_edges(render: Render) -> None:
    """Where a slanted mirror ends, pixels are between what it shows and what is beside it."""
    look = {"base_colour": (0.9, 0.9, 0.9, 1.0), "metallic": 1.0, "roughness": 0.02}
    mirror = Thing(
        model_of(box_mesh((0.02, 1.2, 0.9)), **look), Pose.from_rpy_deg((3.0, 0, 0), (12, 0, 0))
    )
    behind = glowing(40.0, 40.0, Pose.from_rpy_deg((-1.0, 0, 0), (0, 0, 180)))
    size = (160, 120)
    seen, plain = (
        shares_seen(render(dark(mirror, behind), camera(smooth=how, size=size), "rgb")["rgb"])
        for how in (True, False)
    )
    corners = corners_of(1.2, 0.9, 2.99, 12.0)
    expected = shares_of(camera(size=size), corners)
    bright = np.median(seen[expected == 1.0])
    assert bright == pytest.approx(np.median(plain[expected == 1.0]), rel=0.01)
    edge = (expected > 0.2) & (expected < 0.8)
    off, off_plain = (np.abs(one / bright - expected)[edge].mean() for one in (seen, plain))
    assert off < 0.14
    assert off_plain > 0.3


def test_floors_far_away_keep_their_stripes(render: Render) -> None:
    """Stripes along the view are as strong as in the mean over 4 x 4 samples a pixel, nearly."""
    stripes = np.zeros((256, 256, 4), np.uint8)
    stripes[..., 3] = 255
    stripes[:, :, :3] = (np.arange(256) // 4 % 2 * 200 + 20)[None, :, None]
    floor = model_of(wall_mesh(8.0, 30.0), base_colour_texture=stripes, roughness=1.0)
    scene = snapshot_of(
        [Thing(floor, Pose.from_rpy_deg((15.0, 0, -0.6), (0, 90, 0)))],
        lights=(),
        environment=replace(BLACK, ambient=(0.5, 0.5, 0.5)),
    )
    fine = camera(size=(320, 240))
    many = replace(fine, picture=replace(fine.picture, supersampling=4))
    once, mean = (
        linear_from_srgb(render(scene, seen, "rgb")["rgb"][..., 1] / 255.0) for seen in (fine, many)
    )
    rows = slice(140, 200)
    contrast, wanted = (one[rows, 100:220].std(axis=1) for one in (once, mean))
    assert wanted.min() > 0.05
    assert (contrast / wanted).min() > 0.75


def test_samples_half_a_pixel_apart_are_the_cameras() -> None:
    """Those of odd numbers are the pixels' centres; any size may have them."""
    for size in ((8, 8), (63, 48), (4096, 3000)):
        whole = camera(size=size).intrinsics
        half = camera(size=size).of_half_pixels().intrinsics
        assert (half.width, half.height) == (2 * size[0] + 1, 2 * size[1] + 1)
        points = np.array([(0.1, -0.2, 1.0), (-0.4, 0.3, 2.5)])
        np.testing.assert_allclose(
            half.project(points), 2.0 * whole.project(points) + 1.0, atol=1e-9
        )


def test_shares_of_samples_follow_the_trapezoid_rule() -> None:
    """Of half planes through the middle a half, of a corner a sixteenth."""
    samples = np.zeros((5, 7), np.bool_)
    samples[:, :3] = True
    np.testing.assert_array_equal(pixel_shares(samples), [[1.0, 0.25, 0.0]] * 2)
    samples[:] = False
    samples[2, 2] = True
    np.testing.assert_array_equal(pixel_shares(samples), np.array([[1, 1, 0], [1, 1, 0]]) / 16.0)
    noise = np.random.default_rng(1).random((41, 61)) < 0.5
    kernel = np.outer((1, 2, 1), (1, 2, 1)) / 16.0
    whole = cv2.filter2D(noise.astype(np.float32), -1, kernel)[1::2, 1::2]
    np.testing.assert_allclose(pixel_shares(noise), whole, atol=1e-6)
