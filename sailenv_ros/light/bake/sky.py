"""What comes in from outside: the sky's radiance by direction, and the windows it comes through.

From `sky_picture` and `StaticGeometry` to what compiled code reads. Knows no rays.
"""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.static_geometry import StaticGeometry, StaticInstance

__all__ = ["panes", "sky_at"]

MOST_PANES = 16

THIN = 0.2
"""Glass thinner than this share of its width is a pane."""


@numba.njit(cache=True, nogil=True)
def sky_at(picture, x, y, z, channel):  # type: ignore[no-untyped-def]
    """Return one colour's radiance from a unit direction, between the nearest four texels."""
    height, width, _ = picture.shape
    row = np.arccos(min(max(z, -1.0), 1.0)) / np.pi * height - 0.5
    column = (0.5 - np.arctan2(y, x) / (2.0 * np.pi)) * width - 0.5
    r, c = int(np.floor(row)), int(np.floor(column))
    down, right = row - r, column - c
    top, bottom = max(r, 0), min(r + 1, height - 1)
    left, next_one = c % width, (c + 1) % width
    upper = picture[top, left, channel] * (1.0 - right) + picture[top, next_one, channel] * right
    lower = (
        picture[bottom, left, channel] * (1.0 - right) + picture[bottom, next_one, channel] * right
    )
    return upper * (1.0 - down) + lower * down


def panes(geometry: StaticGeometry) -> NDArray[np.float32]:
    """Find the flat pieces of glass, the largest first.

    Returns
    -------
    (P, 4, 3) float32
        Of each its middle, half its two sides, and its unit normal, in the world frame.
    """
    found = [
        pane
        for instance in geometry.instances
        for part in instance.model.parts
        if part.material.alpha == "blend" and len(part.mesh.triangles)
        for pane in _pane(instance, part.mesh.positions)
    ]
    found.sort(key=lambda pane: -float(np.linalg.norm(pane[1]) * np.linalg.norm(pane[2])))
    return np.array(found[:MOST_PANES], dtype=np.float32).reshape(-1, 4, 3)


def _pane(instance: StaticInstance, points: NDArray[np.float32]) -> list[NDArray[np.float64]]:
    low, high = points.min(axis=0), points.max(axis=0)
    scale = np.asarray(instance.scale)
    half = np.abs((high - low) / 2.0 * scale)
    thin, short, long = np.argsort(half, kind="stable")
    if half[thin] > THIN * half[short] or half[short] <= 0.0:
        return []
    rotation = instance.world_from_body[:3, :3]
    middle = rotation @ ((low + high) / 2.0 * scale) + instance.world_from_body[:3, 3]
    sides = [rotation[:, axis] * half[axis] for axis in (short, long)]
    return [np.stack([middle, *sides, rotation[:, thin]])]
