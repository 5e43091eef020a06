"""Radiance of shades and bulbs of lamps by the lights in them. From triangles to arrays."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.rays.static_geometry import StaticGeometry

__all__ = ["glows_of"]


def glows_of(
    geometry: StaticGeometry, triangle: NDArray[np.int32], lit_by: Mapping[int, Iterable[str]]
) -> dict[str, NDArray[np.float32]]:
    """Return what the shades of lamps emit for 1 W/sr of white light, by the light in them.

    Parameters
    ----------
    triangle : (N,) int32
        Of each texel.
    lit_by : mapping of int to iterable of str
        Names of the lights that are in an instance, by its id.

    Returns
    -------
    glows : dict of str to (N, 3) float32
        Lights alone that make a texel glow.
    """
    lamps: dict[str, list[int]] = {}
    for place, instance in enumerate(geometry.instances):
        for name in lit_by[instance.id]:
            lamps.setdefault(name, []).append(place)
    # The last row is of no material.
    table = np.array([*(look.glow for look in geometry.materials), (0.0, 0.0, 0.0)], np.float32)
    owner, material = geometry.owner[triangle], geometry.material[triangle]
    found = {
        name: table[material] * np.isin(owner, places)[:, None] for name, places in lamps.items()
    }
    return {name: glow for name, glow in found.items() if glow.any()}
