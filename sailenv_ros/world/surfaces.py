"""Places to put things: level parts of a piece's top on which nothing stands."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.labels import ROOM_PARTS
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.height_fields import height_field_of

__all__ = ["free_spots", "is_empty"]

Doubles = NDArray[np.float64]

_STEP_M = 0.03
_LEVEL_M = 0.008
_LOWEST_M, _HIGHEST_M = 0.25, 1.5
_APART_M = 0.02
_MOST = 24


def free_spots(body: Body, others: Iterable[Body], around_m: float) -> list[Doubles]:
    """Return places on a piece, the nearest to its edges first.

    Parameters
    ----------
    body : Body
    others : iterable of Body
        What may stand there already.
    around_m : float
        Radius of what is to be put [m].

    Returns
    -------
    spots : list of (3,) float64
        On the surface, world [m].
    """
    placement, matrix = body.placement, body.world_from_body()
    if matrix[2, 2] < 0.98:
        return []
    low, high = placement.asset.model.bounds() * np.asarray(placement.scale)
    field = height_field_of(body, _STEP_M)
    heights = field.heights
    reach = int(np.ceil((around_m + _APART_M) / _STEP_M))
    side = 2 * reach + 1
    if min(heights.shape) < side:
        return []
    windows = np.lib.stride_tricks.sliding_window_view(heights, (side, side))
    level = np.ptp(windows, axis=(2, 3)) < _LEVEL_M
    rows, columns = np.nonzero(level)
    found = np.column_stack(
        [field.x[rows + reach], field.y[columns + reach], heights[rows + reach, columns + reach]]
    )
    spots = found @ matrix[:3, :3].T + matrix[:3, 3]
    spots = spots[(spots[:, 2] > _LOWEST_M) & (spots[:, 2] < _HIGHEST_M)]
    for other in others:
        if other is not body and len(spots):
            spots = spots[_away_from(other, spots, around_m + _APART_M)]
    edge = np.abs((spots[:, :2] - matrix[:2, 3]) @ matrix[:2, :2])
    order = np.argsort(-np.max(edge / np.maximum(0.5 * (high - low)[:2], 1e-6), axis=1))
    chosen: list[Doubles] = []
    for spot in spots[order]:
        if all(np.hypot(*(spot - one)[:2]) > 0.2 for one in chosen):
            chosen.append(spot)
            if len(chosen) >= _MOST:
                break
    return chosen


def is_empty(spots: Doubles, others: Iterable[Body], around_m: float) -> bool:
    """Return whether nothing but the room is at (N, 3) spots, nor nearer than a distance [m]."""
    return all(
        bool(_away_from(other, spots, around_m).all())
        for other in others
        if other.placement.asset.category not in ROOM_PARTS
    )


def _away_from(other: Body, spots: Doubles, around_m: float) -> NDArray[np.bool_]:
    """Return (N,): which of (N, 3) spots a body is not upon, nor nearer to than a distance [m]."""
    bounds = other.placement.asset.model.bounds() * np.asarray(other.placement.scale)
    matrix = other.world_from_body()
    corners = np.array([[bounds[i, 0], bounds[j, 1], bounds[k, 2]]
                        for i in (0, 1) for j in (0, 1) for k in (0, 1)])  # fmt: skip
    world = corners @ matrix[:3, :3].T + matrix[:3, 3]
    low, high = world.min(axis=0), world.max(axis=0)
    beside = ((spots[:, :2] < low[:2] - around_m) | (spots[:, :2] > high[:2] + around_m)).any(
        axis=1
    )
    below = (high[2] < spots[:, 2] + 0.01) | (low[2] > spots[:, 2] + 0.5)
    found: NDArray[np.bool_] = beside | below
    return found
