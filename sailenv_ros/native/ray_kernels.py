"""The kernels of rays: trees over the triangles of models, and what rays through instances meet.

What they compute is defined in `tests.support.reference_rays`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.native.library import Kernel, checked

__all__ = ["RayHits", "RayModels", "TriangleTree", "build_tree", "cast_rays"]

_BUILD = Kernel("build_tree", "array", "integer", "array", "array", "array", "array")
_CAST = Kernel(
    "cast_rays",
    *("integer", "integer", "array", "array", "array", "integer", "array", "array"),
    *("array", "array", "array", "array", "array", "array", "array"),
    *("array", "array", "array", "array"),
)


class TriangleTree(NamedTuple):
    """A tree of boxes over triangles.

    Attributes
    ----------
    bounds : (K, 6) float64
        Lowest and highest corner of each node's box.
    children : (K, 2) int32
        Number of a node's first child, which its second follows, and 0; of a leaf the number of
        its first triangle in `order`, and how many there are.
    order : (M,) int32
        Triangles in the order of the leaves.
    """

    bounds: NDArray[np.float64]
    children: NDArray[np.int32]
    order: NDArray[np.int32]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class RayModels:
    """The triangles of several models, one after another, and their trees.

    Attributes
    ----------
    corners : (M, 3, 3) float64
        In each model's own frame; finite.
    two_sided : (M,) bool
        Triangles that are met from behind, too.
    first_triangle, first_node : (S + 1,) int64
        Where each model begins in `corners` and in `tree`, and where the last one ends.
    tree : TriangleTree
    """

    corners: NDArray[np.float64]
    two_sided: NDArray[np.bool_]
    first_triangle: NDArray[np.int64]
    first_node: NDArray[np.int64]
    tree: TriangleTree


class RayHits(NamedTuple):
    """First hit of each ray.

    Attributes
    ----------
    distance : (R,) float64
        In lengths of the direction; inf where it meets nothing.
    instance : (R,) int32
        Row of the instance; -1 for none.
    triangle : (R,) int64
        In `RayModels.corners`; -1 for none.
    weights : (R, 2) float64
        Of the triangle's second and third corner.
    """

    distance: NDArray[np.float64]
    instance: NDArray[np.int32]
    triangle: NDArray[np.int64]
    weights: NDArray[np.float64]


def build_tree(corners: NDArray[np.float64]) -> TriangleTree:
    """Build the tree of one model.

    Parameters
    ----------
    corners : (M, 3, 3) float64
        Finite; none gives a tree of one empty leaf.

    Raises
    ------
    InvalidRequest
        If the array has another type or shape.
    NativeLibraryError
        If there is no library, or a corner is not finite.
    """
    checked("corners", corners, np.float64, (None, 3, 3))
    count = len(corners)
    if not count:
        return TriangleTree(np.zeros((1, 6)), np.zeros((1, 2), np.int32), np.zeros(0, np.int32))
    bounds, children = np.empty((2 * count, 6)), np.empty((2 * count, 2), np.int32)
    order, nodes = np.empty(count, np.int32), np.zeros(1, np.int64)
    _BUILD(corners, count, bounds, children, order, nodes)
    used = int(nodes[0])
    return TriangleTree(bounds[:used].copy(), children[:used].copy(), order)


def cast_rays(
    models: RayModels,
    model_from_world: NDArray[np.float64],
    model_of_instance: NDArray[np.int32],
    origins: NDArray[np.float64],
    directions: NDArray[np.float64],
    nearest: NDArray[np.float64],
    *,
    threads: int,
) -> RayHits:
    """Find what rays meet first.

    Parameters
    ----------
    models : RayModels
    model_from_world : (I, 3, 4) float64
        Of each instance; scale included.
    model_of_instance : (I,) int32
        Number of each instance's model.
    origins, directions : (R, 3) float64
        In the world; directions of any length.
    nearest : (R,) float64
        Only what lies farther is met, in lengths of the direction.
    threads : int
        The result does not depend on it.

    Raises
    ------
    InvalidRequest
        If an array has another type or shape, or an instance has a model that there is not.
    NativeLibraryError
        If there is no library.
    """
    rays, instances = len(origins), len(model_from_world)
    checked("model_from_world", model_from_world, np.float64, (None, 3, 4))
    checked("model_of_instance", model_of_instance, np.int32, (instances,))
    for name, array in (("origins", origins), ("directions", directions)):
        checked(name, array, np.float64, (rays, 3))
    checked("nearest", nearest, np.float64, (rays,))
    checked("corners", models.corners, np.float64, (None, 3, 3))
    count = len(models.corners)
    checked("two_sided", models.two_sided, np.bool_, (count,))
    checked("order", models.tree.order, np.int32, (count,))
    checked("bounds", models.tree.bounds, np.float64, (None, 6))
    checked("children", models.tree.children, np.int32, (len(models.tree.bounds), 2))
    checked("first_triangle", models.first_triangle, np.int64, (None,))
    checked("first_node", models.first_node, np.int64, models.first_triangle.shape)
    known = (model_of_instance >= 0) & (model_of_instance < len(models.first_triangle) - 1)
    if not known.all():
        raise InvalidRequest("model_of_instance", model_of_instance, "numbers of models")
    hits = RayHits(
        distance=np.empty(rays),
        instance=np.empty(rays, np.int32),
        triangle=np.empty(rays, np.int64),
        weights=np.empty((rays, 2)),
    )
    _CAST(
        *(threads, rays, origins, directions, nearest, instances, model_from_world),
        *(model_of_instance, models.first_node, models.first_triangle),
        *(models.tree.bounds, models.tree.children, models.tree.order),
        *(models.corners, models.two_sided),
        *hits,
    )
    return hits
