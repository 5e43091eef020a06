"""Polygons of OBJ files → triangles, so that concave ones keep their shape.

Readers of OBJ cut polygons into fans, which is right for convex ones alone. Text in, text out; all
but the faces stays as it is.
"""

from __future__ import annotations

import operator
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ["with_triangles"]

Floats = NDArray[np.float64]
Point = tuple[float, float, float]


def with_triangles(text: str) -> str:
    """Return an OBJ file's text with its polygons of four corners and more cut into triangles.

    Notes
    -----
    Ear clipping in the polygon's plane (mapbox's earcut). Faces whose corners cannot be found are
    left for the reader to complain about.
    """
    points: list[Point] = []
    lines: list[str] = []
    for line in text.replace("\\\n", " ").splitlines():
        words = line.split()
        if len(words) >= 4 and words[0] == "v":
            try:
                points.append((float(words[1]), float(words[2]), float(words[3])))
            except ValueError:
                points.append((0.0, 0.0, 0.0))
        if len(words) > 4 and words[0] == "f":
            lines.extend(_triangles(words[1:], points) or [line])
        else:
            lines.append(line)
    return "\n".join(lines) + "\n"


def _triangles(corners: list[str], points: list[Point]) -> list[str]:
    try:
        numbers = [int(corner.split("/")[0]) for corner in corners]
        polygon = [points[n - 1 if n > 0 else n] for n in numbers]
    except (ValueError, IndexError):
        return []
    if len(corners) == 4 and _is_convex(polygon):
        cut = [(0, 1, 2), (0, 2, 3)]
    else:
        cut = list(_clipped(np.array(polygon)))
    return [f"f {corners[a]} {corners[b]} {corners[c]}" for a, b, c in cut]


def _normal(polygon: Floats) -> Floats:
    """Return twice the polygon's area as a vector (Newell)."""
    return np.asarray(np.cross(polygon, np.roll(polygon, -1, axis=0)).sum(axis=0))


def _is_convex(corners: Sequence[Point]) -> bool:
    """Return whether four corners all turn to one side; plain numbers, as files have many."""
    edges = [_difference(corners[(k + 1) % 4], corners[k]) for k in range(4)]
    turns = [_cross(edges[k], edges[(k + 1) % 4]) for k in range(4)]
    normal = tuple(sum(turn[axis] for turn in turns) for axis in range(3))
    return all(sum(map(operator.mul, turn, normal)) >= 0.0 for turn in turns)


def _difference(a: Point, b: Point) -> Point:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _cross(a: Point, b: Point) -> Point:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _clipped(polygon: Floats) -> Iterator[tuple[int, int, int]]:
    import mapbox_earcut

    normal = _normal(polygon - polygon[0])
    length = float(np.linalg.norm(normal))
    if length == 0.0:
        return
    axis = int(np.abs(normal).argmax())
    # The two other axes, in the order that keeps the polygon's sense of turning.
    flat = polygon[:, [(axis + 1) % 3, (axis + 2) % 3]] * [np.sign(normal[axis]), 1.0]
    rings = np.array([len(polygon)], dtype=np.uint32)
    cut = mapbox_earcut.triangulate_float64(np.ascontiguousarray(flat), rings).reshape(-1, 3)
    for a, b, c in cut.tolist():
        turn = np.cross(polygon[b] - polygon[a], polygon[c] - polygon[a]) @ normal
        yield (a, b, c) if turn >= 0.0 else (a, c, b)
