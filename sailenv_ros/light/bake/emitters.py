"""Small things that shine: where they are.

Of rays in all directions few meet a lamp, and what they find is noise. So each point looks at each
lamp besides, into the cone of a ball around it; both samples are joined by the balance heuristic
(Veach and Guibas 1995), whatever it is that they meet.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.texels import Texels
from sailenv_ros.rays.static_geometry import StaticGeometry

__all__ = ["MOST_EMITTERS", "emitters_of"]

Floats = NDArray[np.float32]

MOST_EMITTERS = 8

LARGEST_M = 0.5
"""Radius of a ball around an emitter; what is larger is met often enough."""

LEAST_SHARE = 0.01
"""Least power of an emitter that is sampled, as a share of the strongest one's."""


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
