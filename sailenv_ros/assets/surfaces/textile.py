"""Soft and papered surfaces: carpet, striped and damask wallpaper. A colour in, maps out."""

from __future__ import annotations

import numpy as np

from sailenv_ros.assets.surfaces.maps import Floats, SurfaceMaps
from sailenv_ros.assets.surfaces.noise import SIZE_PX, banded, cloudy, grid, mixed, ramp

__all__ = ["carpet", "wallpaper_damask", "wallpaper_stripes"]

_PAPER_M = 0.52


def carpet(rng: np.random.Generator, colour: Floats) -> SurfaceMaps:
    """Cut pile: tufts of 4 mm, yarns of slightly different tone, traces of brushing."""
    tufts = banded(rng, 4.0, 9.0)
    fibres = banded(rng, 1.0, 2.2)
    yarns = banded(rng, 5.0, 12.0)
    brushed = cloudy(rng, 1.6)
    deep = ramp(tufts, 0.4, -1.8)
    light = (1.0 + 0.07 * yarns + 0.08 * fibres + 0.04 * brushed) * (1.0 - 0.5 * deep)
    return SurfaceMaps(
        albedo=(1.12 * colour * np.maximum(light, 0.1)[..., np.newaxis]).astype(np.float32),
        height_m=(0.0004 * tufts + 0.00012 * fibres).astype(np.float32),
        roughness=np.full(tufts.shape, 1.0, np.float32),
        tile_m=(0.8, 0.8),
    )


def wallpaper_stripes(rng: np.random.Generator, colour: Floats) -> SurfaceMaps:
    """Broad stripes of two tones with a fine line at each side; satin on matt."""
    x, _ = grid((_PAPER_M, _PAPER_M))
    period = _PAPER_M / 4
    place = np.broadcast_to(x % np.float32(period), (SIZE_PX, SIZE_PX))
    from_middle = np.abs(place - np.float32(period / 2))
    satin = ramp(from_middle, 0.0330, 0.0323)
    line = ramp(np.abs(from_middle - np.float32(0.0385)), 0.0016, 0.0010)
    paper = _paper(rng)
    albedo = mixed(colour, colour * np.float32(0.74), satin)
    albedo = mixed(albedo, colour * np.float32(0.50), line)
    return SurfaceMaps(
        albedo=(albedo * (1.0 + 0.015 * paper)[..., np.newaxis]).astype(np.float32),
        height_m=(0.000006 * paper + 0.00004 * satin).astype(np.float32),
        roughness=(0.75 - 0.30 * satin - 0.2 * line).astype(np.float32),
        tile_m=(_PAPER_M, _PAPER_M),
    )


def wallpaper_damask(rng: np.random.Generator, colour: Floats) -> SurfaceMaps:
    """Mirrored foliage in pointed ovals, each second column half a repeat higher."""
    across, up, inside = _ovals()
    figure = _foliage(rng, across, up, inside)
    paper = _paper(rng)
    albedo = mixed(colour, colour * np.array([0.70, 0.70, 0.68], np.float32), figure)
    return SurfaceMaps(
        albedo=(albedo * (1.0 + 0.015 * paper)[..., np.newaxis]).astype(np.float32),
        height_m=(0.000006 * paper + 0.00012 * figure).astype(np.float32),
        roughness=(0.78 - 0.36 * figure).astype(np.float32),
        tile_m=(_PAPER_M, _PAPER_M),
    )


def _ovals() -> tuple[Floats, Floats, Floats]:
    """Cut the plane into ovals that fit into each other.

    Returns
    -------
    across : (H, W) float32
        Distance from the oval's axis, in widths of a column.
    up : (H, W) float32
        Place along the axis, -0.5 to 0.5, the oval's middle at 0.
    inside : (H, W) float32
        Distance from the outline, in widths of a column.
    """
    share = (np.arange(SIZE_PX, dtype=np.float32) + np.float32(0.5)) / np.float32(SIZE_PX)
    x, y = np.meshgrid(2.0 * share, share)
    from_even = np.minimum(x, 2.0 - x)
    outline = _half_width(y)
    even = from_even < outline
    across = np.where(even, from_even, 1.0 - from_even)
    inside = np.where(even, outline - from_even, from_even - outline)
    up = (np.where(even, y, y + 0.5) + 0.5) % 1.0 - 0.5
    return across.astype(np.float32), up.astype(np.float32), inside.astype(np.float32)


def _half_width(up: Floats) -> Floats:
    turn = np.float32(2.0 * np.pi) * up
    width: Floats = 0.5 + 0.40 * np.cos(turn) + 0.05 * np.cos(3.0 * turn)
    return width


def _foliage(rng: np.random.Generator, across: Floats, up: Floats, inside: Floats) -> Floats:
    """Draw frame, palmette and leaves; 1 where the figure is."""
    pixel = 2.0 / SIZE_PX
    frame = ramp(np.abs(inside - 0.085), 0.030 + pixel, 0.030 - pixel)
    beads = np.cos(2.0 * np.pi * 22.0 * up)
    frame = frame * ramp(beads, -0.75, -0.6) + ramp(inside, 0.016, 0.012)
    # Petals around the middle, long ones upwards.
    radius, angle = np.hypot(across, 1.9 * up), np.arctan2(across, 1.9 * up)
    petals = 0.30 + 0.11 * np.cos(8.0 * angle) + 0.10 * np.cos(angle)
    palmette = ramp(radius, petals + 0.008, petals - 0.008)
    veins = ramp(np.abs(np.sin(4.0 * angle)) * radius, 0.016, 0.030)
    heart = ramp(np.abs(radius - 0.085), 0.012, 0.020)
    leaves = banded(rng, 26.0, 60.0)
    mirrored = _picked(leaves, 0.5 * across, up)
    tendrils = ramp(np.abs(mirrored - 0.3), 0.50, 0.42) * ramp(inside, 0.14, 0.15)
    outside = ramp(radius, petals + 0.03, petals + 0.04)
    figure = np.maximum(frame, palmette * veins * heart)
    drawn: Floats = np.clip(np.maximum(figure, tendrils * outside), 0.0, 1.0)
    return drawn.astype(np.float32, copy=False)


def _picked(field: Floats, across: Floats, up: Floats) -> Floats:
    rows = (up * SIZE_PX).astype(np.intp) % SIZE_PX
    columns = (across * SIZE_PX).astype(np.intp) % SIZE_PX
    picked: Floats = field[rows, columns]
    return picked


def _paper(rng: np.random.Generator) -> Floats:
    return banded(rng, 1.5, 5.0)
