"""Hollow forms that a lathe makes: vessels with a wall, and sleeves that are open at both ends."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import PchipInterpolator

from sailenv_content.families.shaping import Floats, along_the_axis, turned
from sailenv_content.procedural.forms import circle, loft
from sailenv_ros.types.model import Mesh

__all__ = ["closed_ring", "scaled", "sleeve", "smooth_profile", "vessel"]


def smooth_profile(points: ArrayLike, count: int = 20) -> Floats:
    """Return (count, 2) rows of radius and height [m] of a curve through rows from the base up."""
    rows = np.asarray(points, np.float64)
    steps = np.linalg.norm(np.diff(rows, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    at = np.linspace(0.0, along[-1], count)
    return np.stack([PchipInterpolator(along, rows[:, k])(at) for k in range(2)], axis=-1)


def vessel(
    outside: ArrayLike,
    *,
    wall: float,
    floor: float = 0.0,
    segments: int = 32,
    tile_m: float = 1.0,
    crease_deg: float = 40.0,
) -> Mesh:
    """Return a vessel that is open at its top.

    Parameters
    ----------
    outside : (N, 2) array-like
        Radius and height [m] of its outer side, from the edge of its base up to its rim.
    wall : float
        Thickness [m].
    floor : float
        Height of the inner floor above the base [m]; not less than the wall.
    """
    rows = np.asarray(outside, np.float64)
    base, top = rows[0, 1], rows[-1, 1]
    inner = rows[::-1] - np.array([wall, 0.0])
    inner = inner[(inner[:, 1] > base + max(floor, wall)) & (inner[:, 1] < top - 0.2 * wall)]
    inner[:, 0] = np.maximum(inner[:, 0], 0.0015)
    rim = [
        (rows[-1, 0] - 0.25 * wall, top + 0.3 * wall),
        (rows[-1, 0] - 0.75 * wall, top + 0.3 * wall),
        (max(rows[-1, 0] - wall, 0.0015), top),
    ]
    last = inner[-1, 0] if len(inner) else rows[-1, 0] - wall
    bottom = [(0.8 * last, base + max(floor, wall)), (0.0, base + max(floor, wall))]
    profile = np.concatenate([[(0.0, base)], rows, rim, inner, bottom])
    return turned(profile, segments=segments, tile_m=tile_m, crease_deg=crease_deg)


def sleeve(
    outside: ArrayLike,
    *,
    wall: float,
    segments: int = 32,
    tile_m: float = 1.0,
    crease_deg: float = 40.0,
) -> Mesh:
    """Return a wall along rows of radius and height [m], open at both ends: a shade, a ring."""
    rows = np.asarray(outside, np.float64)
    loop = np.concatenate([rows, rows[::-1] - np.array([wall, 0.0])])
    return closed_ring(loop, segments=segments, tile_m=tile_m, crease_deg=crease_deg)


def closed_ring(
    loop: ArrayLike, *, segments: int = 32, tile_m: float = 1.0, crease_deg: float = 40.0
) -> Mesh:
    """Return what a closed outline of radius and height [m], counter-clockwise, makes as it turns.

    Its last row is joined with its first.
    """
    rows = np.asarray(loop, np.float64)
    profile = np.concatenate([rows, rows[:1]])
    rings = np.empty((len(profile), segments, 3))
    rings[..., :2] = profile[:, None, :1] * circle(segments)
    rings[..., 2] = profile[:, 1:]
    return along_the_axis(loft(rings, caps=False), profile, tile_m, crease_deg)


def scaled(mesh: Mesh, factors: ArrayLike) -> Mesh:
    """Return a mesh scaled along x, y and z: an oval of what was turned."""
    by = np.asarray(factors, np.float64)
    normals = mesh.normals / by
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return Mesh(
        positions=(mesh.positions * by).astype(np.float32),
        normals=normals.astype(np.float32),
        uvs=mesh.uvs,
        triangles=mesh.triangles,
    )
