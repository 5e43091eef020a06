"""Places to lie: where on a bed or a couch a body has room, and the heights of what is below it.

A body in, places in the world out. A place is a lane along the piece, nearly level, with its head
where the pillow is, and an edge from which one gets in.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.world.bodies import Body
from sailenv_ros.world.height_fields import STEP_M, HeightField, height_field_of
from sailenv_ros.world.seats import Seat

__all__ = ["BED_CATEGORIES", "Lane", "lanes_of"]

Doubles = NDArray[np.float64]

BED_CATEGORIES = frozenset({"bed", "couch"})

LOWEST_M, HIGHEST_M = 0.2, 0.75
"""Heights of what is lain upon [m]."""

_DIP_M = 0.08
_PILLOW_M, _CUSHION_M = 0.25, 0.09
"""How much higher than the rest a bed, and a couch, may be below a body [m]."""

_WIDTH_M, _COUCH_WIDTH_M = 0.56, 0.42
_SHARE_M = 0.7
"""Width that each of several has on a bed [m]."""


_PILLOW_STEPS = 24
"""How far from the head there may be a pillow, in steps."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Lane:
    """A place to lie.

    Attributes
    ----------
    name : str
        Of the piece.
    head : (2,) float64
        Where the top of a head may be at most, world [m].
    way : (2,) float64
        Unit vector from the feet to the head.
    length_m : float
    open_end : bool
        True if feet may reach over the end of the lane.
    pillow_m : float
        From `head` to where the pillow ends [m]; 0 for none.
    edges : tuple of (2,) float64
        Unit vectors out of the bed, to sides from which one gets in; see `seat`.
    field : HeightField
        Of the piece.
    """

    name: str
    head: Doubles
    way: Doubles
    length_m: float
    open_end: bool
    pillow_m: float
    edges: tuple[Doubles, ...]
    field: HeightField

    def seat(self, edge: Doubles, from_head_m: float) -> Seat | None:
        """Return the place on an edge where one sits before one lies down."""
        middle = self.head - from_head_m * self.way
        steps = np.arange(0.0, 2.0, STEP_M)
        tops_m = self.field.at(middle + steps[:, None] * edge)
        outside = np.flatnonzero(tops_m < tops_m[0] - 0.12)
        if not len(outside):
            return None
        last = int(outside[0]) - 1
        place = middle + steps[last] * edge
        return Seat(
            name=self.name,
            x=float(place[0]),
            y=float(place[1]),
            yaw=float(np.arctan2(edge[1], edge[0])),
            height_m=float(tops_m[max(last - 12, 0) : last + 1].max()),
            depth_m=float(steps[last]) + 0.2,
        )


def lanes_of(body: Body) -> tuple[Lane, ...]:
    """Return the places to lie on a piece; none if there is no room."""
    placement = body.placement
    matrix = body.world_from_body()
    if placement.asset.category not in BED_CATEGORIES or matrix[2, 2] < 0.98:
        return ()
    field = height_field_of(body)
    heights = field.heights
    level = heights[(heights > LOWEST_M) & (heights < HIGHEST_M)]
    if not len(level):
        return ()
    rest = float(np.median(level))
    is_couch = placement.asset.category == "couch"
    usable = (heights > rest - _DIP_M) & (heights < rest + (_CUSHION_M if is_couch else _PILLOW_M))
    lanes = _couch_lanes(usable) if is_couch else _bed_lanes(usable, heights)
    return tuple(_lane(body, matrix, field, *lane, is_couch) for lane in lanes)


_Run = tuple[int, int, int]
"""Of a lane: its middle across, and its first and last step along."""


def _bed_lanes(usable: NDArray[np.bool_], heights: Doubles) -> Iterator[_Run]:
    """Yield lanes along x, from the head, which is at the back, each along its pillow's middle."""
    across = np.flatnonzero(usable.mean(axis=0) > 0.5)
    if not len(across):
        return
    count = max(1, int(len(across) * STEP_M / _SHARE_M))
    half = round(0.5 * _WIDTH_M / STEP_M)
    for number in range(count):
        # One may lie anywhere, several keep apart.
        away = 0.5 if count == 1 else 0.17
        begin, end = (
            int(across[0] + (number + 0.5 + part) * len(across) / count) for part in (-away, away)
        )
        found = []
        for middle in range(max(begin, half), min(end, usable.shape[1] - half)):
            run = _longest(_clear(usable, middle, _WIDTH_M))
            if run is not None:
                near = heights[run[0] : run[0] + _PILLOW_STEPS, middle - half : middle + half + 1]
                found.append((run[1] - run[0], round(float(near.mean()), 2), (middle, *run)))
        longest = max((length for length, _, _ in found), default=0)
        fit = [one for one in found if one[0] >= longest - 2]
        highest = max((height for _, height, _ in fit), default=0.0)
        best = [run for _, height, run in fit if height == highest]
        yield from best[len(best) // 2 :][:1]


def _couch_lanes(usable: NDArray[np.bool_]) -> Iterator[_Run]:
    """Yield the lane along y that is in the middle of the longest ones."""
    found: list[_Run] = []
    for middle in range(usable.shape[0]):
        run = _longest(_clear(usable.T, middle, _COUCH_WIDTH_M))
        if run is not None:
            found.append((middle, *run))
    longest = max((last - first for _, first, last in found), default=0)
    best = [run for run in found if run[2] - run[1] >= longest - 2]
    yield from best[len(best) // 2 :][:1]


def _clear(usable: NDArray[np.bool_], middle: int, width_m: float) -> NDArray[np.bool_]:
    half = round(0.5 * width_m / STEP_M)
    if middle < half or middle + half >= usable.shape[1]:
        return np.zeros(usable.shape[0], np.bool_)
    found: NDArray[np.bool_] = usable[:, middle - half : middle + half + 1].mean(axis=1) > 0.96
    return found


def _longest(clear: NDArray[np.bool_]) -> tuple[int, int] | None:
    """Return the first and the last step of the longest run."""
    changes = np.flatnonzero(np.diff(np.concatenate([[0], clear.astype(np.int8), [0]])))
    if not len(changes):
        return None
    begins, ends = changes[::2], changes[1::2]
    longest = int((ends - begins).argmax())
    return int(begins[longest]), int(ends[longest]) - 1


def _lane(
    body: Body,
    matrix: Doubles,
    field: HeightField,
    middle: int,
    first: int,
    last: int,
    is_couch: bool,
) -> Lane:
    x, y, heights = field.x, field.y, field.heights
    if is_couch:
        profile = heights[max(middle - 4, 0) : middle + 5, first : last + 1].mean(axis=0)
        # The head where it is higher, if anywhere.
        backwards = profile[:12].mean() < profile[-12:].mean()
        head = np.array([x[middle], y[last] if backwards else y[first]])
        way = np.array([0.0, 1.0 if backwards else -1.0])
        edges: tuple[Doubles, ...] = (np.array([1.0, 0.0]),)
        profile = profile[::-1] if backwards else profile
    else:
        profile = heights[first : last + 1, max(middle - 4, 0) : middle + 5].mean(axis=1)
        head, way = np.array([x[first], y[middle]]), np.array([-1.0, 0.0])
        side = 1.0 if y[middle] >= 0.5 * (y[0] + y[-1]) else -1.0
        edges = (np.array([0.0, side]), np.array([0.0, -side]))
        if abs(y[middle] - 0.5 * (y[0] + y[-1])) > 0.2:
            edges = edges[:1]
    turn = matrix[:2, :2]
    beyond = head - ((last - first + 1) * STEP_M + np.array([0.04, 0.1]))[:, None] * way
    cells = np.rint((beyond - [x[0], y[0]]) / STEP_M).astype(np.int64)
    inside = ((cells >= 0) & (cells < heights.shape)).all(axis=1)
    # Not by the last step alone, where a mattress is round.
    open_end = bool((heights[tuple(cells[inside].T)] < profile[-6:].max() + 0.02).all())
    near = profile[: round(0.9 / STEP_M)]
    raised = near > near[15:].min(initial=np.inf) + 0.035
    start = int(np.argmax(raised)) if raised.any() else 0
    flat = np.flatnonzero(~raised[start:])
    pillow = (start + int(flat[0])) * STEP_M if raised.any() and len(flat) and start < 15 else 0.0
    return Lane(
        name=body.placement.name,
        head=turn @ head + matrix[:2, 3],
        way=turn @ way,
        length_m=(last - first + 1) * STEP_M,
        open_end=open_end,
        pillow_m=pillow,
        edges=tuple(turn @ edge for edge in edges),
        field=field,
    )
