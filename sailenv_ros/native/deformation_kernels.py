"""The kernels that move the vertices of surfaces: skinning, meshes, clusters and trees.

What they are for stands in `types.deformation`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import checked
from sailenv_ros.native.ray_types import TREE_NODE, WIDTH
from sailenv_ros.native.records import RecordKernel
from sailenv_ros.native.render_types import CLUSTER

__all__ = [
    "INFLUENCES",
    "bounding_sphere",
    "move_clusters",
    "move_mesh",
    "refit",
    "skin",
]

INFLUENCES = 4
"""Bones that move a vertex, at most."""

_SKIN = RecordKernel(
    "skin_vertices",
    ("integer", "count bone_count"),
    ("array", "positions normals bones weights matrices moved turned"),
)
_CLUSTERS = RecordKernel(
    "move_clusters",
    ("integer", "count corner_count index_count"),
    ("array", "corners indices clusters"),
)
_SPHERE = RecordKernel(
    "bounding_sphere",
    ("integer", "count stride"),
    ("array", "columns sphere"),
)
_MESH = RecordKernel(
    "move_mesh",
    ("integer", "vertex_count corner_count stride index_count cluster_count"),
    ("array", "positions normals sources indices columns vertices clusters sphere"),
)
_REFIT = RecordKernel(
    "refit_tree",
    ("integer", "nodes_count leaves triangles vertices"),
    ("array", "positions vertex_of order nodes corners blocks"),
)
Doubles = NDArray[np.float64]
Floats = NDArray[np.float32]


def skin(
    positions: Floats,
    normals: Floats,
    bones: NDArray[np.uint16],
    weights: Floats,
    matrices: Doubles,
    *,
    threads: int,
) -> tuple[Floats, Floats]:
    """Move vertices with bones, by linear blend skinning.

    Parameters
    ----------
    positions, normals : (V, 3) float32
        At rest.
    bones : (V, 4) uint16
    weights : (V, 4) float32
        Of these bones; their sum is 1.
    matrices : (B, 3, 4) float64
        Where each bone takes what is at rest.
    threads : int
        The result does not depend on it.

    Returns
    -------
    moved, turned : (V, 3) float32
        Positions and unit normals; fresh arrays.

    Raises
    ------
    InvalidRequest, NativeLibraryError
        If an array has another type or shape, or a bone is not there.
    """
    count = len(positions)
    moved, turned = np.empty((count, 3), np.float32), np.empty((count, 3), np.float32)
    _SKIN(
        threads,
        count=count,
        bone_count=len(matrices),
        positions=checked("positions", positions, np.float32, (None, 3)),
        normals=checked("normals", normals, np.float32, (count, 3)),
        bones=checked("bones", bones, np.uint16, (count, INFLUENCES)),
        weights=checked("weights", weights, np.float32, (count, INFLUENCES)),
        matrices=checked("matrices", matrices, np.float64, (None, 3, 4)),
        moved=moved,
        turned=turned,
    )
    return moved, turned


def move_clusters(corners: Floats, indices: NDArray[np.uint32], clusters: NDArray[np.void]) -> None:
    """Set the spheres and cones of clusters to where their corners are now.

    Parameters
    ----------
    corners : (K, 3) float32
    indices : (3 M,) uint32
        Of corners, in the order of the clusters.
    clusters : (C,) CLUSTER
        Changed in place.
    """
    _CLUSTERS(
        1,
        count=len(clusters),
        corner_count=len(corners),
        index_count=len(indices),
        corners=checked("corners", corners, np.float32, (None, 3)),
        indices=checked("indices", indices, np.uint32, (None,)),
        clusters=checked("clusters", clusters, CLUSTER, (None,)),
    )


def bounding_sphere(columns: Floats, count: int) -> Doubles:
    """Return centre and radius of a sphere around corners.

    Parameters
    ----------
    columns : (3, K) float32
        Coordinate by coordinate.
    count : int
        How many of them are corners; the others are room for steps of several.

    Returns
    -------
    sphere : (4,) float64
        Zeros without corners. The radius is still enough where it is read in single precision.
    """
    checked("columns", columns, np.float32, (3, None))
    sphere = np.empty(4)
    _SPHERE(1, count=count, stride=columns.shape[1], columns=columns, sphere=sphere)
    return sphere


def move_mesh(
    positions: Floats,
    normals: Floats,
    sources: NDArray[np.uint32],
    indices: NDArray[np.uint32],
    columns: Floats,
    vertices: Floats,
    clusters: NDArray[np.void],
) -> Doubles:
    """Let a mesh, as it is drawn, take the vertices of an instant.

    Parameters
    ----------
    positions, normals : (V, 3) float32
    sources : (K,) uint32
        A vertex of each corner.
    indices : (3 M,) uint32
        Of corners, in the order of the clusters.
    columns : (3, K or more) float32
        Takes the corners, coordinate by coordinate.
    vertices : (V, 8) float32
        Takes the normals, as its first three.
    clusters : (C,) CLUSTER
        Changed in place.

    Returns
    -------
    sphere : (4,) float64
        As `bounding_sphere`.
    """
    count = len(positions)
    sphere = np.empty(4)
    _MESH(
        1,
        vertex_count=count,
        corner_count=len(sources),
        stride=checked("columns", columns, np.float32, (3, None)).shape[1],
        index_count=len(indices),
        cluster_count=len(clusters),
        positions=checked("positions", positions, np.float32, (None, 3)),
        normals=checked("normals", normals, np.float32, (count, 3)),
        sources=checked("sources", sources, np.uint32, (None,)),
        indices=checked("indices", indices, np.uint32, (None,)),
        columns=columns,
        vertices=checked("vertices", vertices, np.float32, (count, 8)),
        clusters=checked("clusters", clusters, CLUSTER, (None,)),
        sphere=sphere,
    )
    return sphere


def refit(
    positions: Floats,
    vertex_of: NDArray[np.uint32],
    order: NDArray[np.int32],
    nodes: NDArray[np.void],
) -> tuple[NDArray[np.void], Doubles, Doubles]:
    """Fit a tree around triangles whose corners have moved.

    Parameters
    ----------
    positions : (V, 3) float32
    vertex_of : (T, 3) uint32
    order : (L, 8) int32
    nodes : (N,) TREE_NODE
        Of the tree that was built for other positions.

    Returns
    -------
    nodes : (N,) TREE_NODE
    corners : (T, 3, 3) float64
        Of the triangles.
    blocks : (L, 9, 8) float64
        What `RayShape::triangles` points to.
    """
    fitted = checked("nodes", nodes, TREE_NODE, (None,)).copy()
    corners = np.empty((len(vertex_of), 3, 3))
    blocks = np.empty((len(order), 9, WIDTH))
    _REFIT(
        1,
        nodes_count=len(fitted),
        leaves=len(order),
        triangles=len(vertex_of),
        vertices=len(positions),
        positions=checked("positions", positions, np.float32, (None, 3)),
        vertex_of=checked("corners of triangles", vertex_of, np.uint32, (None, 3)),
        order=checked("order", order, np.int32, (None, WIDTH)),
        nodes=fitted,
        corners=corners,
        blocks=blocks,
    )
    return fitted, corners, blocks
