"""Pictures of what lies outside: lawn, paving, house fronts, foliage, painted by code.

A size in pixels and metres and a generator in, linear albedo (rows, columns, 3) out; row 0 is the
top.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Board",
    "Painter",
    "asphalt",
    "boards",
    "foliage",
    "lawn",
    "leaves",
    "noise",
    "paving",
    "plain",
    "resized",
    "tiles",
    "uneven",
]

Floats: TypeAlias = NDArray[np.float32]
Rgb: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True, eq=False, slots=True)
class Board:
    """A canvas: a rectangle of so many metres and pixels, and its generator."""

    width_m: float
    height_m: float
    columns: int
    rows: int
    rng: np.random.Generator

    @property
    def across_m(self) -> Floats:
        """(1, columns): how far from the left the pixels' middles are [m]."""
        share = (np.arange(self.columns, dtype=np.float32) + np.float32(0.5)) / self.columns
        return np.asarray(share * self.width_m, np.float32)[None]

    @property
    def up_m(self) -> Floats:
        """(rows, 1): how far from the foot they are [m]."""
        share = (np.arange(self.rows, dtype=np.float32)[::-1] + np.float32(0.5)) / self.rows
        return np.asarray(share * self.height_m, np.float32)[:, None]


Painter: TypeAlias = Callable[[Board], Floats]


def resized(values: Floats, rows: int, columns: int) -> Floats:
    """Interpolate an array (r, c, …) linearly to (rows, columns, …), its ends at the ends."""
    for axis, count in ((0, rows), (1, columns)):
        last = values.shape[axis] - 1
        place = np.linspace(0.0, last, count, dtype=np.float32)
        low = np.minimum(place.astype(np.intp), max(0, last - 1))
        share = (place - low).reshape([-1 if i == axis else 1 for i in range(values.ndim)])
        first = np.take(values, low, axis=axis)
        values = first + (np.take(values, np.minimum(low + 1, last), axis=axis) - first) * share
    return values


def noise(board: Board, size_m: float) -> Floats:
    """Return (rows, columns) numbers of mean 0, -1 to 1, with features of a size [m]."""
    rows = max(2, round(board.height_m / size_m) + 1)
    columns = max(2, round(board.width_m / size_m) + 1)
    rows, columns = min(rows, board.rows), min(columns, board.columns)
    grid = board.rng.uniform(-1.0, 1.0, (rows, columns)).astype(np.float32)
    return resized(grid, board.rows, board.columns)


def _toned(colour: ArrayLike, factor: Floats) -> Floats:
    return np.asarray(colour, np.float32) * factor[..., None]


def plain(colour: Rgb, grain: float = 0.04) -> Painter:
    """Return a painter of plaster, concrete, paint: one colour with weather on it."""

    def paint(board: Board) -> Floats:
        return _toned(
            colour, 1.0 + grain * (noise(board, 1.7) + noise(board, 0.3) + noise(board, 0.04))
        )

    return paint


def lawn(colour: Rgb = (0.085, 0.135, 0.035)) -> Painter:
    """Return a painter of grass."""

    def paint(board: Board) -> Floats:
        tone = 1.0 + 0.16 * noise(board, 2.5) + 0.14 * noise(board, 0.5) + 0.3 * noise(board, 0.04)
        dry = np.clip(0.25 + 0.6 * noise(board, 1.6) + 0.2 * noise(board, 0.1), 0.0, 0.6)[..., None]
        grass = np.asarray(colour, np.float32)
        hay = grass * np.asarray((1.75, 1.25, 1.2), np.float32)
        picture: Floats = (grass + (hay - grass) * dry) * tone[..., None]
        return picture

    return paint


def uneven(column: Floats, row: Floats | float = 0.0) -> NDArray[Any]:
    """Return a number from -0.5 to 0.5 that follows from a column and a row, as if by chance."""
    hashed = np.sin(12.9898 * column + 78.233 * row) * 43758.547
    return hashed - np.floor(hashed) - 0.5


def paving(colour: Rgb, slab_m: tuple[float, float], joint_m: float = 0.02) -> Painter:
    """Return a painter of slabs with joints, of which no two have quite the same tone."""

    def paint(board: Board) -> Floats:
        row = np.floor(board.up_m / slab_m[1])
        place = board.across_m / slab_m[0] + 0.5 * (row % 2)
        column = np.floor(place)
        tone = 1.0 + 0.2 * uneven(column, row)
        tone = tone + 0.08 * noise(board, 0.6) + 0.08 * noise(board, 0.03)
        width = 0.5 * max(joint_m, board.width_m / board.columns)
        off = np.minimum(place - column, column + 1.0 - place) * slab_m[0]
        off_row = board.up_m / slab_m[1] - row
        off_row = np.minimum(off_row, 1.0 - off_row) * slab_m[1]
        joint = np.clip(1.5 - np.minimum(off, off_row) / width, 0.0, 1.0) * min(
            1.0, joint_m / (2.0 * width)
        )
        return _toned(colour, (tone * (1.0 - 0.5 * joint)).astype(np.float32))

    return paint


def asphalt(line_at_m: float | None = None) -> Painter:
    """Return a painter of a road along the picture, with a broken line so far above its foot."""

    def paint(board: Board) -> Floats:
        tone = 1.0 + 0.12 * noise(board, 3.0) + 0.1 * noise(board, 0.4) + 0.25 * noise(board, 0.03)
        picture = _toned((0.095, 0.095, 0.1), tone)
        if line_at_m is not None:
            width = max(0.12, board.height_m / board.rows)
            on = np.abs(board.up_m - line_at_m) < 0.5 * width
            picture = np.where((on & ((board.across_m % 6.0) < 3.0))[..., None], 0.55, picture)
        return picture.astype(np.float32)

    return paint


def boards(colour: Rgb, width_m: float = 0.12) -> Painter:
    """Return a painter of upright boards with gaps between them."""

    def paint(board: Board) -> Floats:
        number = np.floor(board.across_m / width_m)
        within = board.across_m / width_m - number
        gap = np.where(np.minimum(within, 1.0 - within) < 0.06, 0.35, 1.0)
        tone = gap * (1.0 + 0.25 * uneven(number))
        return _toned(colour, (tone * (1.0 + 0.1 * noise(board, 0.25))).astype(np.float32))

    return paint


def tiles(colour: Rgb) -> Painter:
    """Return a painter of roof tiles in rows."""

    def paint(board: Board) -> Floats:
        row = np.floor(board.up_m / 0.3)
        within = board.up_m / 0.3 - row
        place = board.across_m / 0.22 + 0.5 * (row % 2)
        round_ = 0.85 + 0.3 * np.sin(np.pi * (place - np.floor(place)))
        tone = (0.72 + 0.4 * within) * round_ * (1.0 + 0.25 * uneven(np.floor(place), row))
        tone = tone * (1.0 + 0.1 * noise(board, 1.5))
        return _toned(colour, tone.astype(np.float32))

    return paint


def foliage(colour: Rgb) -> Painter:
    """Return a painter of a hedge: leaves in front of the dark between them."""

    def paint(board: Board) -> Floats:
        leaf = 0.9 * noise(board, 0.03) + 0.6 * noise(board, 0.08) + 0.35 * noise(board, 0.25)
        deep = np.clip(0.8 + 0.95 * leaf, 0.12, 2.2) * (1.0 + 0.15 * noise(board, 0.8))
        return _toned(colour, deep.astype(np.float32))

    return paint


def leaves(
    edge_px: int, colour: Rgb, light: float, count: int, rng: np.random.Generator
) -> NDArray[np.float32]:
    """Return (edge, edge, 4): a spray of leaves as cards show it, radiance and alpha 0 or 1."""
    base = np.asarray(colour, np.float32)
    picture = np.zeros((edge_px, edge_px, 4), np.float32)
    picture[..., :3] = base * 0.6 * light
    rows, columns = np.mgrid[0:edge_px, 0:edge_px].astype(np.float32)
    for _ in range(count):
        # Denser in the middle, none beyond the edge.
        turn, reach = rng.uniform(0.0, 2.0 * np.pi), 0.43 * rng.uniform(0.0, 1.0) ** 0.6
        x = (0.5 + reach * np.cos(turn)) * edge_px
        y = (0.5 + reach * np.sin(turn)) * edge_px
        lean, long = rng.uniform(0.0, np.pi), rng.uniform(0.028, 0.05) * edge_px
        box = np.s_[
            max(0, int(y - long)) : int(y + long) + 2, max(0, int(x - long)) : int(x + long) + 2
        ]
        dx, dy = columns[box] - x, rows[box] - y
        a = (dx * np.cos(lean) + dy * np.sin(lean)) / long
        b = (dy * np.cos(lean) - dx * np.sin(lean)) / (0.5 * long)
        inside = a * a + b * b < 1.0
        tone = (
            rng.uniform(0.55, 1.35)
            * light
            * np.asarray((rng.uniform(0.9, 1.25), 1.0, rng.uniform(0.7, 1.1)), np.float32)
        )
        picture[box][inside] = (*(base * tone), 1.0)
    return picture
