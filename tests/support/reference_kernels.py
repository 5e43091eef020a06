"""Reference implementation of the native kernels in plain NumPy, which defines their results.

Each function takes and returns what the function of the same name in `sailenv_ros.native` does, and
the same bytes: tests compare them. Arrays of float32 meet numbers of float32 alone, so that the
order and the width of every operation are as in C++.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.picture_kernels import AmbientSettings

__all__ = [
    "annotate_pixels",
    "find_ambient_visibility",
    "gather_light",
    "make_picture",
    "resolve_samples",
    "scale_light",
]

F32 = np.float32

FAR_M = F32(1e9)
"""Depth that stands for no surface in `find_ambient_visibility`: its square is finite."""

TILE = 16
"""Edge of the tiles of samples that are left out where everything around them is baked."""

BLOOM_LEVELS = 5
"""Halvings of the picture: each doubles how far light is spread."""

BLOOM_WEIGHTS = np.array([0.33244, 0.23493, 0.0829, 0.01461, 0.00128, 0.00006], np.float32)
"""A normal distribution of 1.2 samples, from the middle outwards."""

Floats = NDArray[np.float32]
Doubles = NDArray[np.float64]


def annotate_pixels(
    surface: Floats,
    category_of_instance: NDArray[np.uint8],
    lens: NDArray[np.void],
    views: Mapping[str, NDArray[Any]],
    *,
    threads: int,
) -> None:
    """Fill in the views; see `native.view_kernels`."""
    near_m, far_m = float(lens["near_m"][0]), float(lens["far_m"][0])
    z = surface[..., 0].astype(np.float64)
    beyond = z > far_m
    z[beyond] = np.inf
    numbers = surface[..., 1]
    known = ~beyond & (numbers >= 0.0) & (numbers < 65536.0)
    ids = np.where(known, numbers, F32(0.0)).astype(np.intp)
    views["depth"][:] = np.where(z < near_m, np.nan, z)
    if "category" in views:
        views["category"][:] = category_of_instance[ids]
    if "instance" in views:
        views["instance"][:] = ids


def find_ambient_visibility(
    surface: Floats,
    known: NDArray[np.uint8],
    lens: NDArray[np.void],
    settings: AmbientSettings,
    pattern: Floats,
    *,
    threads: int,
) -> tuple[NDArray[np.uint8], Floats]:
    """Compute the share of the light from around that arrives; see `native.picture_kernels`."""
    focal, _, cx, cy, _, _ = lens[0].item()
    numbers = np.array([0.5 * focal, 0.5 * cx, 0.5 * cy, *settings], np.float32)
    samples = surface[::2, ::2]
    depth, ids = samples[..., 0], samples[..., 1]
    hit = (depth > F32(1.0) / FAR_M) & (depth < FAR_M)
    valid = hit & (ids >= 0.0) & (ids < 65536.0)
    light = np.where(valid, known[np.where(valid, ids, F32(0.0)).astype(np.intp)], np.uint8(0))
    inverse: Floats = np.full(depth.shape, F32(-1.0) / FAR_M)
    np.divide(np.where(light > 0, F32(-1.0), F32(1.0)), depth, out=inverse, where=hit)
    tiles = _live_tiles(inverse > 0.0, int(numbers[5]) // TILE)
    share = np.where(tiles, _raw_visibility(inverse, numbers, pattern), np.uint8(255))
    same_surface, wide = numbers[8], int(numbers[9])
    for step, axis in ((1, 1), (1, 0), (wide, 1), (wide, 0)):
        mean = _mean_of_four(share, inverse, same_surface, step, axis)
        share = np.where(tiles, mean, np.uint8(255))
    return share, inverse


def _live_tiles(live: NDArray[np.bool_], reach: int) -> NDArray[np.bool_]:
    """Find the samples of tiles that a surface which is not baked may reach."""
    rows, columns = live.shape
    found = np.zeros(live.shape, np.bool_)
    for row in range(0, rows, TILE):
        for column in range(0, columns, TILE):
            if live[row : row + TILE, column : column + TILE].any():
                first_row = max(row - reach * TILE, 0)
                first_column = max(column - reach * TILE, 0)
                last_row, last_column = row + (reach + 1) * TILE, column + (reach + 1) * TILE
                found[first_row:last_row, first_column:last_column] = True
    return found


def _raw_visibility(inverse: Floats, numbers: Floats, pattern: Floats) -> NDArray[np.uint8]:
    focal, cx, cy, radius_m, least_reach_px, reach_px, bias, scale, _, _ = numbers
    rows, columns = inverse.shape
    one, zero, half = F32(1.0), F32(0.0), F32(0.5)
    per_f, per_r2 = one / focal, one / (radius_m * radius_m)
    u = np.arange(columns, dtype=F32)[None].repeat(rows, axis=0)
    v = np.arange(rows, dtype=F32)[:, None].repeat(columns, axis=1)
    w = np.abs(inverse)
    reach = np.minimum(radius_m * focal * w, reach_px)
    a, b = _slope(w, axis=1) * focal, _slope(w, axis=0) * focal
    x, y = (u - cx) * per_f, (v - cy) * per_f
    c = w - a * x - b * y
    z = one / w
    depth = one / inverse
    px, py, self_m2 = x * z, y * z, F32(1e-7) * z * z
    hidden = np.zeros(inverse.shape, F32)
    block = (np.arange(rows) & 3)[:, None] * 4 + (np.arange(columns) & 3)
    with np.errstate(all="ignore"):
        plane_m = one / np.sqrt(a * a + b * b + c * c)
        for tap in range(pattern.shape[2]):
            at_u = u + half + pattern[block, 0, tap] * reach
            at_v = v + half + pattern[block, 1, tap] * reach
            inside = (at_u >= zero) & (at_u < F32(columns)) & (at_v >= zero) & (at_v < F32(rows))
            tu = np.clip(at_u, zero, F32(columns - 1)).astype(np.int32)
            tv = np.clip(at_v, zero, F32(rows - 1)).astype(np.int32)
            other = depth[tv, tu]
            tz = np.abs(other)
            qx = (tu.astype(F32) - cx) * per_f * tz
            qy = (tv.astype(F32) - cy) * per_f * tz
            dx, dy, dz = qx - px, qy - py, tz - z
            d2 = dx * dx + dy * dy + dz * dz + self_m2
            fall = np.fmax(one - d2 * per_r2, zero)
            height_m = (one - (a * qx + b * qy + c * tz)) * plane_m
            rise = height_m / np.sqrt(d2) - bias
            counts = inside & ((other > zero) | (inverse > zero))
            hidden += np.where(counts, np.fmax(rise, zero) * fall, zero)
    share = F32(255.0) / (one + scale * hidden) + half
    return np.where(reach >= least_reach_px, share.astype(np.uint8), np.uint8(255))


def _slope(w: Floats, axis: int) -> Floats:
    """Slope of 1 / depth on the side where it changes less: the other crosses an edge."""
    w = np.moveaxis(w, axis, 1)
    padded = np.pad(w, ((0, 0), (1, 1)), mode="edge")
    before, after = w - padded[:, :-2], padded[:, 2:] - w
    takes_after = np.abs(after) < np.abs(before)
    takes_after[:, -1] = False
    takes_after[:, 0] = True
    return np.moveaxis(np.where(takes_after, after, before), 1, axis)


def _mean_of_four(
    share: NDArray[np.uint8], inverse: Floats, same_surface: np.float32, step: int, axis: int
) -> NDArray[np.uint8]:
    """Average over four samples in a line, `step` apart, that lie on one surface.

    Of unlike sign are surfaces with and without baked light, which do not count as one.
    """
    own = np.moveaxis(inverse, axis, 1)
    size = own.shape[1]
    around = ((0, 0), (step, 2 * step))
    beside = np.pad(own, around, constant_values=np.inf)
    shares = np.pad(np.moveaxis(share, axis, 1).astype(np.int32), around)
    off = same_surface * np.abs(own)
    total, count = np.zeros(own.shape, np.int32), np.zeros(own.shape, np.int32)
    for first in range(0, 4 * step, step):
        same = np.abs(beside[:, first : first + size] - own) <= off
        total += np.where(same, shares[:, first : first + size], 0)
        count += same
    return np.moveaxis(((total + (count >> 1)) // count).astype(np.uint8), 1, axis)


def make_picture(
    radiance: NDArray[np.float16],
    table: NDArray[np.uint8],
    visibility: NDArray[np.uint8] | None,
    inverse: Floats | None,
    surface: Floats | None,
    *,
    same_surface: float,
    threads: int,
) -> NDArray[np.uint8]:
    """Make the picture; see `native.picture_kernels`."""
    bits = radiance.view(np.uint16)
    light = bits[..., :3]
    if visibility is not None and inverse is not None and surface is not None:
        factors = _arriving_factors(bits[..., 3], visibility, inverse, surface, 1, same_surface)
        light = _bits(_small_numbers(light) * factors[..., None])
    return table[light]


def resolve_samples(
    samples: NDArray[np.float16],
    times: int,
    visibility: NDArray[np.uint8] | None,
    inverse: Floats | None,
    surface: Floats | None,
    *,
    same_surface: float,
    keep_ambient_share: bool = False,
    threads: int,
) -> NDArray[np.float16]:
    """Average the samples of each pixel; see `native.picture_kernels`."""
    bits = samples.view(np.uint16)
    height, width = samples.shape[0] // times, samples.shape[1] // times
    weights = np.full(bits.shape[:2], F32(1.0 / (times * times)))
    if visibility is not None and inverse is not None and surface is not None:
        weights *= _arriving_factors(
            bits[..., 3], visibility, inverse, surface, times, same_surface
        )
    light = _small_numbers(bits[..., :3]) * weights[..., None]
    total = np.zeros((height, width, 3), F32)
    for row in range(times):
        for column in range(times):
            total += light[row::times, column::times]
    result = np.zeros((height, width, 4), np.uint16)
    result[..., :3] = _bits(total)
    if keep_ambient_share:
        result[..., 3] = bits[..., 3]
    return result.view(np.float16)


def gather_light(
    radiance: NDArray[np.float16],
    bloom: float,
    shot: float,
    read: float,
    seed: int,
    normal: Floats | None,
    *,
    threads: int,
) -> NDArray[np.float16]:
    """Spread light and add noise; see `native.picture_kernels`."""
    light = radiance[..., :3].astype(F32)
    if bloom > 0.0:
        part = F32(1.0) / F32(BLOOM_LEVELS)
        light = light + F32(bloom) * (_halo(light) * part - light)
    if normal is not None:
        spread = np.sqrt(light * F32(shot) + F32(read))
        light = light + spread * normal[_random_words(seed, light.shape)]
    result = radiance.copy()
    result[..., :3] = np.clip(light, F32(0.0), F32(6e4))
    return result


def scale_light(
    radiance: NDArray[np.float16],
    share: Floats | None,
    factors: Floats,
    offsets: Floats,
    *,
    threads: int,
) -> NDArray[np.float16]:
    """Weaken light by pixels and by colours; see `native.lens_light`."""
    light = radiance[..., :3].astype(F32) * factors
    if share is not None:
        light = light * share[..., None]
    result = radiance.copy()
    result[..., :3] = np.clip(light + offsets, F32(0.0), F32(65504.0))
    return result


def _halo(light: Floats) -> Floats:
    """Return the sum of a picture's blurred levels."""
    levels, shape = [], light.shape[:2]
    for _ in range(BLOOM_LEVELS):
        odd = [(0, size % 2) for size in light.shape[:2]]
        even = np.pad(light, (*odd, (0, 0)), mode="edge")
        upper, lower = even[::2], even[1::2]
        light = (upper[:, ::2] + upper[:, 1::2] + (lower[:, ::2] + lower[:, 1::2])) * F32(0.25)
        levels.append(light)
    halo = _blurred(levels[-1])
    for level in levels[-2::-1]:
        halo = _blurred(level) + _doubled(halo, level.shape[:2])
    return _doubled(halo, shape)


def _blurred(level: Floats) -> Floats:
    reach = len(BLOOM_WEIGHTS) - 1
    for axis in (1, 0):
        size = level.shape[axis]
        wide = np.moveaxis(level, axis, 0)
        wide = np.pad(wide, ((reach, reach), (0, 0), (0, 0)), mode="edge")
        total = BLOOM_WEIGHTS[0] * wide[reach : reach + size]
        for k in range(1, reach + 1):
            beside = wide[reach - k : reach - k + size] + wide[reach + k : reach + k + size]
            total = total + BLOOM_WEIGHTS[k] * beside
        level = np.moveaxis(total, 0, axis)
    return level


def _doubled(level: Floats, shape: tuple[int, ...]) -> Floats:
    """Return a level at twice its size, or one less."""
    for axis, size in enumerate(shape):
        at = np.arange(size)
        other = np.clip(at // 2 + np.where(at % 2, 1, -1), 0, level.shape[axis] - 1)
        near, far = level.take(at // 2, axis), level.take(other, axis)
        level = F32(0.75) * near + F32(0.25) * far
    return level


def _random_words(seed: int, shape: tuple[int, ...]) -> NDArray[np.uint64]:
    """Return numbers of 16 bits (SplitMix64), three of each pixel's."""
    count = np.arange(1, shape[0] * shape[1] + 1, dtype=np.uint64)
    z = np.uint64(seed % 2**64) + count * np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    z = z ^ (z >> np.uint64(31))
    words = z[:, None] >> np.array([0, 16, 32], np.uint64) & np.uint64(0xFFFF)
    return words.reshape(shape)


def _small_numbers(halves: NDArray[np.uint16]) -> Floats:
    """Return half-precision numbers of 0 or more by their bits, 2^112 times smaller."""
    return (halves.astype(np.int32) << 13).view(F32)


def _bits(small: Floats) -> NDArray[np.uint16]:
    return ((np.ascontiguousarray(small).view(np.int32) + 4096) >> 13).astype(np.uint16)


def _arriving_factors(
    ambient: NDArray[np.uint16],
    visibility: NDArray[np.uint8],
    inverse: Floats,
    surface: Floats,
    times: int,
    same_surface: float,
) -> Floats:
    """Share of its light that is left to each sample, by the nearest number on its surface."""
    rows = np.arange(ambient.shape[0])[:, None] // times // 2
    columns = np.arange(ambient.shape[1])[None] // times // 2
    arriving, missing = np.full(ambient.shape, 255), np.ones(ambient.shape, np.bool_)
    one = F32(1.0)
    for below in (0, 1):
        row = np.minimum(rows + below, visibility.shape[0] - 1)
        for right in (0, 1):
            column = np.minimum(columns + right, visibility.shape[1] - 1)
            with np.errstate(all="ignore"):
                off = np.abs(inverse[row, column]) * surface[..., 0] - one
            found = missing & (np.abs(off) <= F32(same_surface))
            arriving = np.where(found, visibility[row, column], arriving)
            missing &= ~found
    share = _small_numbers(ambient) * F32(2.0**112)
    closed = (255 - arriving).astype(F32) * F32(1.0 / 255.0)
    factors: Floats = one - np.minimum(share, one) * closed
    return factors
