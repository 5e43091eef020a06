"""Blurs reflection maps without the native library.

A map of all directions comes in, the same map seen in a rough mirror goes out.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["blur_directions"]

Doubles = NDArray[np.float64]


def blur_directions(
    radiance: NDArray[np.float32],
    directions: NDArray[np.float32],
    lobe: NDArray[np.float32],
    result: NDArray[np.float32],
    *,
    threads: int = 1,
) -> None:
    """Average a map over a lobe about each direction; as `native.light_maps.blur_directions`."""
    edge = len(radiance)
    nx, ny, nz = np.moveaxis(directions.astype(np.float64), -1, 0)
    # A frame about the normal without trigonometry (Duff et al. 2017).
    sign = np.where(nz >= 0.0, 1.0, -1.0)
    a = -1.0 / (sign + nz)
    b = nx * ny * a
    total, weights = np.zeros((edge, edge, 3)), 0.0
    for lx, ly, lz, weight in lobe.tolist():
        if weight <= 0.0:
            continue
        x = lx * (1.0 + sign * nx * nx * a) + ly * b + lz * nx
        y = lx * sign * b + ly * (sign + ny * ny * a) + lz * ny
        z = -lx * sign * nx - ly * ny + lz * nz
        row, column = _octahedral_texel(x, y, z, edge)
        total += weight * radiance[row, column]
        weights += weight
    result[:] = total / weights


def _octahedral_texel(
    x: Doubles, y: Doubles, z: Doubles, edge: int
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the rows and columns of directions in an octahedral map."""
    size = np.abs(x) + np.abs(y) + np.abs(z)
    p, q = x / size, y / size
    folded = (1.0 - np.abs(q)) * np.where(p >= 0.0, 1.0, -1.0)
    q = np.where(z < 0.0, (1.0 - np.abs(p)) * np.where(q >= 0.0, 1.0, -1.0), q)
    p = np.where(z < 0.0, folded, p)
    row, column = (np.clip(((at * 0.5 + 0.5) * edge).astype(np.intp), 0, edge - 1) for at in (q, p))
    return row, column
