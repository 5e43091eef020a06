"""The windows that the sky comes in by. From `StaticGeometry` to panes; knows no rays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.rays.static_geometry import StaticGeometry, StaticInstance

__all__ = ["panes"]

MOST_PANES = 16

THIN = 0.2
"""Glass thinner than this share of its width is a pane."""


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
