"""The floor plan that a room is furnished in: walls, what stands where, where one can walk.

Boxes that are turned about the vertical in, yes or no out. Knows no rules and no assets.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label

__all__ = [
    "BODY_RADIUS_M",
    "CELL_M",
    "Approach",
    "Area",
    "Block",
    "RoomPlan",
    "WallGap",
    "WallSide",
]

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

CELL_M = 0.05
BODY_RADIUS_M = 0.28
"""Radius of the walking agent: half of the narrowest passage [m]."""

_HEAD_M = 1.9
_BESIDE_M = 0.1
"""From the middle of a body to the floor that it is said to be on [m]."""

_STEP_M = 0.05
"""Greatest height of an obstacle that one can step over [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """A box that is turned about the vertical.

    Attributes
    ----------
    x, y : float
        Its middle [m].
    half_x, half_y : float
        Half its size along its own axes [m].
    yaw_rad : float
        Counter-clockwise.
    low, high : float
        Height of its lower and its upper side [m].
    """

    x: float
    y: float
    half_x: float
    half_y: float
    yaw_rad: float = 0.0
    low: float = 0.0
    high: float = _HEAD_M

    def axes(self) -> Floats:
        """Return (2, 2): its own x and y axis as rows."""
        c, s = math.cos(self.yaw_rad), math.sin(self.yaw_rad)
        return np.array([[c, s], [-s, c]])

    def corners(self) -> Floats:
        """Return (4, 2): its corners from above [m]."""
        signs = np.array([[1.0, 1.0], [1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0]])
        offsets: Floats = signs * (self.half_x, self.half_y) @ self.axes() + (self.x, self.y)
        return offsets

    def meets(self, other: Block, margin_m: float = 0.0) -> bool:
        """Return whether two boxes are nearer than a margin in the plane, at heights both have."""
        if self.low >= other.high or other.low >= self.high:
            return False
        reach = math.hypot(self.half_x, self.half_y) + math.hypot(other.half_x, other.half_y)
        if math.hypot(self.x - other.x, self.y - other.y) > reach + margin_m:
            return False
        # The axis of a separating line is one of the boxes' own (separating axis theorem).
        mine, its = self.corners(), other.corners()
        for axis in (*self.axes(), *other.axes()):
            a, b = mine @ axis, its @ axis
            if a.max() + margin_m <= b.min() or b.max() + margin_m <= a.min():
                return False
        return True

    def distance_m(self, points: Floats) -> Floats:
        """Return how far points (..., 2) lie from it in the plane; 0 inside [m]."""
        local = np.abs((points - (self.x, self.y)) @ self.axes().T)
        over = np.maximum(local - (self.half_x, self.half_y), 0.0)
        return np.asarray(np.hypot(over[..., 0], over[..., 1]))


Approach: TypeAlias = tuple[Block, ...]
"""Floor before and beside a piece of furniture: one must be able to walk to one of these."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WallGap:
    """An opening in a wall, seen from one side: its ends along it, its lower and upper edge [m]."""

    along: tuple[float, float]
    up: tuple[float, float]
    kind: str
    curtains: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class WallSide:
    """One side of a wall, as the room before it sees it.

    Attributes
    ----------
    wall : str
        Name of an outer wall, or empty for one between rooms.
    start, end : (2,) tuple of float
        Its ends [m]; outer walls run along +x or +y.
    inward : (2,) tuple of float
        Unit normal into the room.
    holes : tuple of WallGap
        Counted from `start`.
    """

    wall: str
    start: tuple[float, float]
    end: tuple[float, float]
    inward: tuple[float, float]
    holes: tuple[WallGap, ...] = ()

    @property
    def length_m(self) -> float:
        """Its length [m]."""
        return math.dist(self.start, self.end)

    @property
    def yaw_deg(self) -> float:
        """Turn of what stands with its back to it."""
        return math.degrees(math.atan2(self.inward[1], self.inward[0]))

    def point(self, along_m: float, out_m: float = 0.0) -> tuple[float, float]:
        """Return the place so far along it and away from it."""
        share = along_m / self.length_m
        x = self.start[0] + share * (self.end[0] - self.start[0]) + out_m * self.inward[0]
        y = self.start[1] + share * (self.end[1] - self.start[1]) + out_m * self.inward[1]
        return x, y


@dataclass(frozen=True, slots=True, kw_only=True)
class Area:
    """A room of the plan: a rectangle, of which a corner may be cut out.

    Attributes
    ----------
    name : str
        Empty where there is but one.
    kind : str
    low, high : (2,) tuple of float
        Opposite corners [m].
    height : float
        Of its ceiling [m].
    walls : tuple of WallSide
    cut : Block or None
        The corner that does not belong to it.
    """

    name: str
    kind: str
    low: tuple[float, float]
    high: tuple[float, float]
    height: float
    walls: tuple[WallSide, ...]
    cut: Block | None = None

    @property
    def middle(self) -> tuple[float, float]:
        """Middle of the rectangle [m]."""
        return (self.low[0] + self.high[0]) / 2.0, (self.low[1] + self.high[1]) / 2.0

    @property
    def size(self) -> tuple[float, float]:
        """Of the rectangle [m]."""
        return self.high[0] - self.low[0], self.high[1] - self.low[1]

    @property
    def floor_m2(self) -> float:
        """Area of its floor."""
        cut = 0.0 if self.cut is None else 4.0 * self.cut.half_x * self.cut.half_y
        return self.size[0] * self.size[1] - cut

    def holds(self, block: Block, margin_m: float = 0.0) -> bool:
        """Return whether a box lies inside, so far from all walls."""
        corners = block.corners()
        low, high = np.asarray(self.low) + margin_m, np.asarray(self.high) - margin_m
        inside = bool((corners >= low - 1e-9).all() and (corners <= high + 1e-9).all())
        return inside and not (self.cut is not None and block.meets(self.cut, margin_m))


@dataclass(slots=True)
class RoomPlan:
    """Plan of a room: occupied places, and the floor on which one can still walk.

    Parameters
    ----------
    areas : sequence of Area
    doors : sequence of (2,) tuple of float
        Places before doors and windows that one must be able to walk between [m].
    walls : iterable of Block
        Walls between the rooms, and corners that are cut out.
    """

    areas: Sequence[Area]
    doors: Sequence[tuple[float, float]]
    walls: Iterable[Block] = ()
    solid: list[Block] = field(default_factory=list)
    clear: list[Block] = field(default_factory=list)
    approaches: list[Approach] = field(default_factory=list)
    _blocked: Flags = field(init=False)
    _points: Floats = field(init=False)
    _origin: Floats = field(init=False)

    def __post_init__(self) -> None:
        low = np.min([area.low for area in self.areas], axis=0)
        high = np.max([area.high for area in self.areas], axis=0)
        counts = np.round((high - low) / CELL_M).astype(int)
        axes = [low[k] + CELL_M * (np.arange(counts[k]) + 0.5) for k in range(2)]
        self._origin = low
        self._points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
        self._blocked = (np.minimum(self._points - low, high - self._points) < BODY_RADIUS_M).any(
            axis=-1
        )
        for wall in self.walls:
            self._blocked |= wall.distance_m(self._points) < BODY_RADIUS_M

    def is_free(self, block: Block, margin_m: float = 0.01, ignored: Sequence[Block] = ()) -> bool:
        """Return whether a box meets nothing that stands, and no floor that is to stay free."""
        others = [other for other in (*self.solid, *self.clear) if other not in ignored]
        return not any(block.meets(other, margin_m) for other in others)

    def is_empty(self, block: Block) -> bool:
        """Return whether nothing stands where a box is; floor that stays free may be shared."""
        return not any(block.meets(other) for other in self.solid)

    def connects(self, more: Iterable[Block], approaches: Iterable[Approach] = ()) -> bool:
        """Return whether one can walk between all doors, and to each piece, with more in the way.

        Parameters
        ----------
        more : iterable of Block
        approaches : iterable of Approach
            Of more pieces.
        """
        walkable = self.walkable(more)
        if walkable is None:
            return False
        points = self._points[walkable]
        return all(
            any((floor.distance_m(points) < _BESIDE_M).any() for floor in of_one)
            for of_one in (*self.approaches, *approaches)
        )

    def walkable(self, more: Iterable[Block] = (), wider_m: float = 0.0) -> Flags | None:
        """Return (X, Y): where one can walk to from the doors; None if they are not connected."""
        blocked = self._blocked.copy()
        for block in more:
            _block_out(blocked, self._points, block, BODY_RADIUS_M + wider_m)
        parts, _ = label(~blocked)
        at = {int(parts[self.cell(door)]) for door in self.doors}
        if len(at) != 1 or 0 in at:
            return None
        return np.asarray(parts == at.pop())

    def cell(self, point: tuple[float, float]) -> tuple[int, int]:
        """Return the cell that a point lies in."""
        index = np.floor((np.asarray(point) - self._origin) / CELL_M).astype(int)
        index = np.clip(index, 0, np.array(self._blocked.shape) - 1)
        return int(index[0]), int(index[1])

    def centre(self, cell: Sequence[int]) -> tuple[float, float]:
        """Return the middle of a cell [m]."""
        x, y = self._points[cell[0], cell[1]]
        return float(x), float(y)

    @property
    def points(self) -> Floats:
        """(X, Y, 2): the middles of all cells [m]."""
        return self._points

    def clearance_m(self, blocks: Iterable[Block]) -> Floats:
        """Return (X, Y): how far each cell is from walls and from boxes [m]."""
        low, high = self._points[0, 0] - CELL_M / 2.0, self._points[-1, -1] + CELL_M / 2.0
        least = np.minimum(self._points - low, high - self._points).min(axis=-1)
        for block in (*self.walls, *blocks):
            least = np.minimum(least, block.distance_m(self._points))
        return np.asarray(least)

    def stand(
        self,
        blocks: Iterable[Block],
        clear: Iterable[Block] = (),
        approaches: Iterable[Approach] = (),
    ) -> None:
        """Put boxes into the plan, floor that stays free, and ways to come to pieces."""
        for block in blocks:
            self.solid.append(block)
            _block_out(self._blocked, self._points, block, BODY_RADIUS_M)
        self.clear.extend(clear)
        self.approaches.extend(approaches)


def _block_out(blocked: Flags, points: Floats, block: Block, radius_m: float) -> None:
    if block.low < _HEAD_M and block.high > _STEP_M:
        blocked |= block.distance_m(points) < radius_m
