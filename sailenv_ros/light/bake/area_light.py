"""Unoccluded irradiance from an area light, by closed formulas.

A few samples of a rectangle tell how much of it is hidden, but not how much arrives: where a sample
is near, a curtain before a window's light, it would count for far more than all of the rectangle.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.light_kernels import rectangle_form_factors
from sailenv_ros.types.lights import Light, area_sides

__all__ = ["form_factors", "solid_angles"]

Floats = NDArray[np.float32]


def form_factors(light: Light, positions: Floats, normals: Floats) -> Floats:
    """Return (N,) float32: irradiance / pi at points from an area light of radiance 1, 0 to 1.

    Lambert's formula for polygons (1760), of the part above each point's horizon.

    Parameters
    ----------
    positions, normals : (N, 3) float32
        World frame [m]; normals are of unit length.
    """
    at, facing = (np.ascontiguousarray(a, np.float32) for a in (positions, normals))
    return rectangle_form_factors(_corners(light), np.asarray(light.direction, float), at, facing)


def solid_angles(light: Light, positions: Floats) -> Floats:
    """Return (N,) float32: what an area light takes of the sphere around points, 0 to 2 pi [sr].

    Of its two triangles each by the formula of Van Oosterom and Strackee (1983); 0 behind it.
    """
    towards = _corners(light)[None] - positions[:, None].astype(np.float64)
    length = np.linalg.norm(towards, axis=2)
    total = np.zeros(len(positions))
    for triangle in ((0, 1, 2), (0, 2, 3)):
        (a, b, c), (x, y, z) = np.moveaxis(towards[:, triangle], 1, 0), length[:, triangle].T
        volume = np.einsum("nx,nx->n", a, np.cross(b, c))
        ab, bc, ca = (np.einsum("nx,nx->n", *pair) for pair in ((a, b), (b, c), (c, a)))
        total += 2.0 * np.arctan2(np.abs(volume), x * y * z + ab * z + bc * x + ca * y)
    before = -(towards[:, 0] @ np.asarray(light.direction)) > 0.0
    return np.where(before, total, 0.0).astype(np.float32)


def _corners(light: Light) -> NDArray[np.float64]:
    """Return (4, 3) float64: the rectangle's corners, one after another."""
    width, height = area_sides(light)
    steps = ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))
    return np.array([np.asarray(light.position_m) + u * width + v * height for u, v in steps])
