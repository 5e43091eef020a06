"""Models as rays meet them. From `Model` to structures of `native.ray_types`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.rays.model_triangles import joined, triangles_of
from sailenv_ros.rays.triangle_tree import TriangleTree, triangle_tree
from sailenv_ros.types.baked_light import Unwrapping
from sailenv_ros.types.model import Model

__all__ = ["Shape", "shape_of"]


@dataclass(frozen=True, eq=False, slots=True)
class Shape:
    """The solid surface of a model at one scale.

    Attributes
    ----------
    tree : TriangleTree
    centre : (3,) float64
        Of a ball around it, in the body frame [m].
    radius : float
        [m].
    """

    tree: TriangleTree
    centre: NDArray[np.float64]
    radius: float


def shape_of(
    model: Model, scale: tuple[float, float, float], unwrapping: Unwrapping | None
) -> Shape:
    """Make a model ready for rays; glass, and what a mask leaves mostly open, is left out."""
    every = triangles_of(model)
    solid = every.passes == 0.0
    corners = (every.corners[solid] * np.asarray(scale)).astype(np.float32)
    places = None
    if unwrapping is not None:
        flat = zip(unwrapping.uvs, unwrapping.triangles, strict=True)
        places = joined([uvs[triangles] for uvs, triangles in flat], (3, 2))[solid]
    if np.prod(scale) < 0.0:
        # A mirrored model's triangles run the other way round.
        corners, places = corners[:, [0, 2, 1]], None if places is None else places[:, [0, 2, 1]]
    tree = triangle_tree(corners, every.two_sided[solid], places)
    centre = (tree.low + tree.high) / 2.0
    far = np.linalg.norm(corners.reshape(-1, 3) - centre, axis=1).max(initial=0.0)
    return Shape(tree, centre, float(far))
