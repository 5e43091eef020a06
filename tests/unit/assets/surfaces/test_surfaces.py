"""The surfaces: seamless, seeded, at a stated size, with the colour that was asked for."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.assets.surfaces import Surface, surface, surface_names
from sailenv_ros.assets.surfaces.maps import SurfaceMaps, surface_arrays, surface_of
from sailenv_ros.assets.surfaces.surface_catalogue import _made
from sailenv_ros.errors import UnknownName
from sailenv_ros.types.colour import LINEAR_OF_SRGB8

NAMES = surface_names()


def _textures(made: Surface) -> list[NDArray[np.uint8]]:
    material = made.material
    textures = [
        material.base_colour_texture,
        material.metallic_roughness_texture,
        material.normal_texture,
    ]
    return [texture for texture in textures if texture is not None]


def _linear(texture: NDArray[np.uint8]) -> NDArray[np.float64]:
    return LINEAR_OF_SRGB8[texture[..., :3]]


def test_the_kinds_that_rooms_need_are_there() -> None:
    assert {"plaster", "roughcast", "concrete", "oak_planks", "walnut_planks"} <= set(NAMES)
    assert {"white_tiles", "metro_tiles", "stone_tiles", "carpet", "oak_parquet"} <= set(NAMES)
    assert {"wallpaper_stripes", "wallpaper_damask"} <= set(NAMES)


def _check_textures(name: str, textures: list[NDArray[np.uint8]]) -> None:
    """Three opaque read-only pictures."""
    assert [texture.shape for texture in textures] == [(1024, 1024, 4)] * 3, name
    assert [texture.dtype for texture in textures] == [np.uint8] * 3, name
    assert not any(texture.flags.writeable for texture in textures), name
    assert all((texture[..., 3] == 255).all() for texture in textures), name


def _check_seams(name: str, textures: list[NDArray[np.uint8]]) -> None:
    """The step across a seam is as one between neighbours inside (at a joint, if it is one)."""
    for texture in textures:
        for axis in (0, 1):
            values = texture[..., :3].astype(np.int16)
            steps = np.abs(np.diff(values, axis=axis)).mean(axis=(1 - axis, 2))
            ends = np.take(values, 0, axis=axis) - np.take(values, -1, axis=axis)
            assert np.abs(ends).mean() <= 1.1 * steps.max(), name


def _check_average(name: str, albedo: NDArray[np.uint8], colour: NDArray[np.float64]) -> None:
    """Joints, pores and figures change it by a quarter at most, and hardly its hue."""
    average = _linear(albedo).mean(axis=(0, 1))
    np.testing.assert_allclose(average, colour, rtol=0.25, err_msg=name)
    np.testing.assert_allclose(
        average / average.sum(), colour / colour.sum(), atol=0.02, err_msg=name
    )


def _check_normals(name: str, texture: NDArray[np.uint8]) -> None:
    """Of unit length, level on average, never turned over."""
    normals = texture[..., :3].astype(np.float64) - 128.0
    assert np.abs(np.linalg.norm(normals, axis=-1) / 127.0 - 1.0).max() < 0.02, name
    assert np.abs(normals[..., :2].mean(axis=(0, 1))).max() < 1.5, name
    assert normals[..., 2].min() > 0, name


def test_each_surface_is_seamless_and_follows_from_name_colour_and_seed() -> None:
    """Every byte repeats; another seed gives another picture of the same average colour."""
    colour = (0.42, 0.30, 0.24)
    for name in NAMES:
        textures = _textures(surface(name, colour=colour))
        _check_textures(name, textures)
        _check_seams(name, textures)
        _check_average(name, textures[0], np.array(colour))
        _check_normals(name, textures[2])
        again = _textures(_made.__wrapped__(name, colour, 0))
        assert [one.tobytes() for one in textures] == [two.tobytes() for two in again], name
        other = _textures(_made.__wrapped__(name, colour, 1))
        assert not np.array_equal(textures[0], other[0]), name


def test_a_surface_is_made_once() -> None:
    """Models are compared by identity, so the GPU holds each texture once."""
    assert surface("plaster") is surface("plaster")
    assert surface("plaster", colour=(0.1, 0.2, 0.3)) is not surface("plaster")


def test_normals_lean_away_from_what_rises() -> None:
    """A wave along x and along y: height falls where the normal leans to +x, +y (up)."""
    turn = 2.0 * np.pi * (np.arange(1024) + 0.5) / 1024
    height = 0.01 * np.sin(turn)
    flat = np.ones((1024, 1024), np.float32)
    for axis, channel in ((1, 0), (0, 1)):
        shape = (1, 1024) if axis == 1 else (1024, 1)
        maps = SurfaceMaps(
            albedo=np.repeat(flat[..., None], 3, axis=2),
            height_m=(height.reshape(shape) * flat).astype(np.float32),
            roughness=flat,
            tile_m=(2.0, 2.0),
        )
        normals = (
            _textures(surface_of("wave", surface_arrays(maps)))[2][..., channel].astype(float)
            - 128.0
        )
        # Rows run downwards: y grows from the last row to the first.
        sense = 1.0 if axis == 1 else -1.0
        slope = sense * 0.01 * np.pi * np.cos(turn)
        expected = -127.0 * slope / np.sqrt(1.0 + slope**2)
        np.testing.assert_allclose(normals.mean(axis=1 - axis), expected, atol=0.6)


def test_texture_coordinates_are_metres_over_the_tile() -> None:
    made = surface("oak_planks")
    assert made.tile_m == (2.4, 1.2)
    np.testing.assert_allclose(made.uvs([[2.4, 0.0], [0.0, 0.6]]), [[1, 0], [0, 0.5]])


def test_herringbone_is_laid_at_45_degrees() -> None:
    """Along the floor's x axis one moves along the diagonal of the blocks."""
    made = surface("oak_parquet")
    half = np.sqrt(0.5) / made.tile_m[0]
    np.testing.assert_allclose(made.uvs([[1.0, 0.0]]), [[half, -half]], rtol=1e-6)


def test_an_unknown_name_is_answered_with_the_nearest() -> None:
    with pytest.raises(UnknownName, match="oak_planks"):
        surface("oak_plank")
