"""Tables of lenses that bend straight lines: where each sample of a picture looks.

A lens comes in, the tables that the native renderer draws with go out. Rays are places on faces of
a cube around the eye, on which straight lines are straight (src/kernels/lens_table.h).
"""

from __future__ import annotations

import threading
from collections import deque
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.lens_rays import rays_of_fine_samples, unit_rays
from sailenv_ros.native.lens_tables import (
    BLOCK_CELLS,
    CUBE_FACE,
    CUBE_FACES,
    FACE_CELLS,
    FACE_NODE,
    LENS_GROUP_SHAPE,
    LENS_TABLE,
    LENS_TILE_SHAPE,
    LENS_TILES,
    UNKNOWN_BEND,
)
from sailenv_ros.native.render_types import address, record
from sailenv_ros.types.camera import CameraIntrinsics

__all__ = ["FACE_TURNS", "LensSamples", "lens_samples", "lens_tables"]

FACE_TURNS = np.array(
    [
        [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
        [[0, 0, -1], [0, 1, 0], [1, 0, 0]],
        [[0, 0, 1], [0, 1, 0], [-1, 0, 0]],
        [[1, 0, 0], [0, 0, -1], [0, 1, 0]],
        [[1, 0, 0], [0, 0, 1], [0, -1, 0]],
        [[-1, 0, 0], [0, 1, 0], [0, 0, -1]],
    ],
    np.float64,
)
"""The frames of the faces from the optical frame: ahead, right, left, down, up, behind."""

MOST_ALONE_DEG = 68.0
"""Up to this angle from the axis the face ahead shows all of the picture."""

ROW_PADDING, ROW_STEP = 8, 16
"""Numbers behind a row at least, and of what number rows are multiples."""

MARGIN_CELLS = 4
"""Cells of a face's grid beyond its samples, on each side."""

MOST_BEND = 8.0
"""Greatest known bend [samples]: where straight lines bend more, or the picture ends, cells list
the samples that lie in them."""

Doubles = NDArray[np.float64]


class _LatestTables(threading.local):
    """Tables that each thread has asked for last: they outlive the next drawing of the thread."""

    def __init__(self) -> None:
        self.kept: deque[LensSamples] = deque(maxlen=4)


_latest = _LatestTables()


@dataclass(frozen=True, eq=False, slots=True)
class LensSamples:
    """Table of a lens for some samples: pixels' centres, or the fine samples of smooth edges.

    Attributes
    ----------
    table : (1,) LENS_TABLE
    x, y : (R, S) float32
        Places on faces; NaN where the lens sees nothing, and behind the samples of a row.
    face : (R, S) uint8
    """

    table: NDArray[np.void]
    x: NDArray[np.float32]
    y: NDArray[np.float32]
    face: NDArray[np.uint8]
    _kept: tuple[NDArray[Any], ...]


def lens_tables(lens: CameraIntrinsics, smooth_edges: bool) -> dict[str, int]:
    """Return the fields of VIEW that a lens has which bends straight lines.

    They hold until the thread has asked for the tables of another camera.
    """
    fields = {}
    for name, fine in (("table_at", False), ("fine_table_at", True)):
        if smooth_edges or not fine:
            samples = lens_samples(lens, fine)
            _latest.kept.append(samples)
            fields[name] = address(samples.table)
    return fields


@lru_cache(maxsize=8)
def lens_samples(lens: CameraIntrinsics, fine: bool = False) -> LensSamples:
    """Return the table of a lens.

    Parameters
    ----------
    lens : CameraIntrinsics
    fine : bool
        Of fine samples, see `fine_sample_places`.
    """
    pixels = None if not fine else lens_samples(lens)
    rays = unit_rays(lens) if pixels is None else rays_of_fine_samples(lens)
    alone = _sees_ahead_alone(unit_rays(lens))
    rows, columns = rays.shape[:2]
    stride = -(-(columns + ROW_PADDING) // ROW_STEP) * ROW_STEP
    x, y = np.full((2, rows, stride), np.nan, np.float32)
    face = np.zeros((rows, stride), np.uint8)
    if alone:
        x[:, :columns], y[:, :columns] = _places(rays, 0)
    else:
        face[:, :columns] = _faces_of(rays)
        for number in range(CUBE_FACES):
            here = face[:, :columns] == number
            if here.any():
                at_x, at_y = _places(rays[here], number)
                x[:, :columns][here], y[:, :columns][here] = at_x, at_y
    if pixels is None:
        steps = _steps(rays, face[:, :columns], stride)
    else:
        # The same bytes, whatever is computed beside them.
        for of_samples, of_pixels in ((x, pixels.x), (y, pixels.y), (face, pixels.face)):
            of_samples[1:rows:2, 1:columns:2] = of_pixels[:, : lens.width]
        steps = pixels._kept[0]
    tiles = _tiles(x[:, :columns], y[:, :columns], face[:, :columns])
    cube = np.zeros(CUBE_FACES, CUBE_FACE)
    kept: list[NDArray[Any]] = [steps, tiles, cube]
    for number in range(CUBE_FACES):
        cube["turn"][number] = FACE_TURNS[number].reshape(-1)
        here = (face == number) & np.isfinite(x)
        if here.any():
            kept += _grid(cube[number : number + 1], lens, number, here, x[here], y[here], fine)
        else:
            cube["all"][number] = 1, 1, 0, 0
    table = record(
        LENS_TABLE,
        x_at=address(x),
        y_at=address(y),
        face_at=address(face),
        steps_at=address(steps),
        tiles_at=address(tiles),
        faces_at=address(cube),
        stride=stride,
        tile_groups=tiles.shape[1],
        rows=rows,
        columns=columns,
        step_stride=8 * steps.shape[1],
        step_rows=steps.shape[0],
        several=not alone,
        fine=fine,
    )
    return LensSamples(table, x, y, face, tuple(kept))


def _sees_ahead_alone(rays: Doubles) -> bool:
    across = np.hypot(rays[..., 0], rays[..., 1])
    angle = np.degrees(np.arctan2(across, rays[..., 2]))
    return bool(np.nanmax(angle, initial=0.0) <= MOST_ALONE_DEG)


def _faces_of(rays: Doubles) -> NDArray[np.uint8]:
    """Return the face of each ray (R, C, 3): the axis that it follows most, the first of equals."""
    x, y, z = (np.ascontiguousarray(part) for part in np.moveaxis(rays, -1, 0))
    faces, most = np.zeros(z.shape, np.uint8), z.copy()
    for number, along in enumerate((x, -x, y, -y, -z), 1):
        np.putmask(faces, along > most, number)
        np.maximum(most, along, out=most)
    return faces


def _places(rays: Doubles, face: int) -> tuple[Doubles, Doubles]:
    """Return x and y of rays (..., 3) on a face; NaN where they do not lead there."""
    # Turns of faces exchange axes and their signs alone.
    axes = np.abs(FACE_TURNS[face]).argmax(axis=1)
    x, y, z = (rays[..., axis] * FACE_TURNS[face][k, axis] for k, axis in enumerate(axes))
    z[~(z > 0.0)] = np.nan
    return x / z, y / z


def _steps(rays: Doubles, faces: NDArray[np.uint8], stride: int) -> NDArray[np.float32]:
    """Return (H, S / 8, 4, 8): how places change from pixel to pixel.

    Of eight pixels side by side: x and y to the right, x and y downwards.
    """
    height, width = faces.shape
    steps = np.zeros((4, height, stride), np.float32)
    for number in range(CUBE_FACES):
        here = faces == number
        if not here.any():
            continue
        places = np.stack(_places(rays, number), axis=-1)
        found = np.concatenate([_mean_steps(places, 1), _mean_steps(places, 0)], axis=-1)
        steps[:, :, :width][:, here] = found[here].T
    return np.ascontiguousarray(steps.reshape(4, height, -1, 8).transpose(1, 2, 0, 3))


def _mean_steps(places: Doubles, axis: int) -> Doubles:
    """Return the mean of the differences to both neighbours along an axis, of those there are."""
    step = np.diff(places, axis=axis)
    known = np.isfinite(step)
    step = np.where(known, step, 0.0)
    widths = [(0, 0)] * places.ndim
    sums, counts = np.zeros_like(places), np.zeros(places.shape)
    for side in ((1, 0), (0, 1)):
        widths[axis] = side
        sums += np.pad(step, widths)
        counts += np.pad(known, widths)
    return sums / np.maximum(counts, 1.0)


def _tiles(
    x: NDArray[np.float32], y: NDArray[np.float32], face: NDArray[np.uint8]
) -> NDArray[np.void]:
    """Return (rows, columns) of groups as LENS_TILES: of the tiles' rows and the next one.

    Bands of fine samples end with the first row of the next tile.
    """
    high, wide = LENS_TILE_SHAPE
    down, across = (-(-count // size) for count, size in zip(x.shape, LENS_TILE_SHAPE, strict=True))
    group_rows, group_columns = LENS_GROUP_SHAPE
    rows, columns = -(-down // group_rows), -(-across // group_columns)
    down, across = rows * group_rows, columns * group_columns
    widths = (0, down * high - x.shape[0]), (0, across * wide - x.shape[1])

    def split(values: NDArray[Any], filling: float) -> NDArray[Any]:
        padded = np.pad(values, widths, constant_values=filling).reshape(down, high, across, wide)
        own = padded.transpose(1, 3, 0, 2)
        below = np.full_like(own[:1], filling)
        below[:, :, :-1] = own[:1, :, 1:]
        samples = np.concatenate([own, below]).reshape(-1, rows, group_rows, columns, group_columns)
        return samples.transpose(0, 1, 3, 2, 4).reshape(
            -1, rows, columns, group_rows * group_columns
        )

    places = [split(values, np.nan) for values in (x, y)]
    bits = np.left_shift(1, split(face, 0), dtype=np.int32)
    bits[np.isnan(places[0])] = 0
    tiles = np.zeros((rows, columns), LENS_TILES)
    tiles["faces"] = np.bitwise_or.reduce(bits, axis=0)
    alone = (tiles["faces"] & (tiles["faces"] - 1)) == 0
    for name, own in zip("xy", places, strict=True):
        low, most = np.fmin.reduce(own, axis=0), np.fmax.reduce(own, axis=0)
        tiles["low_" + name] = np.where(alone, low, -np.inf)
        tiles["high_" + name] = np.where(alone, most, np.inf)
    return tiles


def _grid(
    face: NDArray[np.void],
    lens: CameraIntrinsics,
    number: int,
    here: NDArray[np.bool_],
    x: NDArray[np.float32],
    y: NDArray[np.float32],
    fine: bool,
) -> list[NDArray[Any]]:
    """Fill in a face (1,) CUBE_FACE whose samples lie at x and y, and return what it points to."""
    low = np.array([x.min(), y.min()], np.float64)
    high = np.array([x.max(), y.max()], np.float64)
    cell = np.maximum(high - low, 1e-6) / (FACE_CELLS - 2 * MARGIN_CELLS)
    origin = low - MARGIN_CELLS * cell
    rows, columns = np.nonzero(here)
    face["low"], face["high"], face["origin"], face["per"] = low, high, origin, 1.0 / cell
    face["all"] = columns.min(), rows.min(), columns.max(), rows.max()
    cells = _cells(np.stack([(x - origin[0]) / cell[0], (y - origin[1]) / cell[1]]), rows, columns)
    groups = cells.reshape(*(FACE_CELLS // BLOCK_CELLS, BLOCK_CELLS) * 2, 4)
    blocks = np.empty((*groups.shape[:3:2], 4), np.int16)
    blocks[..., :2] = groups[..., :2].min(axis=(1, 3))
    blocks[..., 2:] = groups[..., 2:].max(axis=(1, 3))
    nodes = _nodes(lens, number, origin, cell, fine)
    for name, array in (("nodes_at", nodes), ("cells_at", cells), ("blocks_at", blocks)):
        face[name] = address(array)
    return [nodes, cells, blocks]


def _cells(
    places: Doubles, rows: NDArray[np.int64], columns: NDArray[np.int64]
) -> NDArray[np.int16]:
    """Return (cells, cells, 4): first column and row, last column and row of samples in a cell."""
    across, down = np.clip(places.astype(np.int64), 0, FACE_CELLS - 1)
    cell = down * FACE_CELLS + across
    boxes = np.full((FACE_CELLS * FACE_CELLS, 4), -1, np.int16)
    boxes[:, :2] = np.iinfo(np.int16).max
    for k, values in enumerate((columns, rows)):
        np.minimum.at(boxes[:, k], cell, values.astype(np.int16))
        np.maximum.at(boxes[:, 2 + k], cell, values.astype(np.int16))
    return boxes.reshape(FACE_CELLS, FACE_CELLS, 4)


def _nodes(
    lens: CameraIntrinsics, number: int, origin: Doubles, cell: Doubles, fine: bool
) -> NDArray[np.void]:
    """Return (cells + 1, cells + 1) FACE_NODE."""
    at = np.arange(FACE_CELLS + 1)
    x, y = np.meshgrid(origin[0] + at * cell[0], origin[1] + at * cell[1])
    rays = np.stack([x, y, np.ones_like(x)], axis=-1) @ FACE_TURNS[number]
    pixels = lens.project(rays)
    samples = 2.0 * pixels + 1.0 if fine else pixels
    bend = np.pad(np.abs(np.diff(samples, 2, axis=0)), ((1, 1), (0, 0), (0, 0)), mode="edge")
    bend += np.pad(np.abs(np.diff(samples, 2, axis=1)), ((0, 0), (1, 1), (0, 0)), mode="edge")
    twist = np.abs(np.diff(np.diff(samples, axis=0), axis=1))
    corners = [
        bend[down : down + FACE_CELLS, right : right + FACE_CELLS]
        for down in (0, 1)
        for right in (0, 1)
    ]
    # Not a number, where the lens does not map, is not less than anything.
    of_cells = (np.max(corners, axis=0) + 2.0 * twist).max(axis=-1)
    of_cells = np.where(of_cells <= MOST_BEND, of_cells, UNKNOWN_BEND).astype(np.float32)
    nodes = np.zeros((FACE_CELLS + 1, FACE_CELLS + 1), FACE_NODE)
    nodes["u"], nodes["v"] = np.moveaxis(np.nan_to_num(samples), -1, 0)
    for name, reach in (("bend", 1), ("wide_bend", MARGIN_CELLS)):
        size = 2 * reach + 1
        nodes[name][:-1, :-1] = cv2.dilate(of_cells, np.ones((size, size), np.uint8))
    return nodes
