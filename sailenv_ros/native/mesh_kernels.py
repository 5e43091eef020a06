"""Meshes in the order in which they are drawn: clusters of triangles, and corners by their places.

Clusters are small groups of neighbouring triangles that face alike; see
src/kernels/mesh_clusters.cpp.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import checked
from sailenv_ros.native.records import RecordKernel
from sailenv_ros.native.render_types import CLUSTER

__all__ = ["CLUSTER_TRIANGLES", "clusters_of", "corners_of"]

CLUSTER_TRIANGLES = 32
"""Triangles of a cluster, at most; as in src/kernels/render_types.h."""

_SIDES = 6
"""Of a cube: triangles of a cluster face the same one."""

_TRIANGLES = RecordKernel(
    "order_triangles",
    ("integer", "vertex_count triangle_count room"),
    ("array", "positions triangles ordered clusters made"),
)
_CORNERS = RecordKernel(
    "number_corners",
    ("integer", "vertex_count index_count room"),
    ("array", "positions indices corners numbers made"),
)


def clusters_of(
    positions: NDArray[np.float32], triangles: NDArray[np.uint32]
) -> tuple[NDArray[np.uint32], NDArray[np.void]]:
    """Order a mesh's triangles by cluster.

    Parameters
    ----------
    positions : (V, 3) float32
        In the object's frame [m].
    triangles : (M, 3) uint32
        Counter-clockwise as seen from in front.

    Returns
    -------
    triangles : (M, 3) uint32
        The same in another order.
    clusters : (C,) CLUSTER
    """
    count = len(triangles)
    clusters = np.zeros(count // CLUSTER_TRIANGLES + _SIDES, CLUSTER)
    ordered, made = np.empty((count, 3), np.uint32), np.zeros(1, np.int64)
    _TRIANGLES(
        1,
        vertex_count=len(positions),
        triangle_count=count,
        room=len(clusters),
        positions=_dense_positions(positions),
        triangles=checked("triangles", triangles, np.uint32, (None, 3)),
        ordered=ordered,
        clusters=clusters,
        made=made,
    )
    return ordered, clusters[: int(made[0])].copy()


def corners_of(
    positions: NDArray[np.float32], triangles: NDArray[np.uint32]
) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Return each place that triangles use a number, in the order in which they do.

    Parameters
    ----------
    positions : (V, 3) float32
    triangles : (M, 3) uint32

    Returns
    -------
    corners : (K, 3) float32
        Places, each once, bit for bit.
    triangles : (M, 3) uint32
        The same triangles of corners.
    """
    corners = np.empty((min(len(positions), triangles.size), 3), np.float32)
    numbers, made = np.empty(triangles.shape, np.uint32), np.zeros(1, np.int64)
    _CORNERS(
        1,
        vertex_count=len(positions),
        index_count=triangles.size,
        room=len(corners),
        positions=_dense_positions(positions),
        indices=checked("triangles", triangles, np.uint32, (None, 3)),
        corners=corners,
        numbers=numbers,
        made=made,
    )
    return corners[: int(made[0])].copy(), numbers


def _dense_positions(positions: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return positions without the gaps that columns of records have."""
    return checked("positions", np.ascontiguousarray(positions), np.float32, (None, 3))
