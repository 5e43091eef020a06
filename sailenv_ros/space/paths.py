"""Ways through the cells of a grid: shortest ones, and straight lines where they fit."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

__all__ = ["GridGraph", "in_sight", "straightened"]

Cell = tuple[int, int]
Flags = NDArray[np.bool_]


class GridGraph:
    """Free cells, each joined to those of its eight neighbours that it can be left for.

    A diagonal step needs both cells beside it: corners are not cut.

    Parameters
    ----------
    free : (H, W) bool
    """

    def __init__(self, free: Flags) -> None:
        from scipy.sparse import csr_matrix

        self._shape = free.shape
        height, width = free.shape
        numbers = np.arange(free.size).reshape(free.shape)
        starts, ends, costs = [], [], []
        for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
            rows = slice(0, height - down), slice(down, height)
            left, end = (0, width - right) if right >= 0 else (1, width)
            columns = slice(left, end), slice(left + right, end + right)
            open_ = free[rows[0], columns[0]] & free[rows[1], columns[1]]
            if down and right:
                open_ = open_ & free[rows[0], columns[1]] & free[rows[1], columns[0]]
            starts.append(numbers[rows[0], columns[0]][open_])
            ends.append(numbers[rows[1], columns[1]][open_])
            costs.append(np.full(int(open_.sum()), math.hypot(down, right)))
        self._graph = csr_matrix(
            (np.concatenate(costs), (np.concatenate(starts), np.concatenate(ends))),
            shape=(free.size, free.size),
        )
        self.from_cell = lru_cache(maxsize=4)(self._from_cell)

    def cells_between(
        self, start: Cell, goal: Cell, before: NDArray[np.int32]
    ) -> list[Cell] | None:
        """Return the cells from one to another; None if no path joins them."""
        width = self._shape[1]
        first, at = start[0] * width + start[1], goal[0] * width + goal[1]
        cells = [at]
        while at != first:
            at = int(before[at])
            if at < 0:
                return None
            cells.append(at)
        return [divmod(cell, width) for cell in reversed(cells)]

    def to_cells(self, goals: Flags) -> NDArray[np.float64]:
        """Return (H, W) distances in cells from each cell to the nearest of the goals (H, W)."""
        from scipy.sparse.csgraph import dijkstra

        numbers = np.flatnonzero(goals)
        distances = dijkstra(self._graph, directed=False, indices=numbers, min_only=True)
        return np.asarray(distances).reshape(self._shape)

    def _from_cell(self, start: Cell) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        """Return (H, W) distances in cells, and (H·W,) the cell before each on the path to it."""
        from scipy.sparse.csgraph import dijkstra

        number = start[0] * self._shape[1] + start[1]
        distances, before = dijkstra(
            self._graph, directed=False, indices=number, return_predecessors=True
        )
        return distances.reshape(self._shape), before


def straightened(corners: NDArray[np.float64], free: Flags) -> NDArray[np.float64]:
    """Leave out corners of a path where the straight line past them stays in free cells.

    Parameters
    ----------
    corners : (N, 2) float64
        x and y in cells, from the outer corner of cell [0, 0].
    free : (H, W) bool
    """
    kept, at = [0], 0
    while at < len(corners) - 1:
        ahead = at + 1
        while ahead + 1 < len(corners) and in_sight(corners[at], corners[ahead + 1], free):
            ahead += 1
        kept.append(ahead)
        at = ahead
    return corners[kept] if len(corners) > 1 else np.concatenate([corners, corners])


def in_sight(start: NDArray[np.float64], end: NDArray[np.float64], free: Flags) -> bool:
    """Return whether all cells that a straight line touches are free."""
    (ax, ay), (bx, by) = sorted((tuple(start), tuple(end)))
    slope = (by - ay) / (bx - ax) if bx > ax else 0.0
    for column in range(math.floor(ax), math.floor(bx) + 1):
        if bx > ax:
            ends = [ay + (min(max(x, ax), bx) - ax) * slope for x in (column, column + 1)]
        else:
            ends = [ay, by]
        low, high = math.floor(min(ends) - 1e-9), math.floor(max(ends) + 1e-9)
        if low < 0 or high >= free.shape[0] or not free[low : high + 1, column].all():
            return False
    return True
