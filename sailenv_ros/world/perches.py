"""Perches: where on a couch or a bed a cat has room to lie, and over which edge it gets there.

A body in, places in the world out. A perch is a nearly level part of a piece, at a height that a
cat jumps, with nothing beside it that a turning body would meet.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.world.beds import BED_CATEGORIES, HIGHEST_M, LOWEST_M
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.height_fields import STEP_M, height_field_of

__all__ = ["Perch", "perches_of"]

Doubles = NDArray[np.float64]

_WIDE = 0.38
"""Half the width of one who lies, over half its length."""

_TAIL = 1.45
"""From the middle of one who lies to the end of its tail, over half its length."""

_UNEVEN_M, _BESIDE_M = 0.05, 0.06
"""How much of a perch may be lower than its highest place, and what is beside it higher [m]."""

_DROP_M = 0.15
"""How much lower than a perch everything is beyond its edge [m]."""

_FARTHEST_M = 0.55
"""From the edge to the middle of a perch [m]."""

_OUT = ((1, 0), (0, 1), (0, -1))
"""Edges of a piece: its front, its left, its right."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Perch:
    """A place for a cat.

    Attributes
    ----------
    name : str
        Of the piece.
    place : (3,) tuple of float
        Middle of it, world [m].
    out : (2,) tuple of float
        Unit vector over the edge.
    edge_m : float
        From the middle to the edge [m].
    """

    name: str
    place: tuple[float, float, float]
    out: tuple[float, float]
    edge_m: float


def perches_of(body: Body, half_m: float) -> tuple[Perch, ...]:
    """Return the perches of a piece for a body of half that length; none if there is no room."""
    matrix = body.world_from_body()
    if body.placement.asset.category not in BED_CATEGORIES or matrix[2, 2] < 0.98:
        return ()
    from scipy.ndimage import grey_closing  # few have a cat

    field = height_field_of(body)
    heights = grey_closing(field.heights, size=3)  # over seams between cushions
    origin, found = np.array([field.x[0], field.y[0]]), []
    for out in _OUT:
        for row, column, top, steps in _perches_over(heights, out, half_m):
            own = origin + STEP_M * np.array([row, column])
            world = matrix @ np.array([*own, top, 1.0])
            found.append(
                Perch(
                    name=body.placement.name,
                    place=(float(world[0]), float(world[1]), float(world[2])),
                    out=tuple((matrix[:2, :2] @ np.array(out, np.float64)).tolist()),
                    edge_m=steps * STEP_M,
                )
            )
    return tuple(found)


def _perches_over(
    heights: Doubles, out: tuple[int, int], half_m: float
) -> list[tuple[int, int, float, int]]:
    """Return row, column and height of perches by an edge, and their steps to it."""
    from scipy.ndimage import maximum_filter, minimum_filter

    axis, towards = (0, out[0]) if out[0] else (1, out[1])
    # Rows ascend towards the edge.
    grid = np.moveaxis(heights, axis, 0)[::towards]
    half = int(np.ceil(half_m / STEP_M))
    size = (2 * int(np.ceil(_WIDE * half_m / STEP_M)) + 1, 2 * half + 1)
    top = maximum_filter(grid, size, mode="constant", cval=-1.0)
    low = minimum_filter(grid, size, mode="constant", cval=-1.0)
    room = (2 * half + 1, 2 * int(np.ceil(_TAIL * half)) + 1)
    around = maximum_filter(grid, room, mode="constant", cval=-1.0)
    fits = (top - low < _UNEVEN_M) & (top > LOWEST_M) & (top < HIGHEST_M)
    fits &= around < top + _BESIDE_M
    found = []
    for row, column in np.argwhere(fits).tolist():
        height = float(top[row, column])
        ahead = np.append(grid[row:, column], -1.0)
        steps = int(np.argmax(ahead < height - _DROP_M))
        if steps * STEP_M <= _FARTHEST_M and ahead[:steps].max() < height + _BESIDE_M:
            found.append((abs(steps - half), row, column, steps))
    chosen: list[tuple[int, int, float, int]] = []
    columns: list[int] = []
    for _, row, column, steps in sorted(found):
        if all(abs(column - other) > 2 * half for other in columns):
            columns.append(column)
            place = (row if towards > 0 else len(grid) - 1 - row, column)
            rows, beside = (slice(max(k - n // 2, 0), k + n // 2 + 1)
                            for k, n in zip((row, column), size, strict=True))  # fmt: skip
            height = float(np.quantile(grid[rows, beside], 0.8))
            chosen.append((*(place if axis == 0 else place[::-1]), height, steps))
    return chosen
