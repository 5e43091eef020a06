"""The free space of a scene: a map of where a body can stand, and paths through it.

A plain value that can be sent and kept; `grid.map_free_space` makes it.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sailenv_ros.errors import InvalidRequest, InvalidState
from sailenv_ros.space.paths import GridGraph, straightened
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.validation import Bounds, check_bounds, checked_integer, vector

__all__ = ["BODY_LIMITS", "FREE", "OCCUPIED", "UNKNOWN", "BodySize", "FreeSpace"]

FREE, OCCUPIED, UNKNOWN = 0, 100, -1
"""Values of cells, those of nav_msgs/OccupancyGrid; unknown is where there is no floor."""

BODY_LIMITS: Mapping[str, Bounds] = {
    "height_m": Bounds(least=0.01, most=100.0, unit="m"),
    "radius_m": Bounds(least=0.0, most=10.0, unit="m"),
    "floor_m": Bounds(least=-1e4, most=1e4, unit="m"),
    "step_m": Bounds(least=0.0, most=100.0, unit="m"),
    "resolution_m": Bounds(least=0.005, most=1.0, unit="m"),
}
"""Bounds of each number of `BodySize`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BodySize:
    """The body whose free space is asked for: an upright cylinder upon a floor.

    Attributes
    ----------
    height_m, radius_m : float
        0.01 to 100; 0 to 10 [m].
    floor_m : float
        Height of the floor in the world [m].
    step_m : float
        What rises above the floor by no more is stepped over, 0 to the height [m].
    resolution_m : float
        Side of the map's cells, 0.005 to 1 [m].
    """

    height_m: float = 1.8
    radius_m: float = 0.25
    floor_m: float = 0.0
    step_m: float = 0.05
    resolution_m: float = 0.05

    def __post_init__(self) -> None:
        check_bounds(self, BODY_LIMITS)
        if self.step_m >= self.height_m:
            raise InvalidRequest("step_m", self.step_m, f"below the height, {self.height_m:g} m")


@dataclass(frozen=True, eq=False, kw_only=True)
class FreeSpace:
    """A map of where a body can stand.

    Attributes
    ----------
    cells : (H, W) int8
        Read-only: 0 free, 100 occupied, -1 no floor. Row 0 is that of the lowest y, column 0 that
        of the lowest x, as in nav_msgs/OccupancyGrid. A cell is free if the body touches nothing
        while its axis is at the cell's middle.
    origin_m : (2,) tuple of float
        x and y of the outer corner of cell [0, 0] in the world [m].
    body : BodySize
        Whose map it is; has the resolution and the floor's height.
    stamp_ns : int
        Simulated time of the poses that it was made of [ns].
    """

    cells: NDArray[np.int8]
    origin_m: tuple[float, float]
    body: BodySize
    stamp_ns: int = 0

    @property
    def resolution_m(self) -> float:
        """Side of a cell [m]."""
        return self.body.resolution_m

    @property
    def free(self) -> NDArray[np.bool_]:
        """(H, W) which cells are free."""
        return np.asarray(self.cells == FREE)

    @property
    def area_m2(self) -> float:
        """Area of all free cells [m²]."""
        return float(self.free.sum()) * self.resolution_m**2

    def cell_of(self, position: ArrayLike) -> tuple[int, int] | None:
        """Return row and column of the cell around x, y (and z, which is ignored) [m].

        None outside of the map.
        """
        x, y = _xy("position", position)
        column = (x - self.origin_m[0]) / self.resolution_m
        row = (y - self.origin_m[1]) / self.resolution_m
        height, width = self.cells.shape
        # Before rounding: what is too far away is infinitely many cells.
        inside = 0.0 <= row < height and 0.0 <= column < width
        return (math.floor(row), math.floor(column)) if inside else None

    def position_of(self, row: int, column: int) -> tuple[float, float, float]:
        """Return the middle of a cell upon the floor, in the world [m]."""
        x, y = self.origin_m
        side = self.resolution_m
        return x + (column + 0.5) * side, y + (row + 0.5) * side, self.body.floor_m

    def is_free(self, position: ArrayLike) -> bool:
        """Return whether a place [m] is in a free cell."""
        cell = self.cell_of(position)
        return cell is not None and bool(self.cells[cell] == FREE)

    @cached_property
    def clearance_m(self) -> NDArray[np.float32]:
        """(H, W) float32 read-only: how far the body is at least from what it would touch [m].

        To the middle of the nearest cell that is not free, less one cell; 0 where it is not free.
        """
        from scipy import ndimage

        far = ndimage.distance_transform_edt(np.pad(self.free, 1))[1:-1, 1:-1]
        result: NDArray[np.float32] = np.maximum(far - 1.0, 0.0).astype(np.float32)
        result *= np.float32(self.resolution_m)
        result.flags.writeable = False
        return result

    @cached_property
    def regions(self) -> NDArray[np.int32]:
        """(H, W) int32 read-only: number of the region that each free cell belongs to, else 0.

        From each cell of a region each other one can be reached. 1 is the largest.
        """
        from scipy import ndimage

        labels, count = ndimage.label(self.free)
        sizes = np.bincount(labels.reshape(-1), minlength=count + 1)[1:]
        order = np.zeros(count + 1, np.int32)
        order[1 + np.argsort(-sizes, kind="stable")] = 1 + np.arange(count)
        result: NDArray[np.int32] = order[labels]
        result.flags.writeable = False
        return result

    def reachable(self, start: ArrayLike, goal: ArrayLike) -> bool:
        """Return whether a body can walk from one place [m] to another."""
        cells = self.cell_of(start), self.cell_of(goal)
        if cells[0] is None or cells[1] is None:
            return False
        first, last = (int(self.regions[cell]) for cell in cells if cell is not None)
        return first == last != 0

    def distances_m(self, start: ArrayLike) -> NDArray[np.float64]:
        """Return (H, W) how far each cell is from a place on a path through free cells [m].

        Along rows, columns and diagonals; inf where no path leads.
        """
        distances, _ = self._graph.from_cell(self._free_cell("start", start))
        return distances * self.resolution_m

    def distances_to_m(self, goals: NDArray[np.bool_]) -> NDArray[np.float64]:
        """Return (H, W) how far each cell is from the nearest goal, as `distances_m` has it [m].

        Parameters
        ----------
        goals : (H, W) bool
            Those that are not free count for nothing.

        Raises
        ------
        InvalidRequest
            If no goal is in a free cell.
        """
        free = np.asarray(goals, bool) & self.free
        if not free.any():
            raise InvalidRequest("goals", "none", "at least one in a free cell")
        return self._graph.to_cells(free) * self.resolution_m

    def path(self, start: ArrayLike, goal: ArrayLike) -> NDArray[np.float64]:
        """Return the shortest path from one place to another.

        The shortest along rows, columns and diagonals of free cells, without cutting corners of
        others; then its corners are left out where the straight line stays in free cells.

        Parameters
        ----------
        start, goal : (2,) or (3,) array-like
            In free cells [m].

        Returns
        -------
        positions : (N, 3) float64
            Corners of the path on the floor, the start and the goal themselves included [m].

        Raises
        ------
        InvalidRequest
            If one of the places is not free, or no path joins them.
        """
        first, last = self._free_cell("start", start), self._free_cell("goal", goal)
        _, before = self._graph.from_cell(first)
        cells = self._graph.cells_between(first, last, before)
        if cells is None:
            raise InvalidRequest("goal", _shown(goal), f"reachable from the start, {_shown(start)}")
        side = self.resolution_m
        middles = np.array([(column + 0.5, row + 0.5) for row, column in cells])
        # In cells; the start and the goal themselves instead of the middles of theirs.
        ends = [(np.array(_xy("", end)) - self.origin_m) / side for end in (start, goal)]
        corners = straightened(np.array([ends[0], *middles[1:-1], ends[1]]), self.free)
        flat = corners * side + np.asarray(self.origin_m)
        flat[0], flat[-1] = _xy("start", start), _xy("goal", goal)
        return np.column_stack([flat, np.full(len(flat), self.body.floor_m)])

    def random_pose(
        self, name: str = "", *, seed: int = 0, reachable_from: ArrayLike | None = None
    ) -> Pose:
        """Return a random pose in free space; the same one for the same name and seed.

        Parameters
        ----------
        name : str
            What it is for: other names have other random numbers.
        seed : int
        reachable_from : (2,) or (3,) array-like or None
            A place from which a path leads to it [m]; None means the largest region.

        Returns
        -------
        pose : Pose
            In the middle of a cell upon the floor, turned about z alone.

        Raises
        ------
        InvalidRequest
            If `reachable_from` is not free.
        InvalidState
            If nothing is free.
        """
        region = 1
        if reachable_from is not None:
            region = int(self.regions[self._free_cell("reachable_from", reachable_from)])
        cells = np.argwhere(self.regions == region)
        if not len(cells):
            raise InvalidState(
                f"no place is free for a body of radius {self.body.radius_m:g} m; a smaller one "
                "may find one"
            )
        random = named_generator(seed, name)
        row, column = cells[int(random.integers(len(cells)))].tolist()
        yaw_deg = float(random.uniform(-180.0, 180.0))
        return Pose.from_rpy_deg(self.position_of(row, column), (0.0, 0.0, yaw_deg))

    @cached_property
    def _graph(self) -> GridGraph:
        return GridGraph(self.free)

    def _free_cell(self, what: str, position: ArrayLike) -> tuple[int, int]:
        cell = self.cell_of(position)
        if cell is None or self.cells[cell] != FREE:
            raise InvalidRequest(
                what,
                _shown(position),
                f"a place in free space, where a body of radius {self.body.radius_m:g} m and "
                f"height {self.body.height_m:g} m stands upon a floor and touches nothing",
            )
        return cell


def named_generator(seed: int, *names: str) -> np.random.Generator:
    """Return random numbers that depend on a seed and on names alone."""
    number = checked_integer("seed", seed, 0, 2**64 - 1)
    entropy = [number & 0xFFFFFFFF, number >> 32, *(zlib.crc32(name.encode()) for name in names)]
    return np.random.default_rng(np.random.SeedSequence(entropy))


def _xy(what: str, position: ArrayLike) -> tuple[float, float]:
    array = np.asarray(position)
    if array.shape == (2,):
        array = np.append(array, 0.0)
    x, y, _ = vector(what, array)
    return x, y


def _shown(position: ArrayLike) -> list[float]:
    return [round(float(value), 4) for value in np.asarray(position, np.float64)]
