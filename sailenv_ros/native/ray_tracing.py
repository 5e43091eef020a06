"""Trees for rays, by src/kernels/ray_tree.cpp."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import Kernel, checked
from sailenv_ros.native.ray_types import TREE_NODE

__all__ = ["build_box_tree"]

_TREE = Kernel("build_box_tree", "integer", "array", "array", "array", "array")


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
