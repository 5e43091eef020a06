"""Seats: where on a piece of furniture one can sit, from what is drawn of it.

A body in, places in the world out. A seat is a level part of a piece at the height of a knee, open
to the piece's front, which is its x axis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.world.bodies import Body
from sailenv_ros.world.height_fields import STEP_M, heights_over

__all__ = ["SEAT_CATEGORIES", "Seat", "seats_of"]

Doubles = NDArray[np.float64]

SEAT_CATEGORIES = frozenset({"chair", "couch", "bench", "bed", "stool"})

LOWEST_M, HIGHEST_M = 0.30, 0.64
"""Heights of what is sat upon [m]."""

_BACK_M = 0.10
"""Height above the seat from which something is its back [m]."""

PLACE_M = 0.66
"""Width that one who sits takes [m]."""

LEAST_DEPTH_M = 0.22


@dataclass(frozen=True, slots=True, kw_only=True)
class Seat:
    """A place to sit.

    Attributes
    ----------
    name : str
        Of the piece.
    x, y : float
        Front edge of the seat, in its middle, world [m].
    yaw : float
        Which way one looks who sits there [rad].
    height_m : float
        Over the world's origin [m].
    depth_m : float
        From the front edge to the back [m].
    """

    name: str
    x: float
    y: float
    yaw: float
    height_m: float
    depth_m: float


def seats_of(body: Body) -> tuple[Seat, ...]:
    """Return the places of a piece; none if one cannot sit on it."""
    placement = body.placement
    matrix = body.world_from_body()
    # What has fallen over is no seat.
    if placement.asset.category not in SEAT_CATEGORIES or matrix[2, 2] < 0.98:
        return ()
    low, high = placement.asset.model.bounds() * np.asarray(placement.scale)
    width = float(high[1] - low[1])
    count = max(1, int((width - 0.12) / PLACE_M))
    middles = [float(low[1] + width * (number + 0.5) / count) for number in range(count)]
    along = np.arange(high[0] - 0.5 * STEP_M, low[0], -STEP_M)
    found = []
    for y in middles:
        across = np.array([y - 0.11, y, y + 0.11])
        tops = np.median(
            heights_over(placement.asset.model, placement.scale, along, across), axis=1
        )
        seat = _seat_at(body, matrix, along, tops, y)
        if seat is not None:
            found.append(seat)
    return tuple(found)


def _seat_at(body: Body, matrix: Doubles, along: Doubles, tops: Doubles, y: float) -> Seat | None:
    heights = tops + float(matrix[2, 3])
    level = (heights > LOWEST_M) & (heights < HIGHEST_M)
    if not level.any():
        return None
    first = int(np.argmax(level))
    height = float(np.median(heights[first : first + 12]))
    rises = np.flatnonzero((heights > height + _BACK_M) & (np.arange(len(heights)) > first))
    ends = np.flatnonzero((heights < height - _BACK_M) & (np.arange(len(heights)) > first))
    stop = min([len(heights), *rises[:1].tolist(), *ends[:1].tolist()])
    depth = (stop - first) * STEP_M
    if depth < LEAST_DEPTH_M:
        return None
    front = matrix @ np.array([along[first] + 0.5 * STEP_M, y, 0.0, 1.0])
    return Seat(
        name=body.placement.name,
        x=float(front[0]),
        y=float(front[1]),
        yaw=float(np.arctan2(matrix[1, 0], matrix[0, 0])),
        height_m=float(np.max(heights[first + 2 : first + 12], initial=height)),
        depth_m=depth,
    )
