"""Puts rectangles into the smallest square that takes them. Knows nothing of what they are."""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["STEP", "packed"]

STEP = 64
"""The square's side is a multiple of it."""


def packed(
    sizes: Sequence[tuple[int, int]], limit: int
) -> tuple[int, list[tuple[int, int]]] | None:
    """Place rectangles without overlap.

    Parameters
    ----------
    sizes : sequence of (width, height)
    limit : int
        Largest side of the square, a multiple of 64.

    Returns
    -------
    (side, places) or None
        Side of the square and the lowest corner of each rectangle; None if they do not fit.
    """
    area = sum(width * height for width, height in sizes)
    longest = max((max(size) for size in sizes), default=1)
    start = max(int(area**0.5), longest)
    for side in range(-(-start // STEP) * STEP, limit + 1, STEP):
        places = _placed(sizes, side)
        if places is not None:
            return side, places
    return None


def _placed(sizes: Sequence[tuple[int, int]], side: int) -> list[tuple[int, int]] | None:
    """Lay the tall ones first, each where it comes to lie lowest."""
    order = sorted(range(len(sizes)), key=lambda i: (-sizes[i][1], -sizes[i][0], i))
    skyline = [(0, 0, side)]  # x, height, width of each step from left to right
    places = [(0, 0)] * len(sizes)
    for index in order:
        width, height = sizes[index]
        spots = ((_level(skyline, i, width, side), i) for i in range(len(skyline)))
        fitting = [(level, i) for level, i in spots if level is not None and level + height <= side]
        if not fitting:
            return None
        level, i = min(fitting, key=lambda spot: (spot[0], skyline[spot[1]][0]))
        places[index] = (skyline[i][0], level)
        skyline = _raised(skyline, skyline[i][0], width, level + height)
    return places


def _level(skyline: list[tuple[int, int, int]], first: int, width: int, side: int) -> int | None:
    """Return the height at which a rectangle rests that begins at a step; None if too wide."""
    x = skyline[first][0]
    if x + width > side:
        return None
    level, covered = 0, 0
    for start, height, step in skyline[first:]:
        level = max(level, height)
        covered = start + step - x
        if covered >= width:
            break
    return level


def _raised(
    skyline: list[tuple[int, int, int]], x: int, width: int, height: int
) -> list[tuple[int, int, int]]:
    raised: list[tuple[int, int, int]] = []
    for start, level, step in skyline:
        left, right = start, start + step
        if left < x:
            raised.append((left, level, min(right, x) - left))
        if left <= x < right:
            raised.append((x, height, width))
        if right > x + width:
            begin = max(left, x + width)
            raised.append((begin, level, right - begin))
    return sorted(raised)
