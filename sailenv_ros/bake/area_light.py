"""Unoccluded irradiance from an area light, by closed formulas.

A few samples of a rectangle tell how much of it is hidden, but not how much arrives: where a sample
is near, a curtain before a window's light, it would count for far more than all of the rectangle.
"""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.bake.light_shapes import area_sides
from sailenv_ros.lights import Light

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
    found = np.zeros(len(positions), np.float32)
    _form_factors(_corners(light), np.asarray(light.direction, float), positions, normals, found)
    return found


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


@numba.njit(cache=True, nogil=True)
def _form_factors(corners, direction, positions, normals, found):  # type: ignore[no-untyped-def]
    above = np.empty((5, 3))
    heights = np.empty(4)
    towards = np.empty((4, 3))
    for k in range(len(positions)):
        before = 0.0
        for i in range(4):
            heights[i] = 0.0
            for c in range(3):
                towards[i, c] = corners[i, c] - positions[k, c]
                heights[i] += towards[i, c] * normals[k, c]
        for c in range(3):
            before -= towards[0, c] * direction[c]
        if before <= 0.0:
            continue
        # Clipped at the horizon, a rectangle has at most five corners.
        count = 0
        for i in range(4):
            j = (i + 1) % 4
            if heights[i] >= 0.0:
                above[count] = towards[i]
                count += 1
            if (heights[i] >= 0.0) != (heights[j] >= 0.0):
                share = heights[i] / (heights[i] - heights[j])
                above[count] = towards[i] + share * (towards[j] - towards[i])
                count += 1
        total = 0.0
        for i in range(count):
            ax, ay, az = above[i]
            bx, by, bz = above[(i + 1) % count]
            x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
            sine = np.sqrt(x * x + y * y + z * z)
            if sine > 0.0:
                angle = np.arctan2(sine, ax * bx + ay * by + az * bz)
                facing = x * normals[k, 0] + y * normals[k, 1] + z * normals[k, 2]
                total += angle * facing / sine
        found[k] = min(abs(total) / (2.0 * np.pi), 1.0)
