"""Small things of a room, moved aside on what they lie on. A room in, other poses out."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.gym.room import Room
from sailenv_ros.types.labels import PART_MARK

__all__ = ["Poses", "move_things"]

Poses = Mapping[int, NDArray[np.float64]]
"""Poses (4, 4) by rows of a snapshot."""

LARGEST_M = 0.7
"""Longest side of the box of a thing that is moved [m]."""

LYING_M = 0.03
"""Distance between a thing and the top of what it lies on, at most [m]."""

MOVED_M = (0.2, 1.2)
"""Least and greatest distance that it is moved by [m]."""

ASIDE_M = 0.01
"""Room between boxes [m]."""

TRIES = 30


def move_things(
    room: Room,
    count: int,
    random: np.random.Generator,
    is_seen: Callable[[int, Poses], bool],
) -> dict[int, dict[int, NDArray[np.float64]]]:
    """Move some things of a room.

    Parameters
    ----------
    room : Room
    count : int
        How many; fewer are moved where there are no more.
    random : numpy.random.Generator
    is_seen : callable
        Whether a thing (its row) counts as visible with some poses changed; one that is moved is
        visible before and after.

    Returns
    -------
    moved : dict of int to dict of int to (4, 4) array
        By the row of each thing: new poses of it and of its parts.
    """
    small = [
        row
        for rows in room.objects.values()
        for row in rows
        if PART_MARK not in room.snapshot.contents.instances[row].instance.name
        and np.ptp(room.boxes[row], axis=0).max() <= LARGEST_M
    ]
    boxes = room.boxes.copy()
    moved: dict[int, dict[int, NDArray[np.float64]]] = {}
    for place in random.permutation(len(small)).tolist():
        if len(moved) == count:
            break
        row = small[place]
        known = {r: pose for one in moved.values() for r, pose in one.items()}
        rows = _with_parts(room, row)
        shift = _shift(room, boxes, rows, random)
        if shift is None or not is_seen(row, known):
            continue
        poses = {}
        for one in rows:
            pose = room.snapshot.world_from_body[one].copy()
            pose[:2, 3] += shift
            poses[one] = pose
        if not is_seen(row, {**known, **poses}):
            continue
        moved[row] = poses
        boxes[rows, :, :2] += shift
    return moved


def _with_parts(room: Room, row: int) -> list[int]:
    """Return the rows of an object and of the parts of its model."""
    begin = room.snapshot.contents.instances[row].instance.name + PART_MARK
    return [row, *(other for name, other in room.rows.items() if name.startswith(begin))]


def _shift(
    room: Room, boxes: NDArray[np.float64], rows: list[int], random: np.random.Generator
) -> NDArray[np.float64] | None:
    """Return by how much a thing can be moved along x and y; None where nothing was found."""
    low, high = boxes[rows, 0].min(axis=0), boxes[rows, 1].max(axis=0)
    others = np.ones(len(boxes), bool)
    others[rows] = False
    middle = 0.5 * (low + high)[:2]
    under = others & (np.abs(boxes[:, 1, 2] - low[2]) <= LYING_M)
    under &= ((boxes[:, 0, :2] <= middle) & (middle <= boxes[:, 1, :2])).all(axis=1)
    above = (boxes[:, 0, 2] < high[2]) & (boxes[:, 1, 2] > low[2] + LYING_M)
    # What lies upon it would be left in the air.
    lying = others & (np.abs(boxes[:, 0, 2] - high[2]) <= LYING_M)
    lying &= ((boxes[:, 0, :2] < high[:2]) & (low[:2] < boxes[:, 1, :2])).all(axis=1)
    if not under.any() or lying.any():
        return None
    support = boxes[under][np.argmin(np.ptp(boxes[under][:, :, :2], axis=1).prod(axis=1))]
    beside = boxes[others & above]
    for _ in range(TRIES):
        angle, length = random.uniform(0.0, 2.0 * np.pi), random.uniform(*MOVED_M)
        shift = length * np.array([np.cos(angle), np.sin(angle)])
        first, last = low[:2] + shift, high[:2] + shift
        if (first < support[0, :2]).any() or (last > support[1, :2]).any():
            continue
        hits = (beside[:, 0, :2] < last + ASIDE_M) & (beside[:, 1, :2] > first - ASIDE_M)
        if not hits.all(axis=1).any():
            return shift
    return None
