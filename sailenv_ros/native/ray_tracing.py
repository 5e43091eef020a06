"""Trees for rays and the texels of light maps, by src/kernels/ray_tree.cpp."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import Kernel, checked
from sailenv_ros.native.ray_types import TREE_NODE

__all__ = ["build_box_tree", "cover_texels"]

_TREE = Kernel("build_box_tree", "integer", "array", "array", "array", "array")
_COVER = Kernel("cover_texels", "integer", "integer", "number", "array", "array", "array", "array")


def build_box_tree(boxes: NDArray[np.float32]) -> tuple[NDArray[np.void], NDArray[np.int32]]:
    """Build a tree of boxes.

    Parameters
    ----------
    boxes : (N, 6) float32
        Lowest and highest corner of each thing; finite, at least one.

    Returns
    -------
    nodes : (M,) TREE_NODE
        The first one holds all.
    order : (N,) int32
        The things in the order in which leaves hold them.
    """
    count = len(boxes)
    checked("boxes", boxes, np.float32, (None, 6))
    nodes = np.zeros(2 * max(count, 1), TREE_NODE)
    order, made = np.zeros(count, np.int32), np.zeros(1, np.int64)
    _TREE(count, boxes, nodes, order, made)
    return nodes[: int(made[0])].copy(), order


def cover_texels(
    places: NDArray[np.float32], side: int, reach: float
) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
    """Find the triangle that each texel of a map stands for: the nearest within reach.

    Parameters
    ----------
    places : (T, 3, 2) float32
        Of the triangles' corners in the map, x then y [texels].
    side : int
        Of the map [texels].
    reach : float
        From a texel's centre [texels].

    Returns
    -------
    owner : (side, side) int32
        -1 where there is none.
    weights : (side, side, 2) float32
        Of the triangle's second and third corner, at its point nearest to the texel's centre.
    """
    checked("places", places, np.float32, (None, 3, 2))
    owner = np.full((side, side), -1, np.int32)
    weights = np.zeros((side, side, 2), np.float32)
    nearest = np.full((side, side), reach * reach, np.float32)
    _COVER(len(places), side, reach, places, owner, weights, nearest)
    return owner, weights
