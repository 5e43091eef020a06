"""Distances between convex solids, and boxes around collision shapes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.space.outlines import Solid
from sailenv_ros.types.model import (
    BoxShape,
    CollisionShape,
    ConvexShape,
    CylinderShape,
    SphereShape,
)
from sailenv_ros.types.shapes import box_corners

__all__ = ["MOST_CORNERS", "collision_box", "solid_distance_m", "solids_overlap"]

Doubles = NDArray[np.float64]

MOST_CORNERS = 256
"""Most corners of a solid that someone asks about: the effort grows with the pairs of corners."""

_TOUCHING_M = 1e-9


def solid_distance_m(first: Solid, second: Solid) -> float:
    """Return the distance between two convex solids; 0 where they touch or overlap [m].

    The point of a hull that is nearest to the origin, by non-negative least squares: the hull is
    that of all differences of corners (C. L. Lawson and R. J. Hanson, Solving Least Squares
    Problems, 1974, chapter 23: least distance programming).
    """
    from scipy.optimize import nnls

    differences = (first.points[:, None] - second.points[None]).reshape(-1, 3)
    size = float(np.abs(differences).max()) or 1.0
    system = np.vstack([differences.T / size, np.ones(len(differences))])
    weights, _ = nnls(system, np.array([0.0, 0.0, 0.0, 1.0]))
    between = float(np.linalg.norm(differences.T @ weights) / weights.sum())
    return max(0.0, between - first.radius_m - second.radius_m)


def solids_overlap(first: Solid, second: Solid) -> bool:
    """Return whether two convex solids touch or overlap."""
    low, high = first.points.min(axis=0), first.points.max(axis=0)
    other_low, other_high = second.points.min(axis=0), second.points.max(axis=0)
    reach = first.radius_m + second.radius_m + _TOUCHING_M
    if np.any(low - reach > other_high) or np.any(other_low - reach > high):
        return False
    return solid_distance_m(first, second) <= _TOUCHING_M


def collision_box(
    shapes: Sequence[CollisionShape], scale: Sequence[float]
) -> tuple[Doubles, Doubles] | None:
    """Return the lowest and the highest corner of the box around shapes, in their own frame [m].

    Parameters
    ----------
    shapes : sequence of CollisionShape
    scale : (3,) sequence of float
        Along their axes.

    Returns
    -------
    low, high : (3,) float64
        None if there are no shapes.
    """
    if not shapes:
        return None
    factors = np.asarray(scale, np.float64)
    boxes = np.array([_box_of(shape, factors) for shape in shapes])
    return boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)


def _box_of(shape: CollisionShape, factors: Doubles) -> tuple[Doubles, Doubles]:
    if isinstance(shape, SphereShape):
        # A ball stays one: it has the scale along x.
        half = np.full(3, shape.radius_m * factors[0])
        middle = np.asarray(shape.centre_m) * factors
    elif isinstance(shape, CylinderShape):
        half = np.array([shape.radius_m, shape.radius_m, 0.5 * shape.height_m]) * factors
        middle = np.asarray(shape.centre_m) * factors
    else:
        if isinstance(shape, BoxShape):
            points = box_corners(shape)
        else:
            points = shape.points if isinstance(shape, ConvexShape) else shape.positions
        points = points * factors
        return np.asarray(points.min(axis=0)), np.asarray(points.max(axis=0))
    return middle - half, middle + half
