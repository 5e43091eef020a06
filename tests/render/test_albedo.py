"""Albedo: the material's linear base colour at each pixel's centre, and nothing of its light."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Environment, Light
from sailenv_ros.types.picture_settings import PictureSettings
from tests.render.conftest import Render
from tests.support.tiny_scenes import Thing, camera_at, model_of, snapshot_of, wall_mesh

AHEAD = Pose((2.0, 0.0, 0.0))
WALL = wall_mesh(60.0, 60.0)
COLOUR = (0.8, 0.25, 0.03)
TEXELS = 128
"""Edge of the smallest texture that is held without being resized."""


def linear_of_srgb8(codes: NDArray[np.uint8]) -> NDArray[np.float64]:
    """Light of sRGB codes, as IEC 61966-2-1 has it."""
    c = codes / 255.0
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def held(light: NDArray[np.float64]) -> NDArray[np.float64]:
    """Light as a texture holds it: 8 bits of its square root."""
    return (np.round(255.0 * np.sqrt(light)) / 255.0) ** 2


@pytest.mark.parametrize(
    "material",
    [
        {},
        {"metallic": 1.0, "roughness": 0.05},
        {"emission": (3.0, 6.0, 0.5)},
        {"double_sided": True},
    ],
)
def test_a_plain_material_s_colour_is_exact(render: Render, material: dict[str, Any]) -> None:
    """To single precision, of metals and of what glows too, in any light and in none."""
    things = [Thing(model_of(WALL, base_colour=(*COLOUR, 1.0), **material), AHEAD)]
    lamp = Light(name="lamp", type="point", intensity=500.0, position_m=(1.0, 0.0, 0.0))
    dark = Environment(sky_zenith=(0, 0, 0), sky_horizon=(0, 0, 0), sky_ground=(0, 0, 0))
    lit = render(snapshot_of(things, lights=(lamp,)), camera_at(), "albedo")["albedo"]
    unlit = render(snapshot_of(things, lights=(), environment=dark), camera_at(), "albedo")
    np.testing.assert_allclose(lit, np.broadcast_to(COLOUR, lit.shape), rtol=1e-6)
    np.testing.assert_array_equal(lit, unlit["albedo"])


def test_a_texture_s_colour_is_that_of_its_texels(render: Render) -> None:
    """Within a block of one colour exactly what the texture holds, times the factor.

    What it holds is the texel's light to 8 bits of its square root: at most 0.0036 beside it.
    """
    blocks = np.random.default_rng(11).integers(0, 256, (16, 16, 3), np.uint8)
    texture = np.full((TEXELS, TEXELS, 4), 255, np.uint8)
    texture[..., :3] = np.kron(blocks, np.ones((TEXELS // 16, TEXELS // 16, 1), np.uint8))
    wall = model_of(wall_mesh(2.0, 2.0), base_colour=(*COLOUR, 1.0), base_colour_texture=texture)
    camera = camera_at(width=512, height=384)
    seen = render(snapshot_of([Thing(wall, Pose((1.5, 0.0, 0.0)))]), camera, "albedo")["albedo"]
    rays = camera.intrinsics.rays()
    # u grows to the right and v upwards; row 0 of a texture is its top.
    column, row = (TEXELS * (0.5 + 0.5 * 1.5 * rays[..., axis] / rays[..., 2]) for axis in (0, 1))
    hit = (column > 0) & (column < TEXELS) & (row > 0) & (row < TEXELS)
    inside = hit & (np.abs(column % 8 - 4) < 3.25) & (np.abs(row % 8 - 4) < 3.25)
    assert inside.mean() > 0.2
    texel = blocks[row[inside].astype(int) // 8, column[inside].astype(int) // 8]
    light = linear_of_srgb8(texel)
    np.testing.assert_allclose(seen[inside], held(light) * COLOUR, rtol=2e-5, atol=1e-7)
    assert np.abs(seen[inside] / COLOUR - light).max() <= 0.0036
    assert not seen[~hit & ((column < -1) | (column > TEXELS + 1))].any()


def test_it_is_what_the_picture_s_settings_and_other_views_leave_alone(render: Render) -> None:
    """Alone, beside all others, and beside a supersampled picture: the same bytes."""
    things = [
        Thing(model_of(wall_mesh(1.0, 1.0), base_colour=(*COLOUR, 1.0)), AHEAD),
        Thing(model_of(WALL, base_colour=(0.1, 0.2, 0.3, 1.0)), Pose((4.0, 0.0, 0.0))),
    ]
    scene = snapshot_of(things)
    alone = render(scene, camera_at(), "albedo")["albedo"]
    beside = render(scene, camera_at(), "rgb", "depth", "normals", "albedo")
    fine = replace(camera_at(), picture=PictureSettings(supersampling=2, exposure=2.0))
    normals = render(scene, camera_at(), "normals")["normals"]
    np.testing.assert_array_equal(alone, beside["albedo"])
    np.testing.assert_array_equal(alone, render(scene, fine, "rgb", "albedo")["albedo"])
    np.testing.assert_array_equal(beside["normals"], normals)


def test_it_is_of_the_surface_that_depth_and_ids_are_of(render: Render) -> None:
    """0 where nothing was hit; behind a mask's holes and behind glass that of what is there."""
    red, green = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    holes = np.full((64, 64, 4), 255, np.uint8)
    holes[:, :32, 3] = 0
    leaf = model_of(
        wall_mesh(1.0, 1.0), alpha="mask", base_colour=(*red, 1.0), base_colour_texture=holes
    )
    pane = model_of(wall_mesh(60.0, 0.4), alpha="blend", base_colour=(0.2, 0.2, 0.2, 0.5))
    back = model_of(wall_mesh(3.0, 1.2), base_colour=(*green, 1.0))
    things = [
        Thing(pane, Pose((1.5, 0.0, 0.0))),
        Thing(leaf, AHEAD),
        Thing(back, Pose((3.0, 0.0, 0.0))),
    ]
    views = render(snapshot_of(things), camera_at(), "albedo", "instance")
    expected = np.zeros_like(views["albedo"])
    expected[views["instance"] == 2] = red
    expected[views["instance"] == 3] = green
    assert set(np.unique(views["instance"])) == {0, 2, 3}
    np.testing.assert_allclose(views["albedo"], expected, atol=1e-6)
