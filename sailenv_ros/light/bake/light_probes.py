"""Light at points in the air, for what moves. From the radiance of texels to a `ProbeGrid`."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.area_light import solid_angles
from sailenv_ros.light.bake.direct import Points
from sailenv_ros.light.bake.gather import Surroundings
from sailenv_ros.light.bake.settings import BakeSettings
from sailenv_ros.native.bake_types import SkyWindows
from sailenv_ros.native.light_kernels import light_samples
from sailenv_ros.native.surface_light import probe_radiance
from sailenv_ros.rays.light_rays import RayScene
from sailenv_ros.rays.ray_patterns import fibonacci_sphere
from sailenv_ros.types.baked_light import ProbeGrid
from sailenv_ros.types.light_shapes import light_record
from sailenv_ros.types.lights import Light

__all__ = [
    "ProbeViews",
    "dilated_grid",
    "probe_grid",
    "probe_light",
    "probe_positions",
    "straight_light",
]

Floats = NDArray[np.float32]

EYES_M = (0.8, 1.9)
"""Lowest and highest probe at the height of eyes above the lowest one of all [m]."""

LEVEL = 0.6
"""Sine of the angle to the horizon up to which pictures show what is around."""

CLEAR = 0.99
"""Share of the light that passes where there is no glass."""

MOST_SEEN = 16384
"""Greatest number of points that are remembered for exposure meters."""


def probe_grid(bounds: NDArray[np.float64], settings: BakeSettings) -> ProbeGrid:
    """Lay a grid over a box."""
    size = np.maximum(bounds[1] - bounds[0], 1e-3)
    spacing = settings.probe_spacing_m
    while True:
        counts = np.ceil(size / spacing).astype(int) + 1
        if counts.prod() <= settings.max_probes:
            break
        spacing *= 1.1
    x, y, z = (size / (counts - 1)).tolist()
    east, north, up = bounds[0].tolist()
    return ProbeGrid(
        origin_m=(east, north, up),
        spacing_m=(x, y, z),
        shape=(int(counts[2]), int(counts[1]), int(counts[0])),
    )


def probe_positions(grid: ProbeGrid) -> Floats:
    """Return (Z Y X, 3) float32: where the probes are, x changing fastest."""
    z, y, x = np.indices(grid.shape).reshape(3, -1)
    points = np.stack([x, y, z], axis=1) * np.asarray(grid.spacing_m) + np.asarray(grid.origin_m)
    positions: Floats = points.astype(np.float32)
    return positions


@dataclass(frozen=True, eq=False, slots=True)
class ProbeViews:
    """Views from probes: (R, 3) directions, (N, R) texels and the transmittance of glass."""

    directions: Floats
    texels: NDArray[np.int32]
    clear: Floats

    @classmethod
    def empty(cls, count: int, rays: int) -> ProbeViews:
        """Return views to be filled in by `look`."""
        return cls(
            fibonacci_sphere(rays),
            np.empty((count, rays), dtype=np.int32),
            np.empty((count, rays), dtype=np.float32),
        )

    def look(self, around: Surroundings, positions: Floats, first: int, end: int) -> None:
        """Fill in what some of the probes see."""
        count, rays = end - first, len(self.directions)
        origins = np.repeat(positions[first:end], rays, axis=0)
        directions = np.tile(self.directions, (count, 1))
        texels = around.met(origins, directions).texels
        self.texels[first:end] = texels.reshape(count, rays)
        clear = around.transmittance(texels, origins, directions)
        self.clear[first:end] = clear.reshape(count, rays)

    def level(self, positions: Floats, useful: NDArray[np.bool_]) -> NDArray[np.int32]:
        """Return (K,) int32: texels that eyes see, at the height of eyes, in level directions.

        Nothing behind glass. The lowest probe stands on the floor.

        Parameters
        ----------
        positions : (N, 3) float32
        useful : (N,) bool
            Probes in the air of a room.
        """
        up = positions[:, 2] - positions[:, 2].min()
        eyes = useful & (up >= EYES_M[0]) & (up <= EYES_M[1])
        rays = np.abs(self.directions[:, 2]) <= LEVEL
        texels = self.texels[np.ix_(eyes, rays)]
        found = texels[(texels >= 0) & (self.clear[np.ix_(eyes, rays)] > CLEAR)]
        step = -(-len(found) // MOST_SEEN) or 1
        return np.ascontiguousarray(found[::step])


def probe_light(views: ProbeViews, radiance: Floats, sky: SkyWindows, workers: int = 1) -> Floats:
    """Return (N, 4, C) float32: what arrives at probes from surfaces and sky; see `LightLayer`.

    Parameters
    ----------
    views : ProbeViews
    radiance : (texels, C) float32
    sky : SkyWindows
    workers : int
        Threads.
    """
    return probe_radiance(
        views.directions, views.texels, views.clear, sky, radiance, threads=workers
    )


def straight_light(scene: RayScene, light: Light, positions: Floats, pattern: Floats) -> Floats:
    """Return (N, 4) float32: what arrives at probes straight from a light."""
    row, points = light_record(light), Points.in_the_air(positions).lit()
    towards, lengths, irradiance = light_samples(row, points, pattern)
    count = len(pattern)
    free = scene.share_that_passes(
        np.repeat(positions, count, axis=0), towards.reshape(-1, 3), lengths.reshape(-1)
    ).reshape(-1, count)
    power = irradiance * free
    if light.type == "area":
        # A sample may be near; of the whole the formula knows how much arrives.
        whole = np.maximum(irradiance.mean(axis=1), 1e-30)
        power *= (solid_angles(light, positions) / whole)[:, None]
    length = np.maximum(np.linalg.norm(towards, axis=2, keepdims=True), 1e-9)
    arriving = np.empty((len(positions), 4), dtype=np.float32)
    arriving[:, 0] = power.mean(axis=1) / (4.0 * math.pi)
    arriving[:, 1:] = np.einsum("nm,nmx->nx", power, towards / length)
    arriving[:, 1:] /= 2.0 * math.pi * count
    return arriving


def dilated_grid(values: Floats, unknown: NDArray[np.bool_], grid: ProbeGrid) -> Floats:
    """Return probes that know nothing the mean of their neighbours, from the nearest on.

    Parameters
    ----------
    values : (Z Y X, 4, C) float32
    unknown : (Z Y X,) bool
    """
    shape = grid.shape
    field = values.reshape(*shape, -1).copy()
    known = ~unknown.reshape(shape)
    if not known.any():
        return values
    while not known.all():
        weight = np.pad(known.astype(np.float32), 1)
        padded = np.pad(field * known[..., None], ((1, 1), (1, 1), (1, 1), (0, 0)))
        total, number = np.zeros_like(field), np.zeros(shape, np.float32)
        for dz, dy, dx in np.ndindex(3, 3, 3):
            near = (
                slice(dz, dz + shape[0]), slice(dy, dy + shape[1]), slice(dx, dx + shape[2])
            )  # fmt: skip
            total += padded[near]
            number += weight[near]
        new = ~known & (number > 0)
        field[new] = total[new] / number[new][:, None]
        known = known | new
    return field.reshape(values.shape)
