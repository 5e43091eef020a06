"""Blurring of reflection maps, in plain NumPy: the definition of `native.light_maps`' kernel."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["blur_directions"]


def blur_directions(
    radiance: NDArray[np.float32],
    directions: NDArray[np.float32],
    lobe: NDArray[np.float32],
    result: NDArray[np.float32],
) -> None:
    """Average a map over a lobe about each direction; as `native.light_maps.blur_directions`."""
    edge = len(radiance)
    nx, ny, nz = np.moveaxis(directions.astype(np.float64), -1, 0)
    # A frame about the normal without trigonometry (Duff et al. 2017).
    sign = np.where(nz >= 0.0, 1.0, -1.0)
    a = -1.0 / (sign + nz)
    b = nx * ny * a
    sums, total = np.zeros(directions.shape), 0.0
    for lx, ly, lz, weight in lobe.astype(np.float64):
        if weight <= 0.0:
            continue
        x = lx * (1.0 + sign * nx * nx * a) + ly * b + lz * nx
        y = lx * sign * b + ly * (sign + ny * ny * a) + lz * ny
        z = -lx * sign * nx - ly * ny + lz * nz
        s = np.abs(x) + np.abs(y) + np.abs(z)
        px, py = x / s, y / s
        lower = z < 0.0
        qx = (1.0 - np.abs(py)) * np.where(px >= 0.0, 1.0, -1.0)
        qy = (1.0 - np.abs(px)) * np.where(py >= 0.0, 1.0, -1.0)
        px, py = np.where(lower, qx, px), np.where(lower, qy, py)
        u = np.clip(((px * 0.5 + 0.5) * edge).astype(np.intp), 0, edge - 1)
        v = np.clip(((py * 0.5 + 0.5) * edge).astype(np.intp), 0, edge - 1)
        sums += weight * radiance[v, u]
        total += weight
    result[:] = sums / total
