"""Where the texels of the light map are lit from. From `Layout` and rays to `Texels`.

A light map holds one side. Of a closed body whose triangles were wound either way that must be
the outer one, of a sheet that hangs before a wall the open one.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.crossed_layers import above_crossed_layers
from sailenv_ros.light.bake.layout import Layout
from sailenv_ros.light.bake.texels import Texels, rasterised
from sailenv_ros.light.bake.uneven_texels import with_typical_points
from sailenv_ros.light.bake.worker_pool import in_chunks
from sailenv_ros.rays.light_rays import LIFT_M, RayScene
from sailenv_ros.rays.ray_patterns import fibonacci_sphere
from sailenv_ros.rays.static_geometry import StaticGeometry

__all__ = ["lit_texels"]

RAYS = 42
FAR_M = 0.5
"""Greatest distance of view that counts; farther is open [m]."""

CLEARLY = 1.5
"""Least ratio of the openness of the back to that of the front for turning a surface."""

CHUNK_TRIANGLES = 8192

SPOTS = np.array(
    [[1, 1, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4], [3, 3, 1], [1, 3, 3], [3, 1, 3]], np.float32
)
SPOTS /= SPOTS.sum(axis=1, keepdims=True)
"""Points of a triangle, as weights of its corners."""


def lit_texels(
    geometry: StaticGeometry, scene: RayScene, layout: Layout, workers: int = 1
) -> Texels:
    """Return the texels in use, on the open side of their surfaces, beyond layers that crossed."""
    texels = rasterised(geometry, layout)
    texels = _turned_over(texels, _turned(geometry, scene, texels, workers))
    texels = with_typical_points(geometry, scene, layout.places, texels, workers)
    positions = above_crossed_layers(
        geometry, scene, texels.positions, texels.faces, texels.triangle
    )
    return replace(texels, positions=positions)


def _turned_over(texels: Texels, turned: NDArray[np.bool_]) -> Texels:
    if not turned.any():
        return texels
    sign = np.where(turned[texels.triangle], np.float32(-1.0), np.float32(1.0))[:, None]
    return replace(texels, normals=texels.normals * sign, faces=texels.faces * sign)


def _turned(
    geometry: StaticGeometry, scene: RayScene, texels: Texels, workers: int
) -> NDArray[np.bool_]:
    """Return (T,) bool: two-sided triangles whose back is the open side."""
    shown = np.zeros(geometry.triangle_count, dtype=bool)
    shown[texels.triangle] = True
    asked = np.flatnonzero(geometry.two_sided & shown)
    turned = np.zeros(geometry.triangle_count, dtype=bool)

    def find(first: int, end: int) -> None:
        own = asked[first:end]
        front, back = (_openness(geometry, scene, own, sign) for sign in (1.0, -1.0))
        turned[own] = back > CLEARLY * front

    in_chunks(find, len(asked), CHUNK_TRIANGLES, workers)
    return turned


def _openness(
    geometry: StaticGeometry, scene: RayScene, triangles: NDArray[np.intp], sign: float
) -> NDArray[np.float64]:
    """Return (T,) float64: mean distance that one side of each triangle sees, at most `FAR_M`."""
    normals = geometry.faces[triangles] * np.float32(sign)
    total = np.zeros(len(triangles))
    for number, direction in enumerate(fibonacci_sphere(RAYS)):
        # One point alone might lie inside of another thing.
        spot = SPOTS[number % len(SPOTS)]
        points = np.einsum("c,tcx->tx", spot, geometry.corners[triangles])
        side = np.where(normals @ direction < 0.0, np.float32(-1.0), np.float32(1.0))
        origins = points + normals * np.float32(LIFT_M)
        hits = scene.hits(origins, direction * side[:, None])
        total += np.minimum(hits.distance, FAR_M)
    return total / RAYS
