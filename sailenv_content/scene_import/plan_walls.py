"""Walls of a drawn plan → solids with openings cut out of them.

Lines with a thickness in, meshes and convex pieces out. All in the world's axes: x east, y north, z
up [m]. Where walls are joined, their sides are cut along the line through their corners (a mitre).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.types.model import ConvexShape

__all__ = ["Opening", "PlanWall", "WallSolid", "wall_solid"]

Doubles = NDArray[np.float64]

LONGEST_MITRE = 3.0
"""Corners of joined walls reach beyond the lines' ends by so many thicknesses at most."""

PARALLEL = math.sin(math.radians(5.0))
"""Walls that continue nearly straight are not mitred."""

SMALLEST_M = 1e-3


@dataclass(eq=False, slots=True, kw_only=True)
class PlanWall:
    """A straight wall.

    Attributes
    ----------
    start, end : (2,) float64
        Of its middle line [m].
    thickness_m : float
    low_m : float
        Height of its foot [m].
    rise_m : (2,) tuple of float
        Of its top above the foot, at the start and at the end [m].
    before, after : PlanWall or None
        What it is joined to at its start and at its end.
    """

    start: Doubles
    end: Doubles
    thickness_m: float
    low_m: float
    rise_m: tuple[float, float]
    before: PlanWall | None = None
    after: PlanWall | None = None

    @property
    def length_m(self) -> float:
        """Of its middle line [m]."""
        return float(np.linalg.norm(self.end - self.start))

    @property
    def along(self) -> Doubles:
        """(2,) unit vector from start to end."""
        return (self.end - self.start) / max(self.length_m, SMALLEST_M)

    @property
    def left(self) -> Doubles:
        """(2,) unit vector to the left of who walks along it."""
        x, y = self.along
        return np.array([-y, x])


@dataclass(frozen=True, slots=True, kw_only=True)
class Opening:
    """A rectangle cut out of a wall: along it from its start, and in height from its foot [m]."""

    along_m: tuple[float, float]
    height_m: tuple[float, float]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class WallSolid:
    """A wall with its openings.

    Attributes
    ----------
    left, right, rest : RawMesh or None
        Its two sides, with u along it and v up [m], and its tops, ends and reveals.
    hulls : tuple of ConvexShape
        Upright prisms that fill it.
    """

    left: RawMesh
    right: RawMesh
    rest: RawMesh
    hulls: tuple[ConvexShape, ...]


def wall_solid(wall: PlanWall, openings: Sequence[Opening]) -> WallSolid | None:
    """Return a wall as a solid; None if nothing is left of it."""
    if wall.length_m < SMALLEST_M or wall.thickness_m < SMALLEST_M or max(wall.rise_m) <= 0.0:
        return None
    low_rise = min(wall.rise_m)
    clipped = (_clipped(opening, wall.length_m, low_rise) for opening in openings)
    cut = [opening for opening in clipped if opening is not None]
    breaks = _sorted({0.0, wall.length_m, *(edge for o in cut for edge in o.along_m)})
    heights = _sorted({0.0, low_rise, *(edge for o in cut for edge in o.height_m)})
    if heights[-1] < SMALLEST_M:
        heights = [0.0, max(wall.rise_m)]
    solid = np.ones((len(breaks) - 1, len(heights) - 1), np.bool_)
    for opening in cut:
        across = _between(breaks, opening.along_m)
        up = _between(heights, opening.height_m)
        solid[np.ix_(across, up)] = False
    faces = _Faces(wall, breaks, heights)
    return faces.solid(solid)


class _Faces:
    def __init__(self, wall: PlanWall, breaks: list[float], heights: list[float]) -> None:
        self._wall = wall
        self._breaks = breaks
        self._heights = heights
        middle = wall.start + np.outer(breaks, wall.along)
        half = 0.5 * wall.thickness_m * wall.left
        # (B, 2, 2): left and right point of each break; the ends are mitred.
        self._plan = np.stack([middle + half, middle - half], axis=1)
        self._plan[0] = _end_points(wall, wall.before, at_start=True)
        self._plan[-1] = _end_points(wall, wall.after, at_start=False)

    def solid(self, solid: NDArray[np.bool_]) -> WallSolid | None:
        if not solid.any():
            return None
        sides: list[list[Doubles]] = [[], []]
        rest: list[Doubles] = []
        hulls = []
        columns, rows = solid.shape
        for c in range(columns):
            for r in range(rows):
                if not solid[c, r]:
                    continue
                corners = np.array(
                    [
                        [[self._at(c + i, side, r + k) for k in (0, 1)] for side in (0, 1)]
                        for i in (0, 1)
                    ]
                )
                hulls.append(ConvexShape(points=corners.reshape(-1, 3)))
                start, end = corners
                # Each counter-clockwise from outside; [side, height].
                sides[0].append(np.array([end[0, 0], start[0, 0], start[0, 1], end[0, 1]]))
                sides[1].append(np.array([start[1, 0], end[1, 0], end[1, 1], start[1, 1]]))
                if c == 0 or not solid[c - 1, r]:
                    rest.append(np.array([start[0, 0], start[1, 0], start[1, 1], start[0, 1]]))
                if c == columns - 1 or not solid[c + 1, r]:
                    rest.append(np.array([end[1, 0], end[0, 0], end[0, 1], end[1, 1]]))
                if r == rows - 1 or not solid[c, r + 1]:
                    rest.append(np.array([start[0, 1], start[1, 1], end[1, 1], end[0, 1]]))
                if r == 0 or not solid[c, r - 1]:
                    rest.append(np.array([start[1, 0], start[0, 0], end[0, 0], end[1, 0]]))
        left, right = (self._mesh(quads) for quads in sides)
        return WallSolid(left=left, right=right, rest=self._mesh(rest), hulls=tuple(hulls))

    def _at(self, place: int, side: int, level: int) -> Doubles:
        x, y = self._plan[place, side]
        height = self._heights[level]
        if level == len(self._heights) - 1:
            share = self._breaks[place] / self._wall.length_m
            height = (1.0 - share) * self._wall.rise_m[0] + share * self._wall.rise_m[1]
        return np.array([x, y, self._wall.low_m + height])

    def _mesh(self, quads: Sequence[Doubles]) -> RawMesh:
        corners = np.concatenate(quads) if quads else np.zeros((0, 3))
        first = 4 * np.arange(len(quads))[:, None]
        halves = [first + np.array(half) for half in ((0, 1, 2), (0, 2, 3))]
        triangles = np.concatenate(halves)
        along = (corners[:, :2] - self._wall.start) @ self._wall.along
        return RawMesh(
            positions=corners,
            uvs=np.column_stack([along, corners[:, 2] - self._wall.low_m]),
            triangles=triangles.astype(np.int64),
        )


def _end_points(wall: PlanWall, joined: PlanWall | None, *, at_start: bool) -> Doubles:
    """Return (2, 2) the left and the right point of an end."""
    end = wall.start if at_start else wall.end
    half = 0.5 * wall.thickness_m * wall.left
    plain = np.stack([end + half, end - half])
    if joined is None or joined.length_m < SMALLEST_M:
        return plain
    # The other wall as it would be walked on, so that its left is on this one's left.
    same_way = (joined.after is wall) if at_start else (joined.before is wall)
    along, left = (1.0 if same_way else -1.0) * np.stack([joined.along, joined.left])
    cross = float(wall.along[0] * along[1] - wall.along[1] * along[0])
    if abs(cross) < PARALLEL:
        return plain
    corner = joined.end if (at_start == same_way) else joined.start
    offset = 0.5 * joined.thickness_m * left
    result = []
    for mine, other in zip(plain, (corner + offset, corner - offset), strict=True):
        gap = other - mine
        share = float(gap[0] * along[1] - gap[1] * along[0]) / cross
        longest = LONGEST_MITRE * max(wall.thickness_m, joined.thickness_m)
        if abs(share) > min(longest, wall.length_m):
            return plain
        result.append(mine + share * wall.along)
    return np.stack(result)


def _clipped(opening: Opening, length_m: float, rise_m: float) -> Opening | None:
    left, right = (min(max(edge, 0.0), length_m) for edge in opening.along_m)
    low, high = (min(max(edge, 0.0), rise_m) for edge in opening.height_m)
    if right - left < SMALLEST_M or high - low < SMALLEST_M:
        return None
    return Opening(along_m=(left, right), height_m=(low, high))


def _sorted(edges: set[float]) -> list[float]:
    """Return edges in order; of those that are nearly the same, one."""
    kept: list[float] = []
    last = max(edges)
    for edge in sorted(edges):
        if not kept or edge - kept[-1] > SMALLEST_M:
            kept.append(edge)
    kept[-1] = last
    return kept


def _between(edges: Sequence[float], limits: tuple[float, float]) -> list[int]:
    middles = [0.5 * (a + b) for a, b in itertools.pairwise(edges)]
    return [place for place, middle in enumerate(middles) if limits[0] < middle < limits[1]]
