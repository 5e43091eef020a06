"""Wooden floors: planks, and parquet in herringbone. A colour in, `SurfaceMaps` out.

A board is cut from a trunk: its figure is where the annual rings meet its face. Every board has
its own place in the trunk, its own tone and its own fibres.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.surfaces.maps import Floats, SurfaceMaps
from sailenv_ros.assets.surfaces.noise import (
    SIZE_PX,
    blurred,
    grid,
    mixed,
    ramp,
    shifted,
)

__all__ = ["herringbone", "planks"]

_PLANKS_M = (2.4, 1.2)
_ROWS = 8
_PARQUET_M = (1.44, 1.44)
_CELLS = 24
_BLOCK_CELLS = 6
_BEVEL_M = 0.0022
_BEVEL_DEPTH_M = 0.0006


@dataclass(frozen=True, eq=False, slots=True)
class _Boards:
    """The board that each pixel belongs to, and its place in that board; arrays are (H, W).

    Attributes
    ----------
    number : int
    along, across : float32
        Place in the board, from its end and from its middle line [m].
    edge : float32
        Distance from the nearest edge [m].
    runs_down : bool
        True if its fibres run along the rows' axis.
    """

    number: NDArray[np.intp]
    along: Floats
    across: Floats
    edge: Floats
    runs_down: NDArray[np.bool_]


def planks(rng: np.random.Generator, colour: Floats) -> SurfaceMaps:
    """Long boards, 15 cm wide, with joints at random places."""
    boards = _rows_of_planks(rng)
    return _wooden(rng, colour, boards, _PLANKS_M)


def herringbone(rng: np.random.Generator, colour: Floats) -> SurfaceMaps:
    """Blocks of 6 by 36 cm that meet at right angles, laid at 45 degrees."""
    boards = _herringbone_blocks()
    return _wooden(rng, colour, boards, _PARQUET_M, turn_deg=45.0)


def _rows_of_planks(rng: np.random.Generator) -> _Boards:
    x, y = grid(_PLANKS_M)
    length, width = _PLANKS_M[0], _PLANKS_M[1] / _ROWS
    row = np.broadcast_to(np.floor(y / np.float32(width)).astype(np.intp), (SIZE_PX, SIZE_PX))
    # Each row is cut twice around its ring of 2.4 m; neighbours' joints keep apart.
    start = (np.arange(_ROWS) * 0.382 * length + rng.uniform(-0.15, 0.15, _ROWS)).astype(np.float32)
    cut = rng.uniform(0.40, 0.60, _ROWS).astype(np.float32) * np.float32(length)
    around = (x - start[row]) % np.float32(length)
    second = around >= cut[row]
    along = np.where(second, around - cut[row], around)
    rest = np.where(second, np.float32(length) - around, cut[row] - around)
    across = y - (row.astype(np.float32) + np.float32(0.5)) * np.float32(width)
    edge = np.minimum(np.minimum(along, rest), np.float32(width / 2) - np.abs(across))
    return _Boards(2 * row + second, along, across, edge, np.zeros(row.shape, bool))


def _herringbone_blocks() -> _Boards:
    """Cut a grid of cells into blocks: along a row, k cells of one block, then k of k others."""
    x, y = grid(_PARQUET_M)
    cell = np.float32(_PARQUET_M[0] / _CELLS)
    column = np.floor(x / cell).astype(np.intp)
    row = np.floor(y / cell).astype(np.intp)
    step = (column - row) % (2 * _BLOCK_CELLS)
    down = step >= _BLOCK_CELLS
    offset = np.where(down, 2 * _BLOCK_CELLS - 1 - step, step)
    first_column = np.where(down, column, (column - offset) % _CELLS)
    first_row = np.where(down, (row - offset) % _CELLS, row)
    in_x, in_y = x / cell - column, y / cell - row
    along = (np.where(down, in_y, in_x) + offset) * cell
    across = (np.where(down, in_x, in_y) - np.float32(0.5)) * cell
    rest = np.float32(_BLOCK_CELLS) * cell - along
    edge = np.minimum(np.minimum(along, rest), cell / 2 - np.abs(across))
    names, number = np.unique(first_row * _CELLS + first_column, return_inverse=True)
    del names
    return _Boards(
        number.reshape(down.shape).astype(np.intp),
        along.astype(np.float32),
        across.astype(np.float32),
        edge.astype(np.float32),
        down,
    )


def _wooden(
    rng: np.random.Generator,
    colour: Floats,
    boards: _Boards,
    tile_m: tuple[float, float],
    turn_deg: float = 0.0,
) -> SurfaceMaps:
    pixel = np.float32(tile_m[1] / SIZE_PX)
    fibres = _in_boards(rng, boards, 60.0, 1.2)
    pores = ramp(_in_boards(rng, boards, 9.0, 0.9), 0.9, 2.2)
    rings = _rings(rng, boards)
    count = int(boards.number.max()) + 1
    tone = rng.normal(0.0, 0.13, count).astype(np.float32)[boards.number]
    warmth = rng.normal(0.0, 0.03, count).astype(np.float32)[boards.number]
    light = 1.0 + tone + 0.06 * fibres + 0.22 * (0.45 - rings) - 0.20 * pores
    light = np.maximum(light, 0.25).astype(np.float32)
    # What is darker is redder: late wood and pores take more of the oil.
    power = np.array([0.82, 1.0, 1.16], dtype=np.float32)
    albedo = colour * light[..., np.newaxis] ** power
    albedo = albedo * np.stack([1.0 + warmth, np.ones_like(warmth), 1.0 - warmth], axis=-1)
    joint = ramp(boards.edge, 1.2 * float(pixel), 0.3 * float(pixel))
    albedo = mixed(albedo, colour * np.float32(0.12), joint * np.float32(0.85))
    height = -_BEVEL_DEPTH_M * (1.0 - ramp(boards.edge, 0.0, _BEVEL_M))
    height = height - 0.00006 * pores - 0.00003 * rings + 0.000012 * fibres
    roughness = 0.36 + 0.10 * pores + 0.06 * rings + 0.35 * joint + 0.02 * fibres
    return SurfaceMaps(
        albedo=albedo.astype(np.float32),
        height_m=height.astype(np.float32),
        roughness=roughness.astype(np.float32),
        tile_m=tile_m,
        turn_deg=turn_deg,
    )


def _in_boards(
    rng: np.random.Generator, boards: _Boards, along_px: float, across_px: float
) -> Floats:
    """Make noise that is stretched along the fibres, different in each board."""
    field = blurred(rng, along_px, across_px)
    lying = shifted(field, boards.number, rng)
    if not boards.runs_down.any():
        return lying
    standing = shifted(np.ascontiguousarray(field.T), boards.number, rng)
    return np.where(boards.runs_down, standing, lying)


def _rings(rng: np.random.Generator, boards: _Boards) -> Floats:
    """Return the late wood, 0 to 1: rings around a pith that lies below and beside the board."""
    count = int(boards.number.max()) + 1

    def of_board(values: NDArray[np.floating]) -> Floats:
        return values.astype(np.float32)[boards.number]

    beside = of_board(rng.normal(0.0, 0.05, count))
    below = of_board(rng.uniform(0.01, 0.09, count))
    tilt = of_board(rng.normal(0.0, 0.035, count))
    period = of_board(rng.uniform(0.005, 0.011, count))
    wave = _in_boards(rng, boards, 150.0, 40.0)
    depth = below + tilt * boards.along + np.float32(0.006) * wave
    radius = np.hypot(boards.across - beside, depth)
    phase = radius / period + np.float32(0.12) * wave
    share = phase - np.floor(phase)
    late: Floats = share * share * ramp(share, 1.0, 0.9)
    return late
