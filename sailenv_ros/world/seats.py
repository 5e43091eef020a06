"""Seats: where on a piece of furniture one can sit, from what is drawn of it.

A body in, places in the world out. A seat is a level part of a piece at the height of a knee, open
to the piece's front, which is its x axis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.rays.scene_geometry import SceneGeometry
from sailenv_ros.types.instance_states import InstanceStates
from sailenv_ros.types.model import Model
from sailenv_ros.world.bodies import Body

__all__ = ["SEAT_CATEGORIES", "Seat", "heights_at", "heights_over", "seats_of"]

Doubles = NDArray[np.float64]

SEAT_CATEGORIES = frozenset({"chair", "couch", "bench", "bed", "stool"})

LOWEST_M, HIGHEST_M = 0.30, 0.64
"""Heights of what is sat upon [m]."""

_STEP_M = 0.02
_BACK_M = 0.10
"""Height above the seat from which something is its back [m]."""

_ABOVE_M = 3.0

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
    along = np.arange(high[0] - 0.5 * _STEP_M, low[0], -_STEP_M)
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
    depth = (stop - first) * _STEP_M
    if depth < LEAST_DEPTH_M:
        return None
    front = matrix @ np.array([along[first] + 0.5 * _STEP_M, y, 0.0, 1.0])
    return Seat(
        name=body.placement.name,
        x=float(front[0]),
        y=float(front[1]),
        yaw=float(np.arctan2(matrix[1, 0], matrix[0, 0])),
        height_m=float(np.max(heights[first + 2 : first + 12], initial=height)),
        depth_m=depth,
    )


def heights_over(
    model: Model, scale: tuple[float, float, float], along: Doubles, across: Doubles
) -> Doubles:
    """Return (X, Y): heights of the highest surface over places of a model; -1 for none [m]."""
    x, y = np.meshgrid(along, across, indexing="ij")
    found = heights_at(model, scale, np.stack([x, y], axis=-1).reshape(-1, 2))
    return found.reshape(x.shape)


def heights_at(model: Model, scale: tuple[float, float, float], places: Doubles) -> Doubles:
    """Return (N,): the same over (N, 2) places."""
    origins = np.column_stack([places, np.full(len(places), _ABOVE_M)])
    states = InstanceStates(
        ids=np.array([1], np.uint16),
        positions=np.zeros((1, 3)),
        orientations=np.array([[0.0, 0.0, 0.0, 1.0]]),
        linear_velocities=np.zeros((1, 3)),
        angular_velocities=np.zeros((1, 3)),
        scales=np.array([scale]),
    )
    down = np.broadcast_to(np.array([0.0, 0.0, -1.0]), origins.shape)
    hits = SceneGeometry({1: model}).cast(states, origins, down)
    return np.where(np.isfinite(hits.distance), _ABOVE_M - hits.distance, -1.0)
