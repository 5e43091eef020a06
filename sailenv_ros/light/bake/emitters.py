"""Small things that shine: where they are, and rays that look for them.

Of rays in all directions few meet a lamp, and what they find is noise. So each point looks at each
lamp besides, into the cone of a ball around it; both samples are joined by the balance heuristic
(Veach and Guibas 1995), whatever it is that they meet.
"""

from __future__ import annotations

from collections.abc import Iterable

import numba
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.sampling import around_axis, shifted_point
from sailenv_ros.light.bake.static_geometry import StaticGeometry
from sailenv_ros.light.bake.texels import Texels

__all__ = ["chance_weights", "choice_weights", "emitters_of", "towards_emitter"]

Floats = NDArray[np.float32]

MOST_EMITTERS = 8

LARGEST_M = 0.5
"""Radius of a ball around an emitter; what is larger is met often enough."""

LEAST_SHARE = 0.01
"""Of what the strongest emitter sends out, below which one is not looked for."""

NEAR = 1.02
"""Who is nearer to the middle, in radii, looks for it in all directions alone."""


def emitters_of(
    geometry: StaticGeometry, texels: Texels, shining: Iterable[Floats]
) -> NDArray[np.float32]:
    """Return (E, 4) float32: middle and radius [m] of balls around small things that shine.

    Parameters
    ----------
    shining : iterable of (N, 3) float32
        What texels emit, once for each light and once for the surroundings.
    """
    owner = geometry.owner[texels.triangle]
    found: list[tuple[float, list[float]]] = []
    for emission in shining:
        bright = np.flatnonzero(emission.any(axis=1))
        for own in np.unique(owner[bright]):
            members = bright[owner[bright] == own]
            points = texels.positions[members].astype(np.float64)
            middle = (points.min(axis=0) + points.max(axis=0)) / 2.0
            radius = float(np.linalg.norm(points - middle, axis=1).max()) + 0.01
            power = float(emission[members].mean()) * radius * radius
            if radius <= LARGEST_M:
                found.append((power, [*middle, radius]))
    found.sort(key=lambda one: -one[0])
    chosen = [ball for power, ball in found if power >= LEAST_SHARE * found[0][0]]
    return np.array(chosen[:MOST_EMITTERS], np.float32).reshape(-1, 4)


@numba.njit(cache=True, nogil=True)
def _density(emitters, position, dx, dy, dz):  # type: ignore[no-untyped-def]
    """Return the density, over solid angle, of directions into the cones of all emitters."""
    density = 0.0
    for e in range(len(emitters)):
        x = emitters[e, 0] - position[0]
        y = emitters[e, 1] - position[1]
        z = emitters[e, 2] - position[2]
        d2 = x * x + y * y + z * z
        r2 = emitters[e, 3] * emitters[e, 3]
        if d2 <= NEAR * NEAR * r2:
            continue
        along = dx * x + dy * y + dz * z
        if along > 0.0 and along * along >= d2 - r2:
            density += 1.0 / (2.0 * np.pi * (1.0 - np.sqrt(1.0 - r2 / d2)))
    return density


@numba.njit(cache=True, nogil=True)
def towards_emitter(  # type: ignore[no-untyped-def]
    positions, normals, faces, shifts, emitter, pattern, point, towards
):
    """Fill in directions into the cone of an emitter above the horizon; return how many."""
    cells = np.sqrt(len(pattern))
    count = 0
    for k in range(len(positions)):
        x = emitter[0] - positions[k, 0]
        y = emitter[1] - positions[k, 1]
        z = emitter[2] - positions[k, 2]
        d2 = x * x + y * y + z * z
        r2 = emitter[3] * emitter[3]
        if d2 <= NEAR * NEAR * r2:
            continue
        far = np.sqrt(d2)
        x, y, z = x / far, y / far, z / far
        edge = np.sqrt(1.0 - r2 / d2)
        for m in range(len(pattern)):
            u, v = shifted_point(pattern[m], shifts[k], cells)
            up = 1.0 - u * (1.0 - edge)
            out = np.sqrt(max(1.0 - up * up, 0.0))
            s, t = out * np.cos(2.0 * np.pi * v), out * np.sin(2.0 * np.pi * v)
            dx, dy, dz = around_axis(x, y, z, s, t, up)
            if dx * normals[k, 0] + dy * normals[k, 1] + dz * normals[k, 2] <= 0.0:
                continue
            if dx * faces[k, 0] + dy * faces[k, 1] + dz * faces[k, 2] <= 0.0:
                continue
            point[count] = k
            towards[count, 0], towards[count, 1], towards[count, 2] = dx, dy, dz
            count += 1
    return count


@numba.njit(cache=True, nogil=True)
def choice_weights(  # type: ignore[no-untyped-def]
    positions, normals, emitters, point, towards, shots, others, weights
):
    """Fill in what rays into cones count: `shots` of them, and `others` in all directions."""
    for ray in range(len(point)):
        k = point[ray]
        dx, dy, dz = towards[ray]
        own = (dx * normals[k, 0] + dy * normals[k, 1] + dz * normals[k, 2]) / np.pi
        density = _density(emitters, positions[k], dx, dy, dz)
        weights[ray] = own / (others * own + shots * density)


@numba.njit(cache=True, nogil=True)
def chance_weights(  # type: ignore[no-untyped-def]
    positions, normals, emitters, directions, texels, shots, point, texel, weights
):
    """Fill in how much less rays in all directions count where cones are; return how many do.

    Without cones each counts one over their number. Only rays that met a texel are asked.
    """
    rays = texels.shape[1]
    count = 0
    for k in range(len(positions)):
        for m in range(rays):
            if texels[k, m] < 0:
                continue
            dx, dy, dz = directions[k, m]
            density = _density(emitters, positions[k], dx, dy, dz)
            if density == 0.0:
                continue
            # Rays that were mirrored at the face may lie below the normal's horizon.
            cosine = max(dx * normals[k, 0] + dy * normals[k, 1] + dz * normals[k, 2], 1e-3)
            own = cosine / np.pi
            if count < len(point):
                point[count], texel[count] = k, texels[k, m]
                weights[count] = own / (rays * own + shots * density) - 1.0 / rays
            count += 1
    return count
