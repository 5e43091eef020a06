"""Models as rays meet them. From `Model` to structures of `native.ray_types`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.masks import is_mostly_there
from sailenv_ros.native.ray_tracing import build_box_tree
from sailenv_ros.native.ray_types import RAY_SHAPE
from sailenv_ros.native.render_types import address, record
from sailenv_ros.types.baked_light import Unwrapping
from sailenv_ros.types.model import Model

__all__ = ["Shape", "shape_of", "tree_over"]

Floats = NDArray[np.float32]


@dataclass(frozen=True, eq=False, slots=True)
class Shape:
    """The opaque surface of a model at one scale, and what its `record` points to.

    Attributes
    ----------
    record : (1,) RAY_SHAPE
    centre : (3,) float64
        Of a ball around it, in the body frame [m].
    radius : float
        [m].
    """

    record: NDArray[np.void]
    centre: NDArray[np.float64]
    radius: float
    kept: tuple[NDArray[np.generic], ...]


def tree_over(triangles: Floats) -> tuple[NDArray[np.void], NDArray[np.int32]]:
    """Return a tree over (T, 3, 3) float32 triangles, and their order in it."""
    boxes = np.concatenate([triangles.min(axis=1), triangles.max(axis=1)], axis=1)
    return build_box_tree(np.ascontiguousarray(boxes, np.float32))


def shape_of(
    model: Model, scale: tuple[float, float, float], unwrapping: Unwrapping | None
) -> Shape:
    """Make a model ready for rays; glass, and what a mask leaves mostly open, is left out."""
    corners, places, sides = [], [], []
    for number, part in enumerate(model.parts):
        mesh, look = part.mesh, part.material
        solid = np.full(len(mesh.triangles), look.alpha != "blend")
        if look.alpha == "mask":
            solid &= is_mostly_there(look, mesh.uvs[mesh.triangles])
        corners.append(mesh.positions[mesh.triangles][solid])
        sides.append(np.full(int(solid.sum()), look.double_sided, np.uint8))
        if unwrapping is not None:
            flat = unwrapping.uvs[number][unwrapping.triangles[number]]
            places.append(flat[solid])
    triangles = np.concatenate([np.zeros((0, 3, 3), np.float32), *corners])
    triangles = (triangles * np.asarray(scale)).astype(np.float32)
    two_sided = np.concatenate([np.zeros(0, np.uint8), *sides])
    chart = np.concatenate([np.zeros((0, 3, 2), np.float32), *places])
    count = len(triangles)
    if not count:
        return Shape(record(RAY_SHAPE), np.zeros(3), 0.0, ())
    if np.prod(scale) < 0.0:
        # A mirrored model's triangles run the other way round.
        triangles, chart = triangles[:, [0, 2, 1]], chart[:, [0, 2, 1]] if len(chart) else chart
    nodes, order = tree_over(triangles)
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    triangles = triangles[order]
    edges = np.concatenate(
        [triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]],
        axis=1,
    )
    kept = (
        nodes,
        np.ascontiguousarray(edges, np.float32),
        np.ascontiguousarray(chart[order].reshape(count, 6)) if len(chart) else None,
        np.ascontiguousarray(two_sided[order]),
    )
    made = record(
        RAY_SHAPE,
        nodes_at=address(kept[0]),
        triangles_at=address(kept[1]),
        places_at=address(kept[2]),
        two_sided_at=address(kept[3]),
        count=count,
    )
    centre = (low.astype(np.float64) + high) / 2.0
    far = np.linalg.norm(triangles.reshape(-1, 3) - centre, axis=1).max()
    return Shape(made, centre, float(far), tuple(a for a in kept if a is not None))
