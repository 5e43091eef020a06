"""Lays models' surfaces flat with xatlas. From `Model` to `Unwrapping` and its size in texels.

Knows neither where instances stand nor what lights them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xatlas
from numpy.typing import NDArray

from sailenv_ros.baked_light import Unwrapping
from sailenv_ros.model import Model

__all__ = ["Chart", "unwrapped"]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Chart:
    """A model laid flat.

    Attributes
    ----------
    unwrapping : Unwrapping
    width, height : int
        Of the smallest picture of it in which bilinear look-ups never meet other pieces [texels].
    """

    unwrapping: Unwrapping
    width: int
    height: int


def unwrapped(model: Model, scale: tuple[float, float, float], texel_m: float) -> Chart:
    """Lay a model flat.

    Parameters
    ----------
    model : Model
        With at least one triangle.
    scale : (3,) tuple of float
        Of the instance for which the texels have their size.
    texel_m : float
        Side of a texel [m].
    """
    atlas = xatlas.Atlas()
    drawn = [part.mesh for part in model.parts if len(part.mesh.triangles)]
    for mesh in drawn:
        points = mesh.positions * np.abs(np.asarray(scale, dtype=np.float32))
        atlas.add_mesh(points.astype(np.float32), np.array(mesh.triangles))
    packing = xatlas.PackOptions()
    packing.texels_per_unit = 1.0 / texel_m
    packing.padding = 1
    packing.bilinear = True
    atlas.generate(xatlas.ChartOptions(), packing)
    found = iter([atlas.get_mesh(i) for i in range(len(drawn))])
    parts = [
        next(found) if len(part.mesh.triangles) else _nothing(len(part.mesh.positions))
        for part in model.parts
    ]
    return Chart(
        unwrapping=Unwrapping(
            vertices=tuple(_frozen_indices(part[0]) for part in parts),
            triangles=tuple(_frozen_indices(part[1]) for part in parts),
            uvs=tuple(_frozen_floats(part[2]) for part in parts),
        ),
        width=atlas.width,
        height=atlas.height,
    )


def _nothing(count: int) -> tuple[NDArray[np.uint32], NDArray[np.uint32], NDArray[np.float32]]:
    vertices = np.arange(count, dtype=np.uint32)
    return vertices, np.zeros((0, 3), np.uint32), np.zeros((count, 2), np.float32)


def _frozen_indices(array: NDArray[np.uint32]) -> NDArray[np.uint32]:
    array = np.ascontiguousarray(array, dtype=np.uint32)
    array.flags.writeable = False
    return array


def _frozen_floats(array: NDArray[np.float32]) -> NDArray[np.float32]:
    array = np.ascontiguousarray(array, dtype=np.float32)
    array.flags.writeable = False
    return array
