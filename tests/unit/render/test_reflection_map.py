"""Maps of all directions: where a direction lies, and blurring them."""

from __future__ import annotations

import numpy as np

from sailenv_ros.render.reflection_blur import blur_directions as plain_blur
from sailenv_ros.render.reflection_map import (
    ROUGHNESSES,
    cube_cameras,
    flattened,
    light_from_around,
    octahedral_directions,
    prefilter,
)


def test_six_cameras_see_every_direction_as_it_is() -> None:
    """Pictures that show their own rays' directions come back as the map of directions."""
    cameras = cube_cameras(np.array([1.0, 2.0, 3.0]))
    pictures = []
    for camera in cameras:
        rays = camera.intrinsics.rays()
        rays = rays / np.linalg.norm(rays, axis=-1, keepdims=True)
        pictures.append((rays @ camera.world_from_camera[:3, :3].T).astype(np.float32))
    found = flattened(cameras, pictures, 64)
    np.testing.assert_allclose(found, octahedral_directions(64), atol=2e-3)


def test_what_is_the_same_everywhere_stays_so() -> None:
    """Blurring takes nothing away and adds nothing, border included."""
    layers = prefilter(np.full((24, 24, 3), 0.5, np.float32), blur=plain_blur)
    assert layers.shape == (len(ROUGHNESSES), 26, 26, 4)
    np.testing.assert_allclose(layers[..., :3], 0.5, rtol=1e-3)


def test_rougher_is_flatter_about_the_same_place() -> None:
    """A bright spot spreads with roughness, and its middle stays."""
    directions = octahedral_directions(64)
    spot = np.where(directions[..., :1] > 0.97, 10.0, 0.0) * np.ones(3, np.float32)
    layers = prefilter(spot.astype(np.float32), blur=plain_blur)[:, 1:-1, 1:-1, 0].astype(float)
    peaks = layers.max(axis=(1, 2))
    assert (np.diff(peaks) <= 0.0).all()
    assert peaks[-1] < 0.8 * peaks[0]
    for blurred in layers:
        middle = (blurred[..., None] * directions).sum(axis=(0, 1))
        assert middle[0] / np.linalg.norm(middle) > 0.999


def test_the_border_goes_on_across_the_edges() -> None:
    """A smooth function of direction is smooth across the square's edges too."""
    directions = octahedral_directions(32)
    smooth = (1.0 + directions).astype(np.float32)
    layer = prefilter(smooth, blur=plain_blur)[0, ..., :3].astype(float)
    inside = np.abs(np.diff(layer[1:-1, 1:-1], axis=0)).max()
    assert np.abs(layer[0, 1:-1] - layer[1, 1:-1]).max() < 1.5 * inside
    assert np.abs(layer[1:-1, -1] - layer[1:-1, -2]).max() < 1.5 * inside


def test_light_from_around_is_that_of_the_half_space() -> None:
    """Even light gives itself to every surface; a lit upper half half of it to walls."""
    directions = octahedral_directions(64)
    even = np.full((64, 64, 3), 0.5)
    np.testing.assert_allclose(light_from_around(even), [0.5, 0.0, 0.0, 0.0], atol=1e-6)
    above = np.where(directions[..., 2:] > 0.0, 2.0, 0.0) * np.ones(3)
    np.testing.assert_allclose(light_from_around(above), [1.0, 0.0, 0.0, 1.0], atol=2e-2)
    red = above * np.array([1.0, 0.0, 0.0])
    np.testing.assert_allclose(light_from_around(red), 0.2126 * light_from_around(above), atol=1e-9)
