"""Points of thin sheets whose two layers cross each other, moved to where they are lit from.

From points of surfaces to points off them. Simplified furniture has sheets of leather or cloth that
are thinner than what their layers were moved by: where these cross, each lies behind the other and
is seen through its back. Rays from there would end between the layers, in the dark.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.rays.light_rays import RayScene
from sailenv_ros.rays.static_geometry import StaticGeometry

__all__ = ["above_crossed_layers"]

CROSSED_M = 4e-3
"""Distance within which a layer that faces a point of the same thing has crossed it [m]."""

FACING = -0.5
"""Cosine between the normals of two layers below which they face each other."""

LIFT_M = 2e-4
"""Distance from a point to the beginning of its ray, and from the layer to the point [m]."""

Floats = NDArray[np.float32]


def above_crossed_layers(
    geometry: StaticGeometry,
    scene: RayScene,
    positions: Floats,
    faces: Floats,
    triangles: NDArray[np.int32],
) -> Floats:
    """Return where the points are lit from: beyond a layer that has crossed their own, if one has.

    Parameters
    ----------
    geometry : StaticGeometry
    scene : RayScene
    positions : (N, 3) float32
        Points of surfaces, world frame [m].
    faces : (N, 3) float32
        Unit normals, towards the side that is lit.
    triangles : (N,) int32
        What each point is a point of.

    Returns
    -------
    positions : (N, 3) float32
        At most `CROSSED_M` and a little farther along the normal.
    """
    hits = scene.hits(positions + faces * np.float32(LIFT_M), faces)
    near = np.flatnonzero((hits.triangle >= 0) & (hits.distance < CROSSED_M))
    met = hits.triangle[near]
    facing = np.einsum("nx,nx->n", geometry.faces[met], faces[near]) < FACING
    crossed = near[facing & (geometry.owner[met] == geometry.owner[triangles[near]])]
    lifted = positions.copy()
    beyond = hits.distance[crossed] + np.float32(2.0 * LIFT_M)
    lifted[crossed] += faces[crossed] * beyond[:, None]
    return lifted
