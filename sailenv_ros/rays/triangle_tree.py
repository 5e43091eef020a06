"""Triangles in a tree, ready for the kernels that follow rays. From corners to `TriangleTree`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.ray_kernels import build_tree
from sailenv_ros.native.ray_types import RAY_SHAPE, WIDTH
from sailenv_ros.native.render_types import Record, address, record

__all__ = ["TriangleTree", "in_leaves", "triangle_tree"]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class TriangleTree:
    """Triangles in the order of a tree's leaves.

    Attributes
    ----------
    record : (1,) RAY_SHAPE
        Keeps what it points to.
    nodes : (N,) TREE_NODE
    order : (L, 8) int32
        Which triangles each leaf holds; -1 for none.
    low, high : (3,) float64
        Corners of a box around all; zeros if there is nothing.
    """

    record: Record
    nodes: NDArray[np.void]
    order: NDArray[np.int32]
    low: NDArray[np.float64]
    high: NDArray[np.float64]


def triangle_tree(
    corners: NDArray[np.float32] | NDArray[np.float64],
    two_sided: NDArray[np.bool_] | None = None,
    places: NDArray[np.float32] | None = None,
) -> TriangleTree:
    """Build a tree.

    Parameters
    ----------
    corners : (T, 3, 3) float32 or float64
        Finite. Rays meet the triangles in the precision of this array.
    two_sided : (T,) bool or None
        Triangles whose back is met like their front; None for no such.
    places : (T, 3, 2) float32 or None
        Of the corners in the model's chart.

    Raises
    ------
    NativeLibraryError
        If there is no library, or a corner is not finite.
    """
    count = len(corners)
    boxes = np.concatenate([corners.min(axis=1), corners.max(axis=1)], axis=1)
    nodes, order = build_tree(np.ascontiguousarray(boxes, np.float64), WIDTH)
    edges = corners - corners[:, :1]
    edges[:, 0] = corners[:, 0]
    blocks = in_leaves(edges.reshape(count, 9), order).transpose(0, 2, 1)
    sides = np.zeros(count, np.bool_) if two_sided is None else two_sided
    kept = (
        nodes,
        np.ascontiguousarray(blocks),
        order,
        None if places is None else in_leaves(places.reshape(count, 6), order),
        in_leaves(sides.astype(np.uint8), order),
    )
    points = corners.reshape(-1, 3).astype(np.float64) if count else np.zeros((1, 3))
    made = record(
        RAY_SHAPE,
        kept,
        nodes_at=address(kept[0]),
        triangles_at=address(kept[1]),
        order_at=address(kept[2]),
        places_at=address(kept[3]),
        two_sided_at=address(kept[4]),
        count=count,
    )
    return TriangleTree(
        record=made,
        nodes=nodes,
        order=order,
        low=points.min(axis=0),
        high=points.max(axis=0),
    )


def in_leaves(values: NDArray[Any], order: NDArray[np.int32]) -> NDArray[Any]:
    """Return (L, 8, ...): values of (T, ...) triangles in the order of the leaves, 0 for none."""
    rows = np.concatenate([values, np.zeros((1, *values.shape[1:]), values.dtype)])
    return np.ascontiguousarray(rows[order])
