"""The camera's way through a room: places far from furniture and from each other, joined.

The cells where one can walk in, waypoints out: straight lines between them keep their distance
from everything, and each looks at something.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from sailenv_content.generation.items import Item
from sailenv_content.generation.plan import RoomPlan
from sailenv_ros.authoring.room_rules.random_stream import RandomStream

__all__ = ["mover_entry", "walk_cells"]

CAMERA_RADIUS_M = 0.32
EYE_M = (1.45, 1.65)
STOPS_IN_A_ROOM = 8
MORE_STOPS = 3
"""Number of stops in every further room."""
_STOP_M = 0.9
_STEP_CELLS = 12.0
_LOOK_LEAST_M = 0.9

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Cell = tuple[int, int]


def mover_entry(
    plan: RoomPlan, items: Sequence[Item], dice: RandomStream, speed_m_per_s: float
) -> dict[str, Any]:
    """Return the mover of a scene; it goes in a circle, there and back where there is no other way.

    Raises
    ------
    ValueError
        If there is no place for a camera at all.
    """
    clearance = plan.clearance_m(_in_the_way(items))
    reached = plan.walkable()
    assert reached is not None
    free = walk_cells(reached & (clearance > CAMERA_RADIUS_M), plan)
    if not free.any():
        raise ValueError("no place for a camera")
    stops = _stops(free, clearance, plan, dice)
    way = _closed_way(stops, free, clearance)
    eye = round(dice.between(EYE_M), 2)
    points = [(*map(float, np.round(plan.centre(cell), 3)), eye) for cell in way]
    looks = _looks(points, items, dice)
    length = sum(math.dist(a, b) for a, b in zip(points, [*points[1:], points[0]], strict=True))
    waypoints = [
        {"position": list(p), "look_at": list(q)} for p, q in zip(points, looks, strict=True)
    ]
    total = max(20.0, float(round(max(length / speed_m_per_s, 3.0 * len(points)))))
    return {"total_time": total, "loop": True, "waypoints": waypoints}


def walk_cells(free: Flags, plan: RoomPlan) -> Flags:
    """Return the largest connected part of some cells."""
    parts, count = label(free)
    if not count:
        return np.zeros_like(free)
    sizes = np.bincount(parts.ravel())
    sizes[0] = 0
    return np.asarray(parts == int(sizes.argmax()))


def _in_the_way(items: Sequence[Item]) -> list[Any]:
    """Return the boxes of what is as high as a camera, or nearly so, and stands on the floor."""
    return [item.block for item in items if item.rule is not None and not item.is_flat
            and item.block.low < 1.9 and item.block.high > 0.05]  # fmt: skip


def _stops(free: Flags, clearance: Floats, plan: RoomPlan, dice: RandomStream) -> list[Cell]:
    """Return places that lie far from each other, each the farthest from those before."""
    cells = np.argwhere(free)
    places = plan.points[free]
    weight = np.minimum(clearance[free], 0.8)
    first = dice.whole((0, len(cells) - 1))
    first = int(np.argmin(np.hypot(*(places - places[first]).T) - 2.0 * weight))
    chosen = [first]
    away = np.hypot(*(places - places[first]).T)
    most = STOPS_IN_A_ROOM + MORE_STOPS * (len(plan.areas) - 1)
    while len(chosen) < most:
        best = int(np.argmax(np.minimum(away, 2.5) + 0.5 * weight))
        if away[best] < _STOP_M:
            break
        chosen.append(best)
        away = np.minimum(away, np.hypot(*(places - places[best]).T))
    return [(int(cells[index][0]), int(cells[index][1])) for index in chosen]


def _closed_way(stops: Sequence[Cell], free: Flags, clearance: Floats) -> list[Cell]:
    """Return corners of a way that comes by all stops and ends where it began."""
    ways = _Ways(stops, free, clearance)
    order, rest = [stops[0]], list(stops[1:])
    while rest:
        nearest = min(rest, key=lambda cell: (math.dist(cell, order[-1]), cell))
        rest.remove(nearest)
        order.append(nearest)
    way: list[Cell] = []
    for start, end in zip(order, [*order[1:], order[0]], strict=True):
        if start != end:
            way += _straightened(ways.shortest(start, end), free)[:-1]
    return _without_short_steps(way, free) or [stops[0]]


def _without_short_steps(way: list[Cell], free: Flags) -> list[Cell]:
    """Leave out corners that lie close to the one before, where the way is free without."""
    kept = list(way)
    while len(kept) > 3:
        for index in range(len(kept)):
            before, after = kept[index - 1], kept[(index + 1) % len(kept)]
            if math.dist(before, kept[index]) < _STEP_CELLS and _sees(before, after, free):
                del kept[index]
                break
        else:
            break
    return kept


class _Ways:
    """Short ways between stops that keep away from things (Dijkstra's algorithm)."""

    def __init__(self, stops: Sequence[Cell], free: Flags, clearance: Floats) -> None:
        self._cells = np.argwhere(free)
        numbers = np.full(free.shape, -1)
        numbers[free] = np.arange(len(self._cells))
        self._numbers = numbers
        self._stops = {stop: row for row, stop in enumerate(stops)}
        _, self._before = dijkstra(
            _graph(self._cells, numbers, clearance),
            indices=[int(numbers[stop]) for stop in stops],
            return_predecessors=True,
        )

    def shortest(self, start: Cell, end: Cell) -> list[Cell]:
        """Return the cells of a way from one stop to another."""
        before, first = self._before[self._stops[start]], int(self._numbers[start])
        way = [int(self._numbers[end])]
        while way[-1] != first:
            way.append(int(before[way[-1]]))
        return [(int(x), int(y)) for x, y in self._cells[way[::-1]]]


def _graph(cells: NDArray[np.intp], numbers: NDArray[np.intp], clearance: Floats) -> csr_array:
    """Return the costs of steps between neighbouring cells; narrow places cost more."""
    padded = np.pad(numbers, 1, constant_values=-1)
    costs = 1.0 + 0.15 / np.maximum(clearance[cells[:, 0], cells[:, 1]], 0.05)
    rows, columns, values = [], [], []
    for dx in (-1, 0, 1):
        for dy in (-1, 0, 1):
            near = padded[cells[:, 0] + 1 + dx, cells[:, 1] + 1 + dy]
            known = (near >= 0) & ((dx, dy) != (0, 0))
            rows.append(np.flatnonzero(known))
            columns.append(near[known])
            values.append(math.hypot(dx, dy) * costs[near[known]])
    index = np.concatenate(rows), np.concatenate(columns)
    return csr_array((np.concatenate(values), index), shape=(len(cells), len(cells)))


def _straightened(way: Sequence[Cell], free: Flags) -> list[Cell]:
    """Return the corners of a way, between which straight lines stay in free cells."""
    kept, at = [way[0]], 0
    while at < len(way) - 1:
        onward = len(way) - 1
        while onward > at + 1 and not _sees(way[at], way[onward], free):
            onward -= 1
        kept.append(way[onward])
        at = onward
    return kept


def _sees(start: Cell, end: Cell, free: Flags) -> bool:
    count = 4 * max(abs(end[0] - start[0]), abs(end[1] - start[1])) + 1
    cells = np.round(np.linspace(start, end, count)).astype(int)
    return bool(free[cells[:, 0], cells[:, 1]].all())


def _looks(
    points: Sequence[tuple[float, ...]], items: Sequence[Item], dice: RandomStream
) -> list[tuple[float, float, float]]:
    """Return what is looked at from each place: furniture that is near, another one each time."""
    pieces = [item for item in items if item.rule is not None and not item.is_flat]
    looks: list[tuple[float, float, float]] = []
    seen: dict[str, int] = {}
    for x, y, _ in points:
        ranked = sorted(
            pieces,
            key=lambda item: (
                seen.get(item.name, 0)
                + 0.25 * math.hypot(item.block.x - x, item.block.y - y)
                - min(1.0, 2.0 * item.block.half_x * item.block.half_y),
                item.name,
            ),
        )
        far = [
            item for item in ranked
            if math.hypot(item.block.x - x, item.block.y - y) > _LOOK_LEAST_M
        ]  # fmt: skip
        if not far:
            looks.append((round(x + 1.0, 2), y, 1.0))
            continue
        item = far[0]
        seen[item.name] = seen.get(item.name, 0) + 1
        z = min(1.3, max(0.45, (item.block.low + item.block.high) / 2.0))
        looks.append((round(item.block.x, 2), round(item.block.y, 2), round(z, 2)))
    return looks
