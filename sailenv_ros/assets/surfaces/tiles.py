"""Tiled surfaces: glazed squares, metro tiles in bond, floor stone. A colour in, maps out.

Each tile has its own tone and is laid a fraction of a degree askew, which is what makes the
reflections of a real wall of tiles break up.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.surfaces.maps import Floats, SurfaceMaps
from sailenv_ros.assets.surfaces.noise import (
    SIZE_PX,
    banded,
    blurred,
    cloudy,
    grid,
    mixed,
    ramp,
    shifted,
)

__all__ = ["glazed_squares", "metro", "stone"]

_GROUT = np.array([0.52, 0.50, 0.47], dtype=np.float32)


@dataclass(frozen=True, eq=False, slots=True)
class _Laid:
    """The tile that each pixel belongs to, and its place in that tile; arrays are (H, W) [m]."""

    number: NDArray[np.intp]
    x: Floats
    y: Floats
    edge: Floats


def glazed_squares(rng: np.random.Generator, colour: Floats) -> SurfaceMaps:
    """Glazed wall tiles of 15 cm with joints of 3 mm."""
    tile_m = (1.2, 1.2)
    laid = _laid(tile_m, columns=8, rows=8, bond=0.0)
    return _glazed(rng, colour, laid, tile_m, joint_m=0.003, cushion_m=0.004)


def metro(rng: np.random.Generator, colour: Floats) -> SurfaceMaps:
    """Bevelled tiles of 20 by 10 cm in half bond with joints of 2.5 mm."""
    tile_m = (0.8, 0.8)
    laid = _laid(tile_m, columns=4, rows=8, bond=0.5)
    return _glazed(rng, colour, laid, tile_m, joint_m=0.0025, cushion_m=0.012)


def stone(rng: np.random.Generator, colour: Floats) -> SurfaceMaps:
    """Honed limestone slabs of 45 cm with joints of 3 mm: clouds, veins, small fossils."""
    tile_m = (1.8, 1.8)
    laid = _laid(tile_m, columns=4, rows=4, bond=0.0)
    clouds = shifted(cloudy(rng, 1.7), laid.number, rng)
    bends = shifted(cloudy(rng, 1.3), laid.number, rng)
    grain = banded(rng, 1.2, 3.5)
    veins = np.exp(-((bends / 0.07) ** 2)) * ramp(clouds, -0.3, 1.2)
    fossils = ramp(shifted(banded(rng, 4.0, 12.0), laid.number, rng), 2.0, 2.9)
    tone = _of_tile(rng.normal(0.0, 0.045, 16), laid)
    light = 1.0 + tone + 0.075 * clouds + 0.02 * grain - 0.13 * veins + 0.10 * fossils
    warm = np.array([0.9, 1.0, 1.25], dtype=np.float32)
    albedo = colour * np.maximum(light, 0.2)[..., np.newaxis] ** warm
    joint = _joint(laid, 0.003, tile_m)
    height = _profile(laid, 0.003, 0.003, 0.0009) + _askew(rng, laid, 0.0015)
    return SurfaceMaps(
        albedo=mixed(albedo.astype(np.float32), _GROUT * np.float32(0.7), joint),
        height_m=(height + 0.000008 * grain).astype(np.float32),
        roughness=(0.34 + 0.04 * clouds + 0.5 * joint).astype(np.float32),
        tile_m=tile_m,
    )


def _glazed(
    rng: np.random.Generator,
    colour: Floats,
    laid: _Laid,
    tile_m: tuple[float, float],
    *,
    joint_m: float,
    cushion_m: float,
) -> SurfaceMaps:
    count = int(laid.number.max()) + 1
    tone = _of_tile(rng.normal(0.0, 0.018, count), laid)
    pooled = ramp(laid.edge, joint_m / 2 + cushion_m, joint_m / 2)
    light = 1.0 + tone - 0.05 * pooled + 0.006 * cloudy(rng, 1.5)
    joint = _joint(laid, joint_m, tile_m)
    dirt = 1.0 + 0.10 * cloudy(rng, 1.2)
    grout = _GROUT * dirt[..., np.newaxis].astype(np.float32)
    height = _profile(laid, joint_m, cushion_m, 0.0011) + _askew(rng, laid, 0.003)
    height = height + 0.00012 * blurred(rng, 40.0) + 0.0001 * joint * banded(rng, 1.0, 2.5)
    return SurfaceMaps(
        albedo=mixed((colour * light[..., np.newaxis]).astype(np.float32), grout, joint),
        height_m=height.astype(np.float32),
        roughness=(0.10 + 0.02 * pooled + 0.80 * joint).astype(np.float32),
        tile_m=tile_m,
    )


def _laid(tile_m: tuple[float, float], *, columns: int, rows: int, bond: float) -> _Laid:
    """Lay tiles in rows, each second one moved by a share of a tile."""
    width, height = np.float32(tile_m[0] / columns), np.float32(tile_m[1] / rows)
    x, y = grid(tile_m)
    row = np.floor(y / height).astype(np.intp)
    moved = x / width + np.float32(bond) * (row % 2).astype(np.float32)
    column = np.floor(moved).astype(np.intp)
    in_x = (moved - column - np.float32(0.5)) * width
    in_y = y - (row + np.float32(0.5)) * height
    in_x, in_y = np.broadcast_arrays(in_x, in_y.astype(np.float32))
    edge = np.minimum(width / 2 - np.abs(in_x), height / 2 - np.abs(in_y))
    number = np.broadcast_to(row * columns + column % columns, (SIZE_PX, SIZE_PX))
    return _Laid(number, in_x, in_y, edge)


def _joint(laid: _Laid, joint_m: float, tile_m: tuple[float, float]) -> Floats:
    """Return how much of each pixel is joint, 0 to 1."""
    soft = 0.6 * tile_m[0] / SIZE_PX
    return ramp(laid.edge, joint_m / 2 + soft, joint_m / 2 - soft)


def _profile(laid: _Laid, joint_m: float, cushion_m: float, depth_m: float) -> Floats:
    """Return the height of tiles that slope down to their joints over the cushion's width."""
    low, high = joint_m / 2, joint_m / 2 + cushion_m
    share = np.clip((laid.edge - low) / (high - low), 0.0, 1.0)
    round_ = np.sqrt(np.maximum(0.0, 1.0 - (1.0 - share) ** 2))
    height: Floats = (depth_m * (round_ - 1.0)).astype(np.float32)
    return height


def _askew(rng: np.random.Generator, laid: _Laid, slope: float) -> Floats:
    """Return the height of tiles that lean by slopes of this spread."""
    lean = rng.normal(0.0, slope, (2, int(laid.number.max()) + 1))
    return _of_tile(lean[0], laid) * laid.x + _of_tile(lean[1], laid) * laid.y


def _of_tile(values: NDArray[np.floating], laid: _Laid) -> Floats:
    return values.astype(np.float32)[laid.number]
