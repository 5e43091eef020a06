"""What arrives straight from the lights, with soft shadows.

From `Light` and points of surfaces to irradiance / pi, for white light of intensity 1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.bake.area_light import form_factors
from sailenv_ros.bake.light_shapes import LAMP_RADIUS_M, SUN_DISC_RADIUS, SUN_RADIUS, area_sides
from sailenv_ros.bake.ray_patterns import fibonacci_sphere
from sailenv_ros.bake.rays import NEVER, RayScene
from sailenv_ros.bake.sampling import shifted
from sailenv_ros.lights import Light
from sailenv_ros.native.bake_types import LitPoints

__all__ = ["LightSamples", "Points", "arriving", "samples_of", "sun_directions", "visible_range"]

Floats = NDArray[np.float32]

LIFT_M = 1e-3
"""Rays begin this far off the surface."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Points:
    """Points that are lit.

    Attributes
    ----------
    positions, normals, faces : (N, 3) float32
        As in `Texels`.
    shifts : (N, 2) float32
        Of the patterns, see `tile_shift`.
    """

    positions: Floats
    normals: Floats
    faces: Floats
    shifts: Floats

    def moved(self, shift: tuple[float, float]) -> Points:
        """Return the same with patterns that are moved farther, in sizes of cells."""
        shifts = self.shifts + np.asarray(shift, dtype=np.float32)
        return replace(self, shifts=shifts - np.floor(shifts))

    def lit(self) -> LitPoints:
        """Return them as kernels take them."""
        arrays = self.positions, self.normals, self.faces, self.shifts
        return LitPoints(*(np.ascontiguousarray(array, np.float32) for array in arrays))

    def part(self, chosen: slice | NDArray[np.intp]) -> Points:
        """Return some of them."""
        return Points(
            positions=self.positions[chosen],
            normals=self.normals[chosen],
            faces=self.faces[chosen],
            shifts=self.shifts[chosen],
        )


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class LightSamples:
    """Rays from points towards one light.

    Attributes
    ----------
    towards : (N, M, 3) float32
        From the point to the light's sample; unit length for directional lights.
    lengths : (N, M) float32
        How far nothing may be in the way, in lengths of `towards`.
    irradiance : (N, M) float32
        On a surface that faces the sample, if nothing is in the way; the mean over M counts.
    """

    towards: Floats
    lengths: Floats
    irradiance: Floats


def samples_of(light: Light, positions: Floats, shifts: Floats, pattern: Floats) -> LightSamples:
    """Choose points on a light for each point that is lit."""
    at = shifted(pattern, shifts)
    if light.type == "directional":
        return _sun(light, at)
    if light.type == "area":
        return _panel(light, positions, at)
    return _lamp(light, positions, len(pattern))


def visible_range(
    scene: RayScene, light: Light, points: Points, pattern: Floats
) -> tuple[Floats, Floats]:
    """Return (N,) least and (N,) largest share of the light that rays from each point find free.

    Points that no ray leaves, because they face away, have inf and -inf.
    """
    samples, _, wanted = _rays(light, points, pattern)
    free = _free(scene, points, samples, wanted)
    lowest = np.where(wanted, free, np.float32(np.inf)).min(axis=1)
    highest = np.where(wanted, free, np.float32(-np.inf)).max(axis=1)
    return lowest, highest


def arriving(
    scene: RayScene, light: Light, points: Points, pattern: Floats, known: Floats | None = None
) -> tuple[Floats, Floats]:
    """Return (N,) irradiance / pi, and (N,) the share of the light that is visible.

    Parameters
    ----------
    known : (N,) float32 or None
        How much of each ray arrives, where that is known: then no rays are cast.
    """
    samples, cosine, wanted = _rays(light, points, pattern)
    if known is None:
        free = _free(scene, points, samples, wanted)
    else:
        free = np.where(wanted, known[:, None], np.float32(0.0))
    power = (samples.irradiance * np.maximum(cosine, 0.0)).astype(np.float64)
    arrives = (power * free).mean(axis=1) / math.pi
    if light.type == "area":
        # Samples tell the share that arrives of what the formula knows, as in Heitz, Hill and
        # McGuire 2018, "Combining analytic direct illumination and stochastic shadows".
        whole = power.mean(axis=1) / math.pi
        share = arrives / np.maximum(whole, 1e-30)
        arrives = form_factors(light, points.positions, points.normals) * share
    return arrives.astype(np.float32), free.mean(axis=1, dtype=np.float64).astype(np.float32)


def _rays(
    light: Light, points: Points, pattern: Floats
) -> tuple[LightSamples, Floats, NDArray[np.bool_]]:
    """Return rays to a light, their cosines, and which of them can bring light."""
    samples = samples_of(light, points.positions, points.shifts, pattern)
    cosine = np.einsum("nmx,nx->nm", samples.towards, points.normals)
    above = np.einsum("nmx,nx->nm", samples.towards, points.faces) > 0.0
    cosine /= np.maximum(np.linalg.norm(samples.towards, axis=2), 1e-12)
    return samples, cosine, above & (cosine > 0.0) & (samples.irradiance > 0.0)


def _free(
    scene: RayScene, points: Points, samples: LightSamples, wanted: NDArray[np.bool_]
) -> Floats:
    point, _ = np.nonzero(wanted)
    origins = points.positions[point] + points.faces[point] * np.float32(LIFT_M)
    free = np.zeros(wanted.shape, dtype=np.float32)
    free[wanted] = scene.share_that_passes(
        origins, samples.towards[wanted], samples.lengths[wanted]
    )
    return free


def sun_directions(
    light: Light, pattern: Floats, shifts: Floats, radius: float = SUN_DISC_RADIUS
) -> Floats:
    """Return (N, M, 3) float32: unit vectors towards points of a directional light's disc."""
    return _to_the_disc(light, shifted(pattern, shifts), radius).astype(np.float32)


def _to_the_disc(light: Light, at: Floats, radius: float) -> NDArray[np.float64]:
    forward = np.asarray(light.direction)
    helper = np.eye(3)[np.argmin(np.abs(forward))]
    side = np.cross(forward, helper)
    side /= np.linalg.norm(side)
    other = np.cross(forward, side)
    away, turn = radius * np.sqrt(at[..., 0]), 2.0 * np.pi * at[..., 1]
    towards = (
        -forward
        + (away * np.cos(turn))[..., None] * side
        + (away * np.sin(turn))[..., None] * other
    )
    return np.asarray(towards / np.linalg.norm(towards, axis=2, keepdims=True))


def _sun(light: Light, at: Floats) -> LightSamples:
    towards = _to_the_disc(light, at, SUN_RADIUS)
    return LightSamples(
        towards=towards.astype(np.float32),
        lengths=np.full(at.shape[:2], NEVER, np.float32),
        irradiance=np.ones(at.shape[:2], np.float32),
    )


def _lamp(light: Light, positions: Floats, count: int) -> LightSamples:
    ball = LAMP_RADIUS_M * fibonacci_sphere(count)
    middle = np.asarray(light.position_m, dtype=np.float32) - positions
    towards = middle[:, None] + ball[None]
    d2 = np.maximum(np.einsum("nx,nx->n", middle, middle), 1e-4).astype(np.float64)
    reach = d2 / max(light.range_m, 1e-6) ** 2
    strength = np.clip(1.0 - reach * reach, 0.0, 1.0) ** 2 / d2
    if light.type == "spot":
        along = -(middle @ np.asarray(light.direction)) / np.sqrt(d2)
        outer, inner = (
            math.cos(math.radians(angle)) for angle in (light.outer_cone_deg, light.inner_cone_deg)
        )
        t = np.clip((along - outer) / max(inner - outer, 1e-6), 0.0, 1.0)
        strength = strength * (t * t * (3.0 - 2.0 * t))
    return LightSamples(
        towards=towards,
        lengths=np.full(towards.shape[:2], 0.999, np.float32),
        irradiance=np.repeat(strength[:, None], count, axis=1).astype(np.float32),
    )


def _panel(light: Light, positions: Floats, at: Floats) -> LightSamples:
    width, height = area_sides(light)
    spots = (
        np.asarray(light.position_m) + (at[..., :1] - 0.5) * width + (at[..., 1:] - 0.5) * height
    )
    towards = (spots - positions[:, None]).astype(np.float32)
    d2 = np.maximum(np.einsum("nmx,nmx->nm", towards, towards), 1e-4).astype(np.float64)
    leaving = np.maximum(-(towards @ np.asarray(light.direction)), 0.0) / np.sqrt(d2)
    return LightSamples(
        towards=towards,
        lengths=np.full(towards.shape[:2], 0.999, np.float32),
        irradiance=(light.width_m * light.height_m * leaving / d2).astype(np.float32),
    )
