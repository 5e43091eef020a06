"""Rays of light against the static geometry: `StaticGeometry` to `RayScene`. Knows no light."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.ray_kernels import LightHits, light_hits, light_share
from sailenv_ros.rays.static_geometry import StaticGeometry
from sailenv_ros.rays.triangle_tree import TriangleTree, in_leaves, triangle_tree

__all__ = ["LIFT_M", "NEVER", "RayScene", "glass_of"]

Floats = NDArray[np.float32]

LIFT_M = 1e-3
"""Distance from their surfaces at which rays begin [m]."""

NEVER = 1e30
"""Length of rays without end [m]."""


def glass_of(geometry: StaticGeometry) -> tuple[TriangleTree, Floats]:
    """Return the panes, and (L, 8) float32, the share that each lets through, in their order."""
    chosen = ~geometry.solid & (geometry.passes < 1.0)
    tree = triangle_tree(geometry.corners[chosen])
    return tree, in_leaves(geometry.passes[chosen], tree.order)


class RayScene:
    """The triangles of the static geometry, ready to be met by rays from any thread."""

    def __init__(self, geometry: StaticGeometry) -> None:
        self._triangles = np.append(np.flatnonzero(geometry.solid), -1).astype(np.int32)
        self._solid = triangle_tree(geometry.corners[geometry.solid])
        self._panes, self._passes = glass_of(geometry)

    def hits(self, origins: Floats, directions: Floats) -> LightHits:
        """Find what solid triangles rays meet first."""
        found = light_hits(self._solid.record, *_dense(origins, directions), threads=1)
        return found._replace(triangle=self._triangles[found.triangle])

    def share_that_passes(self, origins: Floats, directions: Floats, lengths: Floats) -> Floats:
        """Return (R,) float32: how much of the light on each ray's length is let through, 0 to 1.

        Lengths are in lengths of the direction. Glass counts once, however many faces it has.
        """
        given = _dense(origins, directions, lengths)
        glass = self._panes.record, self._passes
        return light_share(self._solid.record, glass, *given, threads=1)

    def transmittance(self, origins: Floats, directions: Floats, lengths: Floats) -> Floats:
        """Return (R,) float32: the same, if nothing solid is in the way."""
        given = _dense(origins, directions, lengths)
        return light_share(None, (self._panes.record, self._passes), *given, threads=1)


def _dense(*arrays: Floats) -> tuple[Floats, ...]:
    return tuple(np.ascontiguousarray(array, np.float32) for array in arrays)
