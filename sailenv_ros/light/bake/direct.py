"""Direct light, with soft shadows.

From `Light` and points of surfaces to irradiance / pi, for white light of intensity 1. Where rays
to a light go and what they bring says src/kernels/light_sampling.h, for relighting, too.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.bake_types import LitPoints
from sailenv_ros.native.light_kernels import direct_light, light_rays
from sailenv_ros.rays.light_rays import RayScene
from sailenv_ros.types.light_shapes import light_record
from sailenv_ros.types.lights import LAMP_TYPES, Light

__all__ = ["Points", "arriving", "free_shares", "squared_distances", "visible_range"]

Floats = NDArray[np.float32]


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

    @classmethod
    def in_the_air(cls, positions: Floats) -> Points:
        """Return points that belong to no surface."""
        none = np.zeros_like(positions)
        return cls(positions=positions, normals=none, faces=none, shifts=none[:, :2])

    def moved(self, shift: tuple[float, float]) -> Points:
        """Return the same with patterns that are moved farther, in sizes of cells."""
        shifts = self.shifts + np.asarray(shift, dtype=np.float32)
        return replace(self, shifts=shifts - np.floor(shifts))

    def lit(self) -> LitPoints:
        """Return them as kernels take them."""
        arrays = self.positions, self.normals, self.faces, self.shifts
        return LitPoints(*(np.ascontiguousarray(array, np.float32) for array in arrays))

    def lit_by(self, light: Light) -> LitPoints:
        """Return them as kernels take them for a light.

        The ball of a lamp is small: the same points of it for all leave no noise.
        """
        if light.type in LAMP_TYPES:
            return replace(self, shifts=np.zeros_like(self.shifts)).lit()
        return self.lit()

    def part(self, chosen: slice | NDArray[np.intp]) -> Points:
        """Return some of them."""
        return Points(
            positions=self.positions[chosen],
            normals=self.normals[chosen],
            faces=self.faces[chosen],
            shifts=self.shifts[chosen],
        )


def squared_distances(light: Light, positions: Floats) -> Floats:
    """Return (N,) float32: those of positions, (N, 3), from the middle of a light [m²]."""
    offsets = np.asarray(light.position_m, np.float32) - positions
    squares: Floats = np.einsum("nx,nx->n", offsets, offsets)
    return squares


def visible_range(
    scene: RayScene, light: Light, points: Points, pattern: Floats
) -> tuple[Floats, Floats]:
    """Return (N,) least and (N,) largest share of the light that rays from each point find free.

    Points that no ray leaves, because they face away, have inf and -inf.
    """
    free, wanted = free_shares(scene, light_record(light), points.lit_by(light), pattern)
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
    lit, row = points.lit_by(light), light_record(light)
    free, _ = free_shares(scene, row, lit, pattern, known)
    return direct_light(row, lit, pattern, free)


def free_shares(
    scene: RayScene,
    light: NDArray[np.void],
    points: LitPoints,
    pattern: Floats,
    known: Floats | None = None,
) -> tuple[Floats, NDArray[np.bool_]]:
    """Return how much of each ray to a light arrives, and which can bring light at all.

    Parameters
    ----------
    light : (1,) RAY_LIGHT
    points : LitPoints
    pattern : (M, 2) float32
    known : (N,) float32 or None
        See `arriving`.

    Returns
    -------
    free : (N, M) float32
        0 of those that can bring none.
    wanted : (N, M) bool
    """
    rays = len(pattern)
    free = np.zeros(points.count * rays, np.float32)
    wanted = np.zeros(len(free), np.bool_)
    place, origins, towards, lengths = light_rays(light, points, pattern)
    wanted[place] = True
    if known is None:
        free[place] = scene.share_that_passes(origins, towards, lengths)
    else:
        free[place] = known[place // rays]
    return free.reshape(-1, rays), wanted.reshape(-1, rays)
