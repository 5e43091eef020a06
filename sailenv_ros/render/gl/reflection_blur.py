"""Blurs reflection maps for the OpenGL renderer, compiled by numba.

A map of all directions comes in, the same map seen in a rough mirror goes out.
"""

from __future__ import annotations

import numba

__all__ = ["blur_with_numba"]


@numba.njit(cache=True, nogil=True)
def blur_with_numba(radiance, directions, lobe, result):  # type: ignore[no-untyped-def]  # compiled
    """Average a map over a lobe about each direction; as `native.light_maps.blur_directions`."""
    edge = radiance.shape[0]
    for row in range(edge):
        for column in range(edge):
            nx, ny, nz = directions[row, column]
            # A frame about the normal without trigonometry (Duff et al. 2017).
            sign = 1.0 if nz >= 0.0 else -1.0
            a = -1.0 / (sign + nz)
            b = nx * ny * a
            r = g = bl = total = 0.0
            for k in range(lobe.shape[0]):
                lx, ly, lz, weight = lobe[k]
                if weight <= 0.0:
                    continue
                x = lx * (1.0 + sign * nx * nx * a) + ly * b + lz * nx
                y = lx * sign * b + ly * (sign + ny * ny * a) + lz * ny
                z = -lx * sign * nx - ly * ny + lz * nz
                s = abs(x) + abs(y) + abs(z)
                px, py = x / s, y / s
                if z < 0.0:
                    qx = (1.0 - abs(py)) * (1.0 if px >= 0.0 else -1.0)
                    py = (1.0 - abs(px)) * (1.0 if py >= 0.0 else -1.0)
                    px = qx
                u = min(max(int((px * 0.5 + 0.5) * edge), 0), edge - 1)
                v = min(max(int((py * 0.5 + 0.5) * edge), 0), edge - 1)
                r += weight * radiance[v, u, 0]
                g += weight * radiance[v, u, 1]
                bl += weight * radiance[v, u, 2]
                total += weight
            result[row, column, 0] = r / total
            result[row, column, 1] = g / total
            result[row, column, 2] = bl / total
