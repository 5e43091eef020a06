"""Which side of two-sided surfaces the light map shows. From `Texels` to `Texels`.

A light map holds one side. Of a closed body whose triangles were wound either way that must be
the outer one, of a sheet that hangs before a wall the open one.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.bake.rays import RayScene
from sailenv_ros.bake.sampling import fibonacci_sphere
from sailenv_ros.bake.scenery import Scenery
from sailenv_ros.bake.texels import Texels

__all__ = ["turned_to_the_light"]

RAYS = 32
FAR_M = 0.5
"""What is farther counts as open."""

CLEARLY = 1.5
"""How many times more open the back must be than the front."""

LIFT_M = 1e-3


def turned_to_the_light(scenery: Scenery, scene: RayScene, texels: Texels) -> Texels:
    """Turn the texels of two-sided triangles whose back is the open side."""
    asked = np.flatnonzero(scenery.two_sided)
    if not len(asked):
        return texels
    openness = [_openness(scenery, scene, asked, sign) for sign in (1.0, -1.0)]
    turned = np.zeros(scenery.triangle_count, dtype=bool)
    turned[asked] = openness[1] > CLEARLY * openness[0]
    sign = np.where(turned[texels.triangle], np.float32(-1.0), np.float32(1.0))[:, None]
    return replace(texels, normals=texels.normals * sign, faces=texels.faces * sign)


def _openness(
    scenery: Scenery, scene: RayScene, triangles: NDArray[np.intp], sign: float
) -> NDArray[np.float64]:
    """Give (T,) float64: mean distance that one side's middle sees, each at most `FAR_M`."""
    normals = scenery.faces[triangles] * np.float32(sign)
    middles = scenery.corners[triangles].mean(axis=1) + normals * np.float32(LIFT_M)
    total = np.zeros(len(triangles))
    for direction in fibonacci_sphere(RAYS):
        side = np.where(normals @ direction < 0.0, np.float32(-1.0), np.float32(1.0))
        towards = direction * side[:, None]
        total += np.minimum(scene.hits(middles, towards).distance, FAR_M)
    return total / RAYS
