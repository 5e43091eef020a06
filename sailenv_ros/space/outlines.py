"""Outlines of collision shapes on the ground: shapes in a band of heights → convex outlines.

The outline of a convex solid between two heights, seen from above, is the convex hull of its
corners between them and of the points where its edges cross them. The line between any two corners
lies inside the solid, so the edges need not be known.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.model import (
    BoxShape,
    CollisionShape,
    ConvexShape,
    CylinderShape,
    SphereShape,
    TriangleShape,
)
from sailenv_ros.types.shapes import box_corners

__all__ = ["Solid", "outlines_between", "solids_of"]

Doubles = NDArray[np.float64]

SIDES = 64
"""Sides of the polygon around a circle, which exceeds its radius by 0.12 % at most."""

_TURNS = 2.0 * np.pi * np.arange(SIDES) / SIDES
_CIRCLE = np.stack([np.cos(_TURNS), np.sin(_TURNS)], axis=-1) / np.cos(np.pi / SIDES)


class Solid:
    """A convex solid in the world: the hull of points, and a ball around each of them.

    Parameters
    ----------
    points : (N, 3) array-like of float64
        In the world [m].
    radius_m : float
        Of the ball around each point; 0 for none.
    """

    __slots__ = ("high_m", "low_m", "points", "radius_m")

    def __init__(self, points: Doubles, radius_m: float = 0.0) -> None:
        self.points = np.asarray(points, np.float64).reshape(-1, 3)
        self.radius_m = radius_m
        self.low_m = float(self.points[:, 2].min()) - radius_m
        self.high_m = float(self.points[:, 2].max()) + radius_m

    def outline(self, low_m: float, high_m: float) -> Doubles | None:
        """Return (K, 2) the corners of its outline between two heights; None if it is not there.

        Counter-clockwise; two points for what is seen edge-on.
        """
        if self.low_m >= high_m or self.high_m <= low_m:
            return None
        if self.radius_m:
            return self._ball(low_m, high_m)
        points = self.points
        if self.low_m < low_m:
            points = _above(points, low_m)
        if self.high_m > high_m:
            points = _above(points * (1.0, 1.0, -1.0), -high_m)
        return _hull(points[:, :2])

    def _ball(self, low_m: float, high_m: float) -> Doubles:
        x, y, z = self.points[0]
        off = max(0.0, low_m - z, z - high_m)
        return np.asarray(np.array((x, y)) + np.sqrt(self.radius_m**2 - off**2) * _CIRCLE)


def solids_of(
    shapes: Sequence[CollisionShape], scale: Sequence[float], world_from_body: Doubles
) -> Iterator[Solid]:
    """Yield the convex solids that collision shapes are in the world.

    Parameters
    ----------
    shapes : sequence of CollisionShape
    scale : (3,) sequence of float
        Along the body's axes.
    world_from_body : (4, 4) float64
        Rigid.
    """
    for shape in shapes:
        if isinstance(shape, SphereShape):
            centre = _moved(np.array([shape.centre_m]), scale, world_from_body)
            yield Solid(centre, shape.radius_m * float(scale[0]))
        elif isinstance(shape, TriangleShape):
            corners = _moved(shape.positions, scale, world_from_body)[shape.triangles]
            yield from (Solid(triangle) for triangle in corners)
        else:
            yield Solid(_moved(_points_of(shape), scale, world_from_body))


def outlines_between(solids: Iterable[Solid], low_m: float, high_m: float) -> list[Doubles]:
    """Return the outlines, each (K, 2), of what is between two heights."""
    found = (solid.outline(low_m, high_m) for solid in solids)
    return [outline for outline in found if outline is not None]


def _points_of(shape: BoxShape | CylinderShape | ConvexShape) -> Doubles:
    if isinstance(shape, ConvexShape):
        return shape.points
    if isinstance(shape, CylinderShape):
        ring = np.column_stack([shape.radius_m * _CIRCLE, np.zeros(SIDES)])
        half = np.array([0.0, 0.0, 0.5 * shape.height_m])
        return np.asarray(np.concatenate([ring - half, ring + half]) + shape.centre_m)
    return box_corners(shape)


def _moved(points: Doubles, scale: Sequence[float], matrix: Doubles) -> Doubles:
    return np.asarray((points * np.asarray(scale)) @ matrix[:3, :3].T + matrix[:3, 3])


def _above(points: Doubles, low_m: float) -> Doubles:
    """Return points whose hull is the part above a height of the hull of others."""
    up = points[:, 2] >= low_m
    above, below = points[up], points[~up]
    if not len(below):
        return points
    rise = above[:, None, 2] - below[None, :, 2]
    share = (low_m - below[None, :, 2]) / rise
    crossing = below[None] + share[..., None] * (above[:, None] - below[None])
    return np.concatenate([above, crossing.reshape(-1, 3)])


def _hull(points: Doubles) -> Doubles:
    """Return the corners of the convex hull of (N, 2) points, counter-clockwise."""
    from scipy.spatial import ConvexHull, QhullError

    if len(points) > 2:
        try:
            hull = ConvexHull(points)
        except QhullError:
            pass  # all on one line, or nearly so
        else:
            return np.asarray(points[hull.vertices])
    middle = points - points.mean(axis=0)
    along = middle @ np.linalg.svd(middle, full_matrices=False)[2][0]
    return np.asarray(points[[int(along.argmin()), int(along.argmax())]])
