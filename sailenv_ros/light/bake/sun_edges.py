"""Shadow edges of the sun, at a finer resolution than texels. From texels to `SunEdges`.

The share of the sun that arrives is found by rays at 4 by 4 points of each texel near which a
shadow of it ends; elsewhere the light map says all there is to say.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.crossed_layers import above_crossed_layers
from sailenv_ros.light.bake.direct import Points, free_shares
from sailenv_ros.light.bake.texels import Texels, block_points
from sailenv_ros.native.bake_types import TexelMap
from sailenv_ros.native.texel_kernels import bordered_blocks
from sailenv_ros.rays.light_rays import RayScene
from sailenv_ros.rays.ray_patterns import low_discrepancy_points
from sailenv_ros.rays.static_geometry import StaticGeometry
from sailenv_ros.types.baked_light import EDGE_POINTS, SunEdges
from sailenv_ros.types.light_shapes import SUN_DISC_RADIUS, light_record
from sailenv_ros.types.lights import Light

__all__ = ["sun_edges"]

Floats = NDArray[np.float32]

RAYS = 16
"""Rays from each point to the sun."""

SIDE = EDGE_POINTS
POINTS = SIDE * SIDE

Run = Callable[[Callable[[int, int], None], int, int], None]
"""Does work for all of so many items with so many rays each; see `solving.Stages.run`."""


def sun_edges(
    geometry: StaticGeometry,
    scene: RayScene,
    texels: Texels,
    places: Floats,
    light: Light,
    chosen: NDArray[np.intp],
    run: Run,
) -> SunEdges:
    """Find the share of a directional light that arrives at points of some texels.

    Parameters
    ----------
    places : (T, 3, 2) float32
        Corners of the triangles in the map [texels].
    light : Light
    chosen : (K,) int
        Numbers of the texels.
    """
    shares = np.zeros((len(chosen), SIDE, SIDE), np.float32)

    def find(first: int, end: int) -> None:
        shares[first:end] = _shares(
            geometry, scene, texels, places, light, chosen[first:end]
        ).reshape(-1, SIDE, SIDE)

    run(find, len(chosen), POINTS * RAYS)
    index = np.full(texels.index.shape, -1, np.int32)
    index[texels.rows[chosen], texels.columns[chosen]] = np.arange(len(chosen), dtype=np.int32)
    of_map = TexelMap(
        index, texels.rows[chosen], texels.columns[chosen],
        geometry.owner[texels.triangle[chosen]], texels.positions[chosen],
        texels.normals[chosen], texels.faces[chosen],
    )  # fmt: skip
    blocks = bordered_blocks(of_map, shares)
    return SunEdges(index=index, blocks=np.rint(blocks * 255.0).astype(np.uint8))


def _shares(
    geometry: StaticGeometry,
    scene: RayScene,
    texels: Texels,
    places: Floats,
    light: Light,
    chosen: NDArray[np.intp],
) -> Floats:
    """Return (K 16,) float32."""
    triangle, _, positions, faces = block_points(geometry, places, texels, chosen)
    positions = above_crossed_layers(geometry, scene, positions, faces, triangle)
    # All points take the same rays: shares grow evenly across an edge, in small steps.
    shifts = np.zeros((len(triangle), 2), np.float32)
    points = Points(positions=positions, normals=faces, faces=faces, shifts=shifts)
    row = light_record(light, SUN_DISC_RADIUS)
    free, _ = free_shares(scene, row, points.lit(), low_discrepancy_points(RAYS))
    return np.asarray(free.mean(axis=1), np.float32)
