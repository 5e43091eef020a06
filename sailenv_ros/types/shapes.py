"""Shapes that objects collide as, in the body frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.geometry import Pose

__all__ = [
    "BoxShape",
    "CollisionShape",
    "ConvexShape",
    "CylinderShape",
    "SphereShape",
    "TriangleShape",
    "box_corners",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class BoxShape:
    """A box; `centre_m` and `orientation_xyzw` in the body frame."""

    half_extents_m: tuple[float, float, float]
    centre_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    orientation_xyzw: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class SphereShape:
    """A ball; `centre_m` in the body frame."""

    radius_m: float
    centre_m: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class CylinderShape:
    """A cylinder along the body's z axis; `centre_m` in the body frame."""

    radius_m: float
    height_m: float
    centre_m: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ConvexShape:
    """The convex hull of points (N, 3) float64 in the body frame [m]."""

    points: NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class TriangleShape:
    """Triangles as they are; hollow, for static objects only.

    Attributes
    ----------
    positions : (N, 3) float64
        Vertices in the body frame [m].
    triangles : (M, 3) int32
    """

    positions: NDArray[np.float64]
    triangles: NDArray[np.int32]


_SIGNS = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])


def box_corners(shape: BoxShape) -> NDArray[np.float64]:
    """Return (8, 3) float64: the corners of a box in the body frame [m]."""
    turn = Pose(orientation_xyzw=shape.orientation_xyzw).matrix()[:3, :3]
    corners = _SIGNS * np.asarray(shape.half_extents_m)
    return np.asarray(corners @ turn.T + np.asarray(shape.centre_m))


CollisionShape: TypeAlias = BoxShape | SphereShape | CylinderShape | ConvexShape | TriangleShape
