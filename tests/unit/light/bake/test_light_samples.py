"""Samples of lights, against the same arithmetic in NumPy."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sailenv_ros.light.bake.direct import Points
from sailenv_ros.native.gather_kernels import hemisphere_rays
from sailenv_ros.native.light_kernels import direct_light, light_rays, light_samples
from sailenv_ros.rays.ray_patterns import low_discrepancy_points
from sailenv_ros.types.light_shapes import LAMP_RADIUS_M, SUN_RADIUS, light_record
from sailenv_ros.types.lights import Light, area_sides

RAYS = 16
LIGHTS = (
    Light(name="sun", type="directional", direction=(0.6, 0.0, -0.8)),
    Light(name="lamp", type="point", position_m=(0.3, -0.2, 1.5), range_m=4.0),
    Light(
        name="spot", type="spot", position_m=(0.0, 0.5, 2.0), direction=(0.0, 0.6, -0.8),
        inner_cone_deg=20, outer_cone_deg=45,
    ),
    Light(
        name="panel", type="area", position_m=(1.0, 0.2, 1.3), direction=(-0.8, 0.36, -0.48),
        width_m=1.3, height_m=0.7,
    ),
)  # fmt: skip


def points() -> Points:
    """Points at random, with normals that lean off their faces, and shifts of their patterns."""
    rng = np.random.default_rng(1)
    faces = rng.normal(size=(300, 3))
    normals = faces + rng.normal(0.0, 0.2, faces.shape)
    normals, faces = (a / np.linalg.norm(a, axis=1, keepdims=True) for a in (normals, faces))
    return Points(
        positions=rng.uniform(-2.0, 2.0, (300, 3)).astype(np.float32),
        normals=normals.astype(np.float32),
        faces=faces.astype(np.float32),
        shifts=rng.uniform(0.0, 1.0, (300, 2)).astype(np.float32),
    )


def shifted(pattern: np.ndarray, shifts: np.ndarray) -> np.ndarray:
    """Each point of a net moved within its own cell of the square: (N, M, 2)."""
    cells = math.sqrt(len(pattern))
    cell = np.floor(pattern * cells)
    inside = (pattern * cells - cell)[None] + shifts[:, None]
    return (cell + inside - np.floor(inside)) / cells


def irradiance_of(light: Light, towards: np.ndarray, middle: np.ndarray) -> np.ndarray:
    """What the samples give to surfaces that face them."""
    if light.type == "directional":
        return np.ones(towards.shape[:2])
    if light.type == "area":
        d2 = (towards**2).sum(axis=2)
        leaving = np.maximum(-(towards @ np.asarray(light.direction)), 0.0) / np.sqrt(d2)
        return light.width_m * light.height_m * leaving / d2
    d2 = (middle**2).sum(axis=1)
    strength = np.clip(1.0 - (d2 / light.range_m**2) ** 2, 0.0, 1.0) ** 2 / d2
    if light.type == "spot":
        along = -(middle @ np.asarray(light.direction)) / np.sqrt(d2)
        outer, inner = (
            math.cos(math.radians(a)) for a in (light.outer_cone_deg, light.inner_cone_deg)
        )
        t = np.clip((along - outer) / (inner - outer), 0.0, 1.0)
        strength = strength * t * t * (3.0 - 2.0 * t)
    return np.repeat(strength[:, None], towards.shape[1], axis=1)


@pytest.mark.parametrize("light", LIGHTS, ids=lambda light: light.type)
def test_samples_lie_on_the_light_and_give_what_it_gives(light: Light) -> None:
    """On the sun's disc, a lamp's ball and a panel's rectangle, in the pattern's places."""
    lit, pattern = points(), low_discrepancy_points(RAYS)
    towards, lengths, irradiance = light_samples(light_record(light), lit.lit(), pattern)
    middle = np.asarray(light.position_m) - lit.positions
    np.testing.assert_allclose(
        irradiance, irradiance_of(light, towards.astype(float), middle), rtol=1e-4, atol=1e-6
    )
    at = shifted(pattern, lit.shifts)
    if light.type == "directional":
        cosine = -(towards @ np.asarray(light.direction))
        sine = np.linalg.norm(np.cross(towards, light.direction), axis=2)
        np.testing.assert_allclose(sine / cosine, SUN_RADIUS * np.sqrt(at[..., 0]), atol=1e-6)
        assert (lengths > 1e20).all()
        return
    assert (lengths < 1.0).all()
    if light.type == "area":
        width, height = area_sides(light)
        spots = (at[..., :1] - 0.5) * width + (at[..., 1:] - 0.5) * height
        np.testing.assert_allclose(towards, middle[:, None] + spots, atol=1e-5)
        return
    away = np.linalg.norm(towards - middle[:, None], axis=2)
    np.testing.assert_allclose(away, LAMP_RADIUS_M, rtol=1e-3)


@pytest.mark.parametrize("light", LIGHTS, ids=lambda light: light.type)
def test_rays_go_to_samples_before_both_horizons(light: Light) -> None:
    """Those that may bring light, from a millimetre off the face, as far as the sample."""
    lit, pattern = points(), low_discrepancy_points(RAYS)
    towards, lengths, irradiance = light_samples(light_record(light), lit.lit(), pattern)
    place, origins, rays, ends = light_rays(light_record(light), lit.lit(), pattern)
    above = (np.einsum("nmx,nx->nm", towards, lit.normals) > 0.0) & (irradiance > 0.0)
    above &= np.einsum("nmx,nx->nm", towards, lit.faces) > 0.0
    assert 0 < above.sum() < above.size
    np.testing.assert_array_equal(place, np.flatnonzero(above))
    np.testing.assert_array_equal(rays, towards[above])
    np.testing.assert_array_equal(ends, lengths[above])
    lifted = (lit.positions + lit.faces * np.float32(1e-3))[np.nonzero(above)[0]]
    np.testing.assert_array_equal(origins, lifted)


@pytest.mark.parametrize("light", LIGHTS[:3], ids=lambda light: light.type)
def test_what_arrives_is_the_mean_of_what_is_free(light: Light) -> None:
    """Irradiance over pi by the cosine of each sample; the share is that of the rays."""
    lit, pattern = points(), low_discrepancy_points(RAYS)
    free = np.random.default_rng(2).uniform(0.0, 1.0, (300, RAYS)).astype(np.float32)
    towards, _, irradiance = light_samples(light_record(light), lit.lit(), pattern)
    direct, share = direct_light(light_record(light), lit.lit(), pattern, free)
    cosine = np.einsum("nmx,nx->nm", towards, lit.normals) / np.linalg.norm(towards, axis=2)
    expected = (irradiance * np.maximum(cosine, 0.0) * free).mean(axis=1) / math.pi
    assert expected.any()
    np.testing.assert_allclose(direct, expected, rtol=1e-4, atol=1e-6)
    np.testing.assert_allclose(share, free.mean(axis=1), rtol=1e-5)


def test_rays_in_all_directions_begin_where_rays_to_lights_do() -> None:
    """A millimetre off the face, by all kernels."""
    lit = points()
    origins, _ = hemisphere_rays(lit.lit(), low_discrepancy_points(4))
    lifted = lit.positions + lit.faces * np.float32(1e-3)
    np.testing.assert_array_equal(origins, np.repeat(lifted[:, None], 4, axis=1))
