"""Where the sun's light ends on surfaces, more finely than texels. From texels to `SunEdges`.

The share of the sun that arrives is found by rays at 4 by 4 points of each texel near which a
shadow of it ends; elsewhere the light map says all there is to say.
"""

from __future__ import annotations

from collections.abc import Callable

import numba
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.direct import LIFT_M, sun_directions
from sailenv_ros.light.bake.ray_patterns import net
from sailenv_ros.light.bake.rays import NEVER, RayScene
from sailenv_ros.light.bake.static_geometry import StaticGeometry
from sailenv_ros.light.bake.texels import Texels, closest_point, off_the_edges
from sailenv_ros.types.baked_light import EDGE_POINTS, SunEdges
from sailenv_ros.types.lights import Light

__all__ = ["sun_edges"]

Floats = NDArray[np.float32]

RAYS = 16
"""To the sun from each point."""

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
    owner = geometry.owner[texels.triangle[chosen]].astype(np.int32)
    blocks = np.empty((len(chosen), SIDE + 2, SIDE + 2), np.float32)
    _with_borders(
        index, texels.rows[chosen], texels.columns[chosen], owner, texels.faces[chosen],
        shares, blocks,
    )  # fmt: skip
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
    rows, columns = texels.rows[chosen], texels.columns[chosen]
    count = len(chosen) * POINTS
    triangle, weights = np.empty(count, np.int32), np.empty((count, 3), np.float32)
    _nearest(texels.index, texels.triangle, places, rows, columns, triangle, weights)
    corners = geometry.corners[triangle]
    weights = off_the_edges(corners, weights)
    positions = np.einsum("nc,ncx->nx", weights, corners)
    # Two-sided surfaces have the side of their texel.
    side = np.repeat(np.einsum(
        "nx,nx->n", texels.faces[chosen], geometry.faces[texels.triangle[chosen]]
    ), POINTS)  # fmt: skip
    faces = geometry.faces[triangle] * np.sign(side)[:, None].astype(np.float32)
    # All points take the same rays: shares grow evenly across an edge, in small steps.
    shifts = np.zeros((count, 2), np.float32)
    towards = sun_directions(light, net(RAYS), shifts)
    above = np.einsum("nmx,nx->nm", towards, faces) > 0.0
    point, _ = np.nonzero(above)
    origins = positions[point] + faces[point] * np.float32(LIFT_M)
    free = np.zeros(above.shape, np.float32)
    never = np.full(len(point), NEVER, np.float32)
    free[above] = scene.share_that_passes(origins, towards[above], never)
    return np.asarray(free.mean(axis=1), np.float32)


@numba.njit(cache=True, nogil=True)
def _nearest(  # type: ignore[no-untyped-def]
    index, triangles, places, rows, columns, triangle, weights
):
    """Find what each point of some texels stands for, among the triangles of neighbours."""
    height, width = index.shape
    share = np.zeros(3, np.float32)
    for k in range(len(rows)):
        for place in range(POINTS):
            x = columns[k] + (place % SIDE + 0.5) / SIDE
            y = rows[k] + (place // SIDE + 0.5) / SIDE
            at = k * POINTS + place
            best = np.inf
            # Its own first, so that others must be nearer.
            for number in range(10):
                down, right = ((number - 1) // 3 - 1, (number - 1) % 3 - 1) if number else (0, 0)
                row, column = rows[k] + down, columns[k] + right
                if row < 0 or row >= height or column < 0 or column >= width:
                    continue
                texel = index[row, column]
                if texel < 0:
                    continue
                far = closest_point(places[triangles[texel]], x, y, share)
                if far < best:
                    best = far
                    triangle[at] = triangles[texel]
                    weights[at] = share
                if best == 0.0:
                    break


@numba.njit(cache=True, nogil=True)
def _with_borders(index, rows, columns, owner, faces, shares, blocks):  # type: ignore[no-untyped-def]
    """Put a border around each block, from the neighbour's block where the surface goes on."""
    height, width = index.shape
    for k in range(len(rows)):
        for i in range(SIDE + 2):
            for j in range(SIDE + 2):
                down = -1 if i == 0 else (1 if i == SIDE + 1 else 0)
                right = -1 if j == 0 else (1 if j == SIDE + 1 else 0)
                row, column = rows[k] + down, columns[k] + right
                other = -1
                if 0 <= row < height and 0 <= column < width:
                    other = index[row, column]
                if other >= 0 and owner[other] == owner[k]:
                    alike = 0.0
                    for c in range(3):
                        alike += faces[other, c] * faces[k, c]
                    if alike > 0.5:
                        blocks[k, i, j] = shares[other, (i - 1) % SIDE, (j - 1) % SIDE]
                        continue
                inner, side = min(max(i - 1, 0), SIDE - 1), min(max(j - 1, 0), SIDE - 1)
                blocks[k, i, j] = shares[k, inner, side]
