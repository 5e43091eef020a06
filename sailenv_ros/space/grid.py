"""Occupancy grids: what a body of a height and a radius would touch at each place.

Convex outlines in, cells out: the distance of a cell's middle from an outline is exact, so the
body, an upright cylinder, is not approximated by squares.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.space.free_space import FREE, OCCUPIED, UNKNOWN, BodySize, FreeSpace
from sailenv_ros.space.outlines import Solid, outlines_between

__all__ = ["MOST_CELLS", "map_free_space"]

Doubles = NDArray[np.float64]

LARGEST_FLOOR_M = 40.0
"""Side of a floor that is shown whole; of a larger one, what is near obstacles [m]."""

MARGIN_M = 2.0
"""Around all obstacles that the map shows of a large floor [m]."""

EMPTY_SIDE_M = 10.0
"""Side of the map of a large empty floor, around the origin [m]."""

MOST_CELLS = 4_000_000

TOUCH_M = 1e-9
"""Tolerance of contact: a place nearer to the body's surface by less than this is free [m]."""


def map_free_space(solids: Iterable[Solid], body: BodySize, *, stamp_ns: int = 0) -> FreeSpace:
    """Find where a body can stand.

    Parameters
    ----------
    solids : iterable of Solid
        What there is to collide with, and to stand upon.
    body : BodySize
    stamp_ns : int
        Simulated time [ns].

    Raises
    ------
    InvalidRequest
        If the map would have too many cells.
    """
    solids = list(solids)
    step = body.floor_m + body.step_m
    obstacles = outlines_between(solids, step, body.floor_m + body.height_m)
    # A floor is at its height within a step, and not thinner than rounding.
    floors = outlines_between(solids, body.floor_m - max(body.step_m, 1e-3), body.floor_m + 1e-6)
    low, high = _extent(obstacles, floors, body)
    side = body.resolution_m
    first = np.floor(low / side + 1e-9).astype(np.int64)
    columns, rows = (np.ceil(high / side - 1e-9).astype(np.int64) - first).clip(0).tolist()
    if rows * columns > MOST_CELLS:
        least = math.sqrt(rows * columns / MOST_CELLS) * side
        raise InvalidRequest(
            "resolution_m", side, f"at least {least:.2g} here, for a map of {MOST_CELLS} cells"
        )
    origin = np.round(first * side, 9)
    supported = _within(floors, 0.0, origin, side, (rows, columns))
    touched = _within(obstacles, body.radius_m, origin, side, (rows, columns))
    cells = np.where(supported, FREE, UNKNOWN).astype(np.int8)
    cells[touched] = OCCUPIED
    cells.flags.writeable = False
    return FreeSpace(
        cells=cells,
        origin_m=(float(origin[0]), float(origin[1])),
        body=body,
        stamp_ns=stamp_ns,
    )


def _extent(
    obstacles: Sequence[Doubles], floors: Sequence[Doubles], body: BodySize
) -> tuple[Doubles, Doubles]:
    """Return the lowest and the highest x and y that the map has."""
    if not floors:
        return np.zeros(2), np.zeros(2)
    floor = np.concatenate(floors)
    least, most = floor.min(axis=0), floor.max(axis=0)
    if (most - least).max() <= LARGEST_FLOOR_M:
        return least, most
    low, high = np.full(2, -0.5 * EMPTY_SIDE_M), np.full(2, 0.5 * EMPTY_SIDE_M)
    if obstacles:
        margin = MARGIN_M + body.radius_m
        corners = np.concatenate(obstacles)
        low, high = corners.min(axis=0) - margin, corners.max(axis=0) + margin
    return np.maximum(low, least), np.minimum(high, most)


def _within(
    outlines: Sequence[Doubles],
    reach_m: float,
    origin: Doubles,
    side: float,
    shape: tuple[int, int],
) -> NDArray[np.bool_]:
    """Return which cells' middles are inside of an outline, or nearer to one than a reach."""
    found = np.zeros(shape, np.bool_)
    rows, columns = shape
    for outline in outlines:
        # Columns and rows whose middles may be near enough.
        low = np.ceil((outline.min(axis=0) - reach_m - origin) / side - 0.5).astype(int).clip(0)
        high = np.floor((outline.max(axis=0) + reach_m - origin) / side - 0.5).astype(int) + 1
        at = slice(low[1], min(high[1], rows)), slice(low[0], min(high[0], columns))
        window = found[at]
        if not window.size or window.all():
            continue
        x = origin[0] + (np.arange(at[1].start, at[1].stop) + 0.5) * side
        y = origin[1] + (np.arange(at[0].start, at[0].stop) + 0.5) * side
        window |= _near(outline, reach_m, x[None, :], y[:, None])
    return found


def _near(outline: Doubles, reach_m: float, x: Doubles, y: Doubles) -> NDArray[np.bool_]:
    inside = np.full(np.broadcast_shapes(x.shape, y.shape), len(outline) > 2)
    near = np.zeros_like(inside)
    least = max(0.0, reach_m - TOUCH_M)
    for (ax, ay), (bx, by) in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        dx, dy = bx - ax, by - ay
        inside &= dx * (y - ay) - dy * (x - ax) >= 0.0
        if reach_m:
            length = dx * dx + dy * dy
            share = ((x - ax) * dx + (y - ay) * dy) / length if length else np.zeros_like(inside)
            share = np.clip(share, 0.0, 1.0)
            near |= (x - ax - share * dx) ** 2 + (y - ay - share * dy) ** 2 < least * least
    return inside | near
