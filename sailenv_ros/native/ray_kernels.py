"""The kernels of rays: trees of boxes, what rays meet exactly, and what rays of light meet."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.native.library import Kernel, checked
from sailenv_ros.native.ray_types import RAY_SHAPE, TREE_NODE, WIDTH
from sailenv_ros.native.records import RecordKernel

__all__ = [
    "BoxTree",
    "LightHits",
    "RayHits",
    "build_tree",
    "cast_rays",
    "light_hits",
    "light_share",
]

_BUILD = Kernel("build_tree", "iiaaaa")
_CAST = RecordKernel(
    "cast_rays",
    ("array", "nodes order model_from_world models shapes"),
    ("integer", "instances"),
    ("array", "origins directions nearest distance instance triangle weights"),
    ("integer", "count"),
)
_MEET = RecordKernel(
    "meet_light_rays",
    ("array", "solid origins directions triangle distance second third"),
    ("integer", "count"),
)
_PASS = RecordKernel(
    "pass_light_rays",
    ("array", "solid glass passes origins directions lengths share"),
    ("integer", "count"),
)

Doubles = NDArray[np.float64]
Floats = NDArray[np.float32]


class BoxTree(NamedTuple):
    """A tree of boxes.

    Attributes
    ----------
    nodes : (N,) TREE_NODE
        The first one holds all.
    order : (L, leaf) int32
        The things in each leaf; -1 for none.
    """

    nodes: NDArray[np.void]
    order: NDArray[np.int32]


class RayHits(NamedTuple):
    """First hit of each ray.

    Attributes
    ----------
    distance : (R,) float64
        In lengths of the direction; inf where it meets nothing.
    instance : (R,) int32
        Row of the instance; -1 for none.
    triangle : (R,) int64
        Counted on over the models; -1 for none.
    weights : (R, 2) float64
        Of the triangle's second and third corner.
    """

    distance: Doubles
    instance: NDArray[np.int32]
    triangle: NDArray[np.int64]
    weights: Doubles


class LightHits(NamedTuple):
    """First hit of each ray of light.

    Attributes
    ----------
    triangle : (R,) int32
        -1 for none.
    distance : (R,) float32
        In lengths of the direction; 1e30 where it meets nothing.
    second, third : (R,) float32
        Weights of the triangle's second and third corner.
    """

    triangle: NDArray[np.int32]
    distance: Floats
    second: Floats
    third: Floats


def build_tree(boxes: Doubles, leaf: int) -> BoxTree:
    """Build a tree over boxes.

    Parameters
    ----------
    boxes : (N, 6) float64
        Lowest and highest corner of each thing; finite.
    leaf : int
        The most things in a leaf, 1 to 8.

    Raises
    ------
    InvalidRequest
        If the array has another type or shape.
    NativeLibraryError
        If there is no library, or a number is not finite.
    """
    checked("boxes", boxes, np.float64, (None, 6))
    count = len(boxes)
    nodes = np.empty(max(count, 1), TREE_NODE)
    order, made = np.empty((count, leaf), np.int32), np.zeros(2, np.int64)
    _BUILD(count, leaf, boxes, nodes, order, made)
    return BoxTree(nodes[: int(made[0])].copy(), order[: int(made[1])].copy())


def cast_rays(
    shapes: NDArray[np.void],
    instances: tuple[BoxTree, Doubles, NDArray[np.int32]],
    origins: Doubles,
    directions: Doubles,
    nearest: Doubles,
    *,
    threads: int,
) -> RayHits:
    """Find what rays meet first, exactly: as without a tree, in double precision.

    A triangle is met up to 1e-9 beside its edges, in its own coordinates, and from behind only if
    it has two sides. Of equal distances the lower instance and the lower triangle win.

    Parameters
    ----------
    shapes : (S,) RAY_SHAPE
        Of the models, with triangles in float64.
    instances : tuple
        A tree over them with leaves of one, (I, 3, 4) float64 model_from_world of each, scale
        included, and (I,) int32, the number of its model.
    origins, directions : (R, 3) float64
        In the world, up to 1e30; directions of any length.
    nearest : (R,) float64
        Only what lies farther is met, in lengths of the direction; 0 or more.
    threads : int
        The result does not depend on it.

    Raises
    ------
    InvalidRequest
        If an array has another type or shape, or an instance has a model that there is not.
    NativeLibraryError
        If there is no library.
    """
    (nodes, order), model_from_world, models = instances
    rays, count = len(origins), len(model_from_world)
    checked("shapes", shapes, RAY_SHAPE, (None,))
    checked("nodes", nodes, TREE_NODE, (None,))
    checked("order", order, np.int32, (count, 1))
    checked("model_from_world", model_from_world, np.float64, (None, 3, 4))
    checked("models", models, np.int32, (count,))
    for name, array in (("origins", origins), ("directions", directions)):
        checked(name, array, np.float64, (rays, 3))
    checked("nearest", nearest, np.float64, (rays,))
    if not ((models >= 0) & (models < len(shapes))).all():
        raise InvalidRequest("models", models, "numbers of models")
    hits = RayHits(
        distance=np.empty(rays),
        instance=np.empty(rays, np.int32),
        triangle=np.empty(rays, np.int64),
        weights=np.empty((rays, 2)),
    )
    _CAST(
        threads,
        nodes=nodes,
        order=order,
        model_from_world=model_from_world,
        models=models,
        shapes=shapes,
        instances=count,
        origins=origins,
        directions=directions,
        nearest=nearest,
        count=rays,
        **hits._asdict(),
    )
    return hits


def light_hits(
    solid: NDArray[np.void], origins: Floats, directions: Floats, *, threads: int
) -> LightHits:
    """Find what rays of light meet first, from either side.

    Parameters
    ----------
    solid : (1,) RAY_SHAPE
        With triangles in float32.
    origins, directions : (R, 3) float32
        Directions of any length.
    """
    rays = len(origins)
    checked("origins", origins, np.float32, (rays, 3))
    checked("directions", directions, np.float32, (rays, 3))
    hits = LightHits(
        triangle=np.empty(rays, np.int32),
        distance=np.empty(rays, np.float32),
        second=np.empty(rays, np.float32),
        third=np.empty(rays, np.float32),
    )
    _MEET(
        threads,
        solid=solid,
        origins=origins,
        directions=directions,
        count=rays,
        **hits._asdict(),
    )
    return hits


def light_share(
    solid: NDArray[np.void] | None,
    glass: tuple[NDArray[np.void], Floats],
    origins: Floats,
    directions: Floats,
    lengths: Floats,
    *,
    threads: int,
) -> Floats:
    """Return (R,) float32: how much of the light is let through on the length of each ray.

    Of panes the nearest counts, once, however many faces it has.

    Parameters
    ----------
    solid : (1,) RAY_SHAPE or None
        What stops light; None where nothing solid is in the way.
    glass : tuple
        Panes, and (L, 8) float32, the share that each lets through in the order of the leaves.
    origins, directions : (R, 3) float32
    lengths : (R,) float32
        In lengths of the direction.
    """
    rays = len(origins)
    checked("origins", origins, np.float32, (rays, 3))
    checked("directions", directions, np.float32, (rays, 3))
    checked("lengths", lengths, np.float32, (rays,))
    checked("shares of panes", glass[1], np.float32, (None, WIDTH))
    share = np.empty(rays, np.float32)
    _PASS(
        threads,
        solid=solid,
        glass=glass[0],
        passes=glass[1],
        origins=origins,
        directions=directions,
        lengths=lengths,
        share=share,
        count=rays,
    )
    return share
