"""Contacts in the last steps: the engine's contact points, summed for each pair of bodies.

The engine after each step in, `Contact`s out. It is listened to only for a while after somebody
has asked: reading the points of every step would cost more than the step where much is piled up.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from sailenv_ros.types.contacts import Contact
from sailenv_ros.world.bullet import STEPS_PER_SECOND, BulletClient, sim_time_ns

__all__ = ["MAX_WINDOW_S", "ContactLog"]

MAX_WINDOW_S = 1.0
"""Longest time back that can be asked for [s]."""

LISTENS_S = 10.0
"""Simulated time after a question for which each step is kept [s]."""

Piece = tuple[int, int]
"""The engine's number of a body, and that of its link."""

Point = tuple[Piece, Piece, tuple[float, ...], tuple[float, ...], float, float]


@dataclass(slots=True)
class _Touch:
    """A pair: its impulse so far, and where it was strongest."""

    impulse_n_s: float
    strongest_n_s: float
    step: int
    point: Point


class ContactLog:
    """Points of contact of the last steps.

    Parameters
    ----------
    client : BulletClient
    gain : callable
        ``gain(first, second)`` returns by what the last step's impulse between two bodies was
        multiplied outside of the engine.
    """

    def __init__(self, client: BulletClient, gain: Callable[[Piece, Piece], float]) -> None:
        self._client = client
        self._gain = gain
        self._until_step = -1
        self._steps: deque[tuple[int, list[Point]]] = deque(
            maxlen=round(MAX_WINDOW_S * STEPS_PER_SECOND)
        )

    def after_step(self, step: int) -> None:
        """Keep the points of the step that has just been done, its number counted from 1."""
        if step <= self._until_step:
            self._steps.append((step, self._points()))

    def contacts(
        self, step: int, count: int, ids: Mapping[Piece, int], movers: Mapping[Piece, str]
    ) -> tuple[Contact, ...]:
        """Return the pairs that touched in the last steps, in the order of their ids.

        Parameters
        ----------
        step : int
            How many steps there were.
        count : int
            How many of them are looked at, as far as they were kept; the last one always is.
        ids : mapping of (int, int) to int
            Instance ids by the engine's numbers of bodies and their links.
        movers : mapping of (int, int) to str
            Names of movers by the same of their bodies.
        """
        if not self._steps or self._steps[-1][0] != step:
            self._steps.clear()
            self._steps.append((step, self._points()))
        self._until_step = step + round(LISTENS_S * STEPS_PER_SECOND)
        touches: dict[tuple[Piece, Piece], _Touch] = {}
        for at, points in self._steps:
            if at > step - count:
                for point in points:
                    _add(touches, at, point)
        found = [
            _contact(touch, ids, movers)
            for touch in touches.values()
            if all(body in ids or body in movers for body in touch.point[:2])
        ]
        return tuple(sorted(found, key=lambda c: (c.first, c.second, c.mover, c.other_mover)))

    def _points(self) -> list[Point]:
        points = [
            ((p[1], p[3]), (p[2], p[4]), p[5], p[7], p[8], p[9] / STEPS_PER_SECOND)
            for p in self._client.getContactPoints()
            if p[9] > 0.0 or p[8] <= 0.0
        ]
        return [(*p[:5], p[5] * self._gain(p[0], p[1])) for p in points]


def _add(touches: dict[tuple[Piece, Piece], _Touch], step: int, point: Point) -> None:
    impulse = point[5]
    touch = touches.get(point[:2])
    if touch is None:
        touches[point[:2]] = _Touch(impulse, impulse, step, point)
        return
    touch.impulse_n_s += impulse
    if impulse > touch.strongest_n_s:
        touch.strongest_n_s, touch.step, touch.point = impulse, step, point


def _contact(touch: _Touch, ids: Mapping[Piece, int], movers: Mapping[Piece, str]) -> Contact:
    a, b, position, normal, distance_m, _ = touch.point
    # What is no object is named: a mover before an object, two movers by their names.
    one, two = (ids.get(a, 0), movers.get(a, "")), (ids.get(b, 0), movers.get(b, ""))
    sign = 1.0
    if one > two:
        sign, one, two = -1.0, two, one
    x, y, z = position
    nx, ny, nz = normal
    return Contact(
        first=one[0],
        second=two[0],
        mover=one[1],
        other_mover=two[1],
        position_m=(x, y, z),
        normal=(sign * nx, sign * ny, sign * nz),
        impulse_n_s=touch.impulse_n_s,
        depth_m=-distance_m,
        sim_time_ns=sim_time_ns(touch.step),
    )
