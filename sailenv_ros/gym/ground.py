"""Places upon the floor of a room: random ones, ones near objects, how far they are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.space.free_space import OCCUPIED, FreeSpace

__all__ = ["away_from", "cell_middles", "distance_at", "near_boxes", "random_cell", "way_length_m"]

Point = tuple[float, float, float]


def random_cell(
    space: FreeSpace, random: np.random.Generator, among: NDArray[np.bool_] | None = None
) -> Point:
    """Return the middle of a random free cell of the largest region, in the world [m].

    Parameters
    ----------
    among : (H, W) bool or None
        Cells that it is one of.
    """
    wanted = space.regions == 1
    cells = np.argwhere(wanted if among is None else wanted & among)
    row, column = cells[int(random.integers(len(cells)))].tolist()
    return space.position_of(row, column)


def cell_middles(space: FreeSpace) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return (1, W) and (H, 1): x and y of the middles of cells, in the world [m]."""
    height, width = space.cells.shape
    x = space.origin_m[0] + (np.arange(width) + 0.5) * space.resolution_m
    y = space.origin_m[1] + (np.arange(height) + 0.5) * space.resolution_m
    return x.astype(np.float64)[None], y.astype(np.float64)[:, None]


def away_from(space: FreeSpace, place: tuple[float, float], least_m: float) -> FreeSpace:
    """Return the map without the cells that are nearer to a place [m]."""
    x, y = cell_middles(space)
    cells = space.cells.copy()
    cells[np.hypot(x - place[0], y - place[1]) < least_m] = OCCUPIED
    cells.flags.writeable = False
    return replace(space, cells=cells)


def near_boxes(space: FreeSpace, boxes: NDArray[np.float64], most_m: float) -> NDArray[np.bool_]:
    """Return (H, W): the free cells of the largest region within a distance of boxes.

    Parameters
    ----------
    boxes : (N, 2, 3) float64
        Lowest and highest corners in the world; height does not count [m].
    most_m : float
    """
    x, y = cell_middles(space)
    near = np.zeros(space.cells.shape, bool)
    for low, high in boxes:
        aside = np.maximum(np.maximum(low[0] - x, x - high[0]), 0.0)
        along = np.maximum(np.maximum(low[1] - y, y - high[1]), 0.0)
        near |= np.hypot(aside, along) <= most_m
    return np.asarray(near & (space.regions == 1))


def distance_at(
    space: FreeSpace, distances_m: NDArray[np.float64], x_m: float, y_m: float
) -> float:
    """Return the entry of a table of distances (H, W) at a place [m]."""
    cell = space.cell_of((x_m, y_m))
    return float("inf") if cell is None else float(distances_m[cell])


def way_length_m(space: FreeSpace, start: Point, goal: Point) -> float:
    """Return the length of the shortest path between two places [m]; see `FreeSpace.path`."""
    corners = space.path(start, goal)
    return float(np.linalg.norm(np.diff(corners, axis=0), axis=1).sum())
