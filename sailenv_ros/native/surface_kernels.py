"""The kernel that follows the points of surfaces that deform; see `types.deformation`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.native.library import checked
from sailenv_ros.native.ray_types import RAY_SHAPE
from sailenv_ros.native.records import RecordKernel
from sailenv_ros.native.render_types import TRIANGLE_PLACE, address

__all__ = ["DeformingSurface", "SurfaceTree", "surface_points"]

_SURFACE = RecordKernel(
    "surface_points",
    ("integer", "height width"),
    ("array", "points instance places row_of_instance"),
    ("integer", "rows"),
    ("array", "shapes addresses vertex_counts scales"),
    ("integer", "relative"),
    ("array", "found"),
)

Floats = NDArray[np.float32]


class SurfaceTree(NamedTuple):
    """The triangles of a surface in a tree.

    Attributes
    ----------
    shape : (1,) RAY_SHAPE
        As they are in the picture, with triangles in float64.
    corners : (T, 3) uint32
        Vertices of each triangle.
    """

    shape: NDArray[np.void]
    corners: NDArray[np.uint32]


class DeformingSurface(NamedTuple):
    """The vertices of one instance, where they are in a picture and where they are looked for.

    Attributes
    ----------
    instance_id : int
    scale : (3,) tuple of float
        Of the model.
    present, target : (V, 3) float32
        In the picture, and as they are wanted; those of all parts, one part after another [m].
    tree : SurfaceTree or None
        Needed where it is not known which triangle each point is on.
    """

    instance_id: int
    scale: tuple[float, float, float]
    present: Floats
    target: Floats
    tree: SurfaceTree | None


def surface_points(
    points: Floats | None,
    instance: NDArray[np.uint16],
    surfaces: Sequence[DeformingSurface],
    found: Floats,
    *,
    relative: bool,
    threads: int,
    places: NDArray[np.void] | None = None,
) -> None:
    """Find where the points of a picture are when the triangles that they lie on are elsewhere.

    Parameters
    ----------
    points : (H, W, 3) float32, or None
        In each instance's own frame, scale included [m]; nan where nothing is known. None with
        `places` takes all for known.
    instance : (H, W) uint16
    surfaces : sequence of DeformingSurface
        Other instances are left alone.
    found : (H, W, 3) float32
        Takes the places in the instance's own frame [m]; nan where no triangle is near.
    relative : bool
        True for how far they are from where they are in the picture.
    threads : int
    places : (H, W) TRIANGLE_PLACE or None
        Where on its triangle each point is; None looks for it in the surfaces' trees.

    Raises
    ------
    InvalidRequest
        If an array has another type or shape, or neither places nor trees are there.
    """
    height, width = instance.shape
    rows = np.zeros(65536, np.uint16)
    trees = []
    if places is None:
        trees = [_tree_of(surface) for surface in surfaces]
    else:
        checked("places", places, TRIANGLE_PLACE, (height, width))
    if points is not None:
        checked("points", points, np.float32, (height, width, 3))
    for number, surface in enumerate(surfaces):
        count = len(surface.present)
        checked("vertices", surface.present, np.float32, (count, 3))
        checked("wanted vertices", surface.target, np.float32, (count, 3))
        rows[surface.instance_id] = 1 + number
    addresses = [
        (address(one.present), address(one.target), address(one.tree and one.tree.corners))
        for one in surfaces
    ]
    _SURFACE(
        threads,
        height=height,
        width=width,
        points=points,
        instance=checked("instance", instance, np.uint16, (height, width)),
        places=places,
        row_of_instance=rows,
        rows=len(surfaces),
        shapes=np.concatenate([np.zeros(0, RAY_SHAPE), *(tree.shape for tree in trees)]),
        addresses=np.array(addresses, np.uint64).reshape(-1, 3),
        vertex_counts=np.array([len(one.present) for one in surfaces], np.int64),
        scales=np.array([one.scale for one in surfaces], np.float64).reshape(-1, 3),
        relative=relative,
        found=checked("found", found, np.float32, (height, width, 3)),
    )


def _tree_of(surface: DeformingSurface) -> SurfaceTree:
    if surface.tree is None:
        raise InvalidRequest("surface", "no tree", "one with a tree, or places of all points")
    corners = checked("corners of triangles", surface.tree.corners, np.uint32, (None, 3))
    if len(corners) and int(corners.max()) >= len(surface.present):
        raise InvalidRequest("corner", int(corners.max()), f"less than {len(surface.present)}")
    return surface.tree
