"""The kernels of surfaces that deform: skinning, clusters, trees, and points on the surface.

What they are for stands in `types.deformation`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import checked
from sailenv_ros.native.ray_types import RAY_SHAPE, TREE_NODE, WIDTH
from sailenv_ros.native.records import RecordKernel
from sailenv_ros.native.render_types import CLUSTER, address

__all__ = ["INFLUENCES", "DeformingSurface", "move_clusters", "refit", "skin", "surface_points"]

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
_REFIT = RecordKernel(
    "refit_tree",
    ("integer", "nodes_count leaves triangles vertices"),
    ("array", "positions vertex_of order nodes corners blocks"),
)
_SURFACE = RecordKernel(
    "surface_points",
    ("integer", "height width"),
    ("array", "points instance row_of_instance"),
    ("integer", "rows"),
    ("array", "shapes targets scales"),
    ("integer", "relative"),
    ("array", "found"),
)

Doubles = NDArray[np.float64]
Floats = NDArray[np.float32]


class DeformingSurface(NamedTuple):
    """The triangles of one instance, where they are in a picture and where they are looked for.

    Attributes
    ----------
    instance_id : int
    scale : (3,) tuple of float
        Of the model.
    shape : (1,) RAY_SHAPE
        As they are in the picture, with triangles in float64.
    present, target : (T, 3, 3) float64
        Their corners in the picture, and the corners that are wanted.
    """

    instance_id: int
    scale: tuple[float, float, float]
    shape: NDArray[np.void]
    present: Doubles
    target: Doubles


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


def surface_points(
    points: Floats,
    instance: NDArray[np.uint16],
    surfaces: Sequence[DeformingSurface],
    found: Floats,
    *,
    relative: bool,
    threads: int,
) -> None:
    """Find where the points of a picture are when the triangles that they lie on are elsewhere.

    Parameters
    ----------
    points : (H, W, 3) float32
        In each instance's own frame, scale included [m]; nan where nothing is known.
    instance : (H, W) uint16
    surfaces : sequence of DeformingSurface
        Other instances are left alone.
    found : (H, W, 3) float32
        Takes the places in the instance's own frame [m]; nan where no triangle is near.
    relative : bool
        True for how far they are from where they are in the picture.
    threads : int
    """
    height, width = instance.shape
    rows = np.zeros(65536, np.uint16)
    for number, surface in enumerate(surfaces):
        count = len(surface.present)
        checked("corners", surface.present, np.float64, (count, 3, 3))
        checked("wanted corners", surface.target, np.float64, (count, 3, 3))
        rows[surface.instance_id] = 1 + number
    shapes = np.concatenate([np.zeros(0, RAY_SHAPE), *(one.shape for one in surfaces)])
    targets = np.array(
        [(address(one.target), address(one.present)) for one in surfaces], np.uint64
    ).reshape(-1, 2)
    _SURFACE(
        threads,
        height=height,
        width=width,
        points=checked("points", points, np.float32, (height, width, 3)),
        instance=checked("instance", instance, np.uint16, (height, width)),
        row_of_instance=rows,
        rows=len(surfaces),
        shapes=shapes,
        targets=targets,
        scales=np.array([one.scale for one in surfaces], np.float64).reshape(-1, 3),
        relative=relative,
        found=checked("found", found, np.float32, (height, width, 3)),
    )
