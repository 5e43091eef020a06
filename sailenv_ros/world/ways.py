"""Ways over a map of free space: from place to place, round others who stand there."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.space.free_space import FREE, OCCUPIED, FreeSpace

__all__ = ["Disc", "Place", "nearest_cell", "way_between"]

Cell = tuple[int, int]
Place = tuple[float, float]

Disc = tuple[float, float, float]
"""A place that someone takes: x, y and a radius [m]."""

_NEAR_M = 0.9
"""How far from a free place one may stand or want to go [m]."""


def way_between(
    space: FreeSpace, start: Place, goal: Place, around: Iterable[Disc] = ()
) -> list[Place] | None:
    """Return the corners of a way between two places, or None.

    Places beside free space are joined to it by a straight line.

    Parameters
    ----------
    space : FreeSpace
    start, goal : (2,) tuple of float
        [m].
    around : iterable of Disc
        Where the middle of the body must neither pass nor end; it may begin there.
    """
    first, last = nearest_cell(space, start), nearest_cell(space, goal)
    taken = space
    for x, y, radius_m in around:
        taken = _without(taken, (x, y, radius_m))
        if np.hypot(x - goal[0], y - goal[1]) < radius_m:
            return None
    if first is None or last is None:
        return None
    first, last = (_out_of_others(space, taken, cell) for cell in (first, last))
    if first is None or last is None:
        return None
    begin, end = (space.position_of(*cell)[:2] for cell in (first, last))
    try:
        corners = taken.path(
            start if space.cell_of(start) == first else begin,
            goal if space.cell_of(goal) == last else end,
        )
    except InvalidRequest:
        return None
    found = [(float(x), float(y)) for x, y, _ in corners]
    if space.cell_of(start) != first:
        found.insert(0, start)
    if space.cell_of(goal) != last:
        found.append(goal)
    return found


def nearest_cell(space: FreeSpace, place: Place) -> Cell | None:
    """Return the free cell that is nearest to a place, if one is near."""
    cell = space.cell_of(place)
    if cell is not None and space.cells[cell] == FREE:
        return cell
    rows, columns = np.nonzero(space.cells == FREE)
    if not len(rows):
        return None
    side = space.resolution_m
    x = space.origin_m[0] + (columns + 0.5) * side - place[0]
    y = space.origin_m[1] + (rows + 0.5) * side - place[1]
    away = x * x + y * y
    number = int(away.argmin())
    if away[number] > _NEAR_M**2:
        return None
    return int(rows[number]), int(columns[number])


def _out_of_others(space: FreeSpace, taken: FreeSpace, cell: Cell) -> Cell | None:
    """Return the nearest cell that nobody takes, by a way that others may be on."""
    if taken.cells[cell] == FREE:
        return cell
    away = np.where(taken.free, space.distances_m(space.position_of(*cell)[:2]), np.inf)
    row, column = np.unravel_index(int(away.argmin()), away.shape)
    return (int(row), int(column)) if away[row, column] <= _NEAR_M else None


def _without(space: FreeSpace, disc: Disc) -> FreeSpace:
    """Return a map in which a disc is taken."""
    side, (x, y, radius_m) = space.resolution_m, disc
    height, width = space.cells.shape
    columns = space.origin_m[0] + (np.arange(width) + 0.5) * side - x
    rows = space.origin_m[1] + (np.arange(height) + 0.5) * side - y
    near: NDArray[np.bool_] = rows[:, None] ** 2 + columns[None] ** 2 < radius_m**2
    cells = np.where(near & (space.cells == FREE), OCCUPIED, space.cells).astype(np.int8)
    cells.flags.writeable = False
    return replace(space, cells=cells)
