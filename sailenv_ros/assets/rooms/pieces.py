"""Flat faces and boxes that rooms are built of, and the frame of a wall that they are set in.

Numbers in, `Mesh` and `BoxShape` out. Positions are in the axes of the world, relative to the
origin of the object that they belong to [m].
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sailenv_ros.assets.surfaces import Surface
from sailenv_ros.system.memory import cached_for_scenes
from sailenv_ros.types.model import BoxShape, Mesh

__all__ = ["Box", "Faces", "WallFrame", "boxes_mesh", "collision_of"]

Floats = NDArray[np.float64]
Vector3 = tuple[float, float, float]

_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, slots=True)
class Box:
    """A box along the axes; `low` and `high` are opposite corners [m]."""

    low: Vector3
    high: Vector3


@dataclass(frozen=True, slots=True, kw_only=True)
class WallFrame:
    """Frame of a wall's inner face; converts places on the wall to places in the room.

    Attributes
    ----------
    along : (3,) tuple of float
        Unit vector along the wall: +x of the walls to the north and south, else +y.
    outward : (3,) tuple of float
        Unit vector out of the room.
    middle_m : (3,) tuple of float
        Middle of the inner face's foot, in the world [m].
    length_m, height_m, thickness_m : float
        Of the inner face, and of the wall [m].
    overhang_m : float
        By which the wall runs on behind its neighbours at each end [m].
    """

    along: Vector3
    outward: Vector3
    middle_m: Vector3
    length_m: float
    height_m: float
    thickness_m: float
    overhang_m: float

    def point(self, along_m: float, out_m: float, up_m: float) -> Floats:
        """Return the place so far along the wall, out of the room and above the floor."""
        place: Floats = along_m * np.asarray(self.along) + out_m * np.asarray(self.outward)
        place[2] += up_m
        return place

    def box(self, along_m: Sequence[float], out_m: Sequence[float], up_m: Sequence[float]) -> Box:
        """Return the box between two numbers each."""
        ends = np.stack([self.point(*corner) for corner in zip(along_m, out_m, up_m, strict=True)])
        low, high = ends.min(axis=0).tolist(), ends.max(axis=0).tolist()
        return Box((low[0], low[1], low[2]), (high[0], high[1], high[2]))

    def world_point(self, along_m: float) -> Vector3:
        """Return a place at the foot of the inner face in the world [m]."""
        x, y, z = (np.asarray(self.middle_m) + self.point(along_m, 0.0, 0.0)).tolist()
        return x, y, z


@dataclass(slots=True)
class Faces:
    """Collects flat faces; each has a square of four vertices of its own."""

    _corners: list[Floats] = field(default_factory=list)
    _normals: list[Floats] = field(default_factory=list)

    def add(self, corner: ArrayLike, side: ArrayLike, other: ArrayLike, normal: ArrayLike) -> None:
        """Add the parallelogram of a corner and two sides that faces along the unit normal."""
        start, a, b = (np.asarray(v, dtype=np.float64) for v in (corner, side, other))
        facing = np.asarray(normal, dtype=np.float64)
        if _turns_away(a, b, facing):
            a, b = b, a
        self._corners.append(np.stack([start, start + a, start + a + b, start + b]))
        self._normals.append(facing)

    def polygon(self, corners: ArrayLike, normal: ArrayLike) -> None:
        """Add a face of three or four corners in any sense of turning."""
        points = np.asarray(corners, dtype=np.float64)
        facing = np.asarray(normal, dtype=np.float64)
        if _turns_away(points[1] - points[0], points[2] - points[0], facing):
            points = points[::-1]
        # A triangle is a square one of whose triangles is dropped.
        self._corners.append(points if len(points) == 4 else np.vstack([points, points[2:]]))
        self._normals.append(facing)

    def mesh(self, surface: Surface | None = None) -> Mesh:
        """Make the mesh; texture coordinates are metres, or the surface's where one is given."""
        corners, normals = np.stack(self._corners), np.stack(self._normals)
        # Sums in another order differ by a rounding; neighbours must share their vertices.
        positions = corners.reshape(-1, 3).round(9)
        spread = np.repeat(normals, 4, axis=0)
        places = _places(positions, spread)
        first = 4 * np.arange(len(corners))[:, np.newaxis, np.newaxis]
        triangles = (first + np.array([[0, 1, 2], [0, 2, 3]])).reshape(-1, 3)
        a, b, c = (positions[triangles[:, corner]] for corner in range(3))
        triangles = triangles[np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-12]
        return Mesh(
            positions=positions.astype(np.float32),
            normals=spread.astype(np.float32),
            uvs=places.astype(np.float32) if surface is None else surface.uvs(places),
            triangles=triangles.astype(np.uint32),
        )


def boxes_mesh(boxes: Iterable[Box], *, chamfer_m: float = 0.0) -> Mesh:
    """Make boxes, with broken edges if asked for.

    Edges that are narrower than a pixel glitter: only what is a feature of its own is broken.

    Parameters
    ----------
    boxes : iterable of Box
        At least one.
    chamfer_m : float
        Width of what is cut off; at most a third of a box's shortest side is [m].
    """
    return _boxes_mesh(tuple(boxes), chamfer_m)


@cached_for_scenes(256)
def _boxes_mesh(boxes: tuple[Box, ...], chamfer_m: float) -> Mesh:
    # Who paints a wall has all of the room made again, in which nothing else differs.
    faces = Faces()
    for box in boxes:
        _add_box(faces, box, chamfer_m)
    return faces.mesh()


def collision_of(box: Box) -> BoxShape:
    """Return the collision shape of a box."""
    low, high = np.asarray(box.low), np.asarray(box.high)
    hx, hy, hz = ((high - low) / 2.0).tolist()
    cx, cy, cz = ((high + low) / 2.0).tolist()
    return BoxShape(half_extents_m=(hx, hy, hz), centre_m=(cx, cy, cz))


def _add_box(faces: Faces, box: Box, chamfer_m: float) -> None:
    low, high = np.asarray(box.low), np.asarray(box.high)
    middle, half = (low + high) / 2.0, (high - low) / 2.0
    cut = min(chamfer_m, 2.0 / 3.0 * float(half.min()))
    axes = np.eye(3)

    def corner(axis: int, signs: Sequence[float]) -> Floats:
        """Return the corner of the face across an axis; it is drawn in along the other two."""
        place: Floats = middle + np.asarray(signs) * (half - cut * (1.0 - axes[axis]))
        return place

    for axis in range(3):
        second, third = (axis + 1) % 3, (axis + 2) % 3
        for sign in (-1.0, 1.0):
            around = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            signs = [_signs({axis: sign, second: s, third: t}) for s, t in around]
            faces.polygon([corner(axis, s) for s in signs], sign * axes[axis])
        for one, two in product((-1.0, 1.0), repeat=2) if cut else ():
            ends = [_signs({axis: one, second: two, third: s}) for s in (-1.0, 1.0)]
            edge = [corner(axis, ends[0]), corner(axis, ends[1])]
            edge += [corner(second, ends[1]), corner(second, ends[0])]
            faces.polygon(edge, (one * axes[axis] + two * axes[second]) / np.sqrt(2.0))
    for tip in product((-1.0, 1.0), repeat=3) if cut else ():
        faces.polygon([corner(axis, tip) for axis in range(3)], np.asarray(tip) / np.sqrt(3.0))


def _turns_away(one: Floats, other: Floats, facing: Floats) -> bool:
    """Tell whether two sides turn against a normal; plain numbers, as NumPy's cross is slow."""
    (a, b, c), (d, e, f), (x, y, z) = one.tolist(), other.tolist(), facing.tolist()
    return bool((b * f - c * e) * x + (c * d - a * f) * y + (a * e - b * d) * z < 0.0)


def _signs(by_axis: dict[int, float]) -> tuple[float, ...]:
    return tuple(by_axis[axis] for axis in range(3))


def _places(positions: Floats, normals: Floats) -> Floats:
    """Return (N, 2): how far to the right and up, as one sees who looks at the face [m]."""
    level = np.abs(normals[:, 2:]) > 0.999
    right = np.where(level, [1.0, 0.0, 0.0], np.cross(_UP, normals))
    right /= np.linalg.norm(right, axis=1, keepdims=True)
    up = np.cross(normals, right)
    return np.stack([(positions * right).sum(axis=1), (positions * up).sum(axis=1)], axis=1)
