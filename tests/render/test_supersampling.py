"""Several samples a pixel: the mean of their light, in the picture and nowhere else."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.render.picture.supersampling import mean_radiance
from sailenv_ros.render.picture.tone import tone_mapped
from sailenv_ros.render.picture.tone_map import apply_visibility
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Environment
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.views import LIT_VIEWS, RENDERED_VIEWS
from tests.render.conftest import Render
from tests.support.tiny_scenes import (
    Thing,
    camera_at,
    model_of,
    snapshot_of,
    two_instants,
    wall_mesh,
    white_furnace,
)

PLAIN = PictureSettings(occlusion_strength=0.0, smooth_edges=False)
SAMPLES_AS_THEY_ARE = PictureSettings(smooth_edges=False)
GREY = (0.3, 0.3, 0.3)


def sampled(camera: Camera, times: int, **changes: Any) -> Camera:
    """The camera with so many samples on a side of a pixel."""
    return replace(camera, picture=replace(PLAIN, supersampling=times, **changes))


@pytest.mark.parametrize("times", [2, 3, 4])
@pytest.mark.parametrize("strength", [0.0, 1.0])
def test_ground_truth_stays_that_of_pixel_centres(
    render: Render, times: int, strength: float
) -> None:
    """All other views are the same bytes with and without, beside a picture or without one."""
    before, after, past, now = two_instants()
    truth = [name for name in RENDERED_VIEWS if name not in LIT_VIEWS]
    views = [
        render(after, camera, *names, past=(before, past))
        for camera in (now, sampled(now, times, occlusion_strength=strength))
        for names in (truth, ["rgb", *truth])
    ]
    for name in truth:
        assert len({seen[name].tobytes() for seen in views}) == 1, name
    assert (views[1]["rgb"] != views[3]["rgb"]).any()


@pytest.mark.parametrize("times", [2, 3, 4])
@pytest.mark.parametrize("covered", [0.2, 0.4, 0.6, 0.9])
def test_an_edge_within_a_pixel_is_the_mean_of_its_sides(
    render: Render, times: int, covered: float
) -> None:
    """Light of wall and sky by the samples that each has, mixed before the tone curve."""
    camera = sampled(camera_at(Pose(), width=32, height=24), times)
    lens = camera.intrinsics
    # The wall's left edge cuts column 12: the wall begins at this many columns from the left.
    edge_px = 12.5 - covered
    y_m = -(edge_px - lens.cx) / lens.fx * 2.0
    wall = Thing(
        model_of(wall_mesh(8.0, 8.0), base_colour=(1, 1, 1, 1), roughness=1.0),
        Pose((2.0, y_m - 4.0, 0.0)),
    )
    dark = Environment(
        background="colour",
        background_colour=(2.0, 1.0, 0.05),
        ambient=GREY,
        sky_share=0.0,
    )
    scene = snapshot_of([wall], lights=(), environment=dark)
    rgb = render(scene, camera, "rgb")["rgb"][12].astype(float)
    # A furnace: the wall sends back what it gets, as nearly as the picture without says.
    alone_seen = render(scene, sampled(camera, 1), "rgb")["rgb"][12]
    sky, lit = (_radiance(alone_seen[column]) for column in (4, 28))
    centres = (np.arange(times) + 0.5) / times
    share = float(np.mean(centres > 1.0 - covered))
    expected = 255.0 * tone_mapped((1.0 - share) * sky + share * lit)
    assert np.abs(rgb[12] - expected).max() <= 1.5
    np.testing.assert_array_equal(rgb[11], alone_seen[11])
    np.testing.assert_array_equal(rgb[13], alone_seen[13])


def _radiance(code: NDArray[np.uint8]) -> NDArray[np.float64]:
    """The radiance that a value of the filmic curve stands for."""
    levels = np.geomspace(1e-5, 40.0, 40001)
    return np.interp(code / 255.0, tone_mapped(levels), levels)


def test_a_mean_is_that_of_the_numbers() -> None:
    """To half precision, each sample less the light from around that does not arrive at it."""
    rng = np.random.default_rng(3)
    samples = rng.random((24, 36, 4)).astype(np.float16)
    samples[..., :3] *= 500.0
    surface = np.ones((24, 36, 2), np.float32)
    arrives = rng.integers(0, 256, (4, 6)).astype(np.uint8)
    inverse = np.ones((4, 6), np.float32)
    plain = samples.astype(float).reshape(8, 3, 12, 3, 4)
    mean = mean_radiance(samples, 3, None, None)
    np.testing.assert_allclose(mean[..., :3], plain[..., :3].mean(axis=(1, 3)), rtol=2**-10)
    assert not mean[..., 3].any()
    # A shade's number is that of a block of two by two pixels, so of six by six samples.
    closed = 1.0 - np.repeat(np.repeat(arrives / 255.0, 6, axis=0), 6, axis=1)
    left = 1.0 - closed * samples[..., 3].astype(float)
    expected = (samples[..., :3].astype(float) * left[..., None]).reshape(8, 3, 12, 3, 3)
    dark = mean_radiance(samples, 3, (arrives, inverse), surface)
    np.testing.assert_allclose(dark[..., :3], expected.mean(axis=(1, 3)), rtol=2**-10)


def test_a_shade_reaches_samples_of_its_own_surface() -> None:
    """What lies nearer keeps its light, sample by sample."""
    samples = np.ones((8, 8, 4), np.float16)
    surface = np.ones((8, 8, 2), np.float32)
    surface[:, ::2, 0] = 0.5
    shade = np.zeros((2, 2), np.uint8), np.ones((2, 2), np.float32)
    mean = mean_radiance(samples, 2, shade, surface)
    np.testing.assert_array_equal(mean[..., :3], np.float16(0.5))
    whole = apply_visibility(
        samples, np.zeros((4, 4), np.uint8), np.ones((4, 4), np.float32), surface
    )
    np.testing.assert_array_equal(mean_radiance(whole, 2, None, None), mean)


@pytest.mark.parametrize("size", [(8, 8), (9, 11), (33, 61)])
def test_two_threads_make_what_one_makes(size: tuple[int, int]) -> None:
    samples = np.random.default_rng(1).random((2 * size[0], 2 * size[1], 4)).astype(np.float16)
    means = [mean_radiance(samples, 2, None, None, threads=threads) for threads in (1, 2)]
    np.testing.assert_array_equal(*means)


def test_occlusion_means_the_same(render: Render) -> None:
    """As dark in a corner with samples as without, to a few values: radius and strength stay."""
    scene = white_furnace()
    deep = {"occlusion_strength": 1.0, "occlusion_radius_m": 0.5}
    one, many = (
        render(scene, sampled(camera_at(), times, **deep), "rgb")["rgb"].astype(int)
        for times in (1, 3)
    )
    assert one.max() - one.min() > 20
    assert np.abs(one - many).mean() < 1.0
    assert abs(int(one.sum()) - int(many.sum())) < 0.005 * one.sum()


def test_noise_is_of_pixels(render: Render) -> None:
    """A sensor's pixel has the noise of its own electrons, however it was drawn."""
    wall = [Thing(model_of(wall_mesh(60, 60)), Pose((3.0, 0, 0)))]
    grainy = {"full_well": 300.0, "read_noise": 2.0}
    one, many = (
        render(snapshot_of(wall), sampled(camera_at(), times, **grainy), "rgb")["rgb"].astype(int)
        for times in (1, 4)
    )
    # The same generator, seed and variance: all but rounding is the same.
    assert np.abs(one - many).max() <= 2


def test_too_many_samples_are_refused_in_one_sentence() -> None:
    """No side of what is drawn is larger than a picture may be."""
    lens = CameraIntrinsics(width=2048, height=8)
    assert Camera(intrinsics=lens, picture=PictureSettings(supersampling=2)).of_samples() == (
        Camera(intrinsics=replace(lens, width=4096, height=16), picture=SAMPLES_AS_THEY_ARE)
    )
    with pytest.raises(InvalidRequest) as refusal:
        Camera(intrinsics=lens, picture=PictureSettings(supersampling=3))
    assert str(refusal.value) == (
        "supersampling must be at most 2 for 2048 x 8 px (no side has over 4096 samples), got 3"
    )
