"""How much of the light from around reaches each surface past its neighbours in the picture.

Depth and instance ids come in, the open share at half resolution goes out. Each sample looks at
eight points around it, within a radius on the surface: what rises above its tangent plane hides a
part of the half space before it, the less the farther it is (after McGuire et al. 2011, "The
alchemy screen-space ambient obscurance algorithm"). Which eight differs from pixel to pixel in
blocks of four by four; averaging over such a block on one surface removes the pattern.
"""

from __future__ import annotations

import cv2
import numba
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.camera import CameraIntrinsics
from sailenv_ros.render.bands import Bands, alone

__all__ = ["open_share", "warm_up"]

TAPS = 8
REACH_PX = 48
"""Farthest point that is looked at, in samples: near things would else reach across the picture."""

LEAST_REACH_PX = 1.5
"""Radius in samples below which nothing can be told."""

BIAS = 0.08
"""Sine of the angle above the tangent plane up to which nothing hides: surfaces are not flat, and
slanted ones have coarse normals."""

GAIN = 8.0
"""A right-angled joint of two planes loses about half of the light at strength 1, as it should."""

TILE_PX = 16
"""Edge of the tiles that are left out where everything around them is baked."""

FAR_M = 1e9
"""Depth that stands for no surface: its square is finite."""

SAME_SURFACE = np.float32(0.03)
"""Share of its depth by which a sample may lie off another's surface and count as on it."""


def _pattern() -> NDArray[np.float32]:
    """Give (16, 2, TAPS): for each place in a block, points in the unit disc."""
    order = np.array([0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5]) / 16.0
    number = np.arange(TAPS)
    # A spiral by the golden angle covers the disc evenly; turning and growing it varies it.
    angle = 2.0 * np.pi * (order[:, None] + number * 0.381966)
    radius = np.sqrt((number + 0.25 + 0.75 * order[::-1, None]) / TAPS)
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    return np.ascontiguousarray(points, np.float32)


PATTERN = _pattern()


def open_share(
    surface: NDArray[np.float32],
    intrinsics: CameraIntrinsics,
    *,
    strength: float,
    radius_m: float,
    baked: NDArray[np.bool_],
    bands: Bands = alone,
) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """Compute the share of the light from around that arrives.

    Parameters
    ----------
    surface : (H, W, 2) float32
        Depth along the optical axis [m], ``inf`` where nothing was hit, and the instance id.
    intrinsics : CameraIntrinsics
    strength : float
        0 to 1.
    radius_m : float
        How far away surfaces hide light from each other [m].
    baked : (65536,) bool
        By instance id: surfaces whose light was baked do not darken each other.
    bands : callable
        Runs the walks.

    Returns
    -------
    share : (h, w) uint8
        255 = all of it; at pixels of even row and column, h and w half of H and W, rounded up.
    inverse : (h, w) float32
        1 / depth at these pixels [1/m], negative where light was baked, -1e-9 where
        nothing was hit.
    """
    rows, columns = (surface.shape[0] + 1) // 2, (surface.shape[1] + 1) // 2
    inverse = np.empty((rows, columns), np.float32)
    bands(lambda first, last: _halve(surface, baked, inverse, first, last), rows)
    lens = np.array([intrinsics.fx, intrinsics.cx, intrinsics.cy], np.float32) * np.float32(0.5)
    sizes = np.float32(strength), np.float32(radius_m)
    live = _live_tiles(inverse)
    share, means = np.empty(inverse.shape, np.uint8), np.empty(inverse.shape, np.uint8)
    bands(lambda first, last: _walk(inverse, live, lens, *sizes, PATTERN, share, first, last), rows)
    bands(lambda first, last: _mean_of_rows(share, inverse, live, means, first, last), rows)
    bands(lambda first, last: _mean_of_columns(means, inverse, live, share, first, last), rows)
    return share, inverse


def warm_up() -> None:
    """Compile the walks now (or load them from numba's cache), not at the first frame."""
    surface, intrinsics = np.ones((8, 8, 2), np.float32), CameraIntrinsics(width=8, height=8)
    nothing = np.zeros(65536, np.bool_)
    open_share(surface, intrinsics, strength=1.0, radius_m=1.0, baked=nothing)


def _live_tiles(inverse: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Tell which tiles may be reached by a surface that was not baked."""
    rows, columns = -(-inverse.shape[0] // TILE_PX), -(-inverse.shape[1] // TILE_PX)
    own = np.zeros((rows, columns), np.bool_)
    _find_live(inverse, own)
    reach = 2 * (REACH_PX // TILE_PX) + 1
    return cv2.dilate(own.view(np.uint8), np.ones((reach, reach), np.uint8)).view(np.bool_)


@numba.njit(cache=True, nogil=True)
def _halve(surface, baked, inverse, first, last):  # type: ignore[no-untyped-def]  # compiled
    for v in range(first, last):
        for u in range(inverse.shape[1]):
            z = surface[2 * v, 2 * u, 0]
            if not z < np.float32(FAR_M):
                inverse[v, u] = np.float32(-1.0 / FAR_M)
            elif baked[np.int32(surface[2 * v, 2 * u, 1])]:
                inverse[v, u] = np.float32(-1.0) / z
            else:
                inverse[v, u] = np.float32(1.0) / z


@numba.njit(cache=True, nogil=True)
def _find_live(inverse, own):  # type: ignore[no-untyped-def]  # compiled
    for v in range(inverse.shape[0]):
        for u in range(inverse.shape[1]):
            if inverse[v, u] > np.float32(0.0):
                own[v // TILE_PX, u // TILE_PX] = True


@numba.njit(cache=True, nogil=True, fastmath=True)
def _walk(  # type: ignore[no-untyped-def]  # compiled
    inverse, live, lens, strength, radius_m, pattern, out, first, last
):
    rows, columns = inverse.shape
    f, cx, cy = lens[0], lens[1], lens[2]
    one, zero, half = np.float32(1.0), np.float32(0.0), np.float32(0.5)
    per_f = one / f
    per_r2 = one / (radius_m * radius_m)
    scale = np.float32(GAIN / TAPS) * strength
    wide, high = np.float32(columns), np.float32(rows)
    flat = inverse.reshape(-1)
    for v in range(first, last):
        up, down = max(v - 1, 0), min(v + 1, rows - 1)
        y = (np.float32(v) - cy) * per_f
        for u in range(columns):
            out[v, u] = 255
            if not live[v // TILE_PX, u // TILE_PX]:
                continue
            own = inverse[v, u]
            w = abs(own)
            reach = min(radius_m * f * w, np.float32(REACH_PX))
            if reach < np.float32(LEAST_REACH_PX):
                continue
            # Over a plane 1/z is linear in the picture. Its slope on the side where it changes
            # less: the other crosses an edge.
            before = w - abs(inverse[v, max(u - 1, 0)])
            after = abs(inverse[v, min(u + 1, columns - 1)]) - w
            a = after if u == 0 or (abs(after) < abs(before) and u < columns - 1) else before
            before = w - abs(inverse[up, u])
            after = abs(inverse[down, u]) - w
            b = after if v == 0 or (abs(after) < abs(before) and v < rows - 1) else before
            # The plane is where (a, b, c) · point = 1.
            a, b = a * f, b * f
            x = (np.float32(u) - cx) * per_f
            c = w - a * x - b * y
            plane_m = one / np.sqrt(a * a + b * b + c * c)
            z = one / w
            px, py = x * z, y * z
            # Keeps rounding from making the point its own neighbour.
            self_m2 = np.float32(1e-7) * z * z
            hidden = zero
            block = (v & 3) * 4 + (u & 3)
            fu, fv = np.float32(u) + half, np.float32(v) + half
            for tap in range(TAPS):
                at_u = fu + pattern[block, 0, tap] * reach
                at_v = fv + pattern[block, 1, tap] * reach
                inside = zero <= at_u < wide and zero <= at_v < high
                tu = np.int32(at_u) if inside else u
                tv = np.int32(at_v) if inside else v
                other = flat[tv * np.int32(columns) + tu]
                tz = one / abs(other)
                qx = (np.float32(tu) - cx) * per_f * tz
                qy = (np.float32(tv) - cy) * per_f * tz
                dx, dy, dz = qx - px, qy - py, tz - z
                d2 = dx * dx + dy * dy + dz * dz + self_m2
                fall = max(one - d2 * per_r2, zero)
                height_m = (one - (a * qx + b * qy + c * tz)) * plane_m
                rise = height_m / np.sqrt(d2) - np.float32(BIAS)
                both_baked = own < zero and other < zero
                hidden += zero if both_baked else max(rise, zero) * fall
            out[v, u] = np.uint8(np.float32(255.0) * max(zero, one - scale * hidden) + half)


@numba.njit(cache=True, nogil=True)
def _mean_of_rows(share, inverse, live, out, first, last):  # type: ignore[no-untyped-def]
    """Average over four neighbours in a row that lie on one surface."""
    columns = share.shape[1]
    for v in range(first, last):
        for u in range(columns):
            if not live[v // TILE_PX, u // TILE_PX]:
                out[v, u] = 255
                continue
            w = abs(inverse[v, u])
            off = SAME_SURFACE * w
            total, count = np.int32(0), np.int32(0)
            for i in range(max(u - 1, 0), min(u + 3, columns)):
                if abs(abs(inverse[v, i]) - w) <= off:
                    total += share[v, i]
                    count += 1
            out[v, u] = (total + (count >> 1)) // count


@numba.njit(cache=True, nogil=True)
def _mean_of_columns(share, inverse, live, out, first, last):  # type: ignore[no-untyped-def]
    """Average over four neighbours in a column that lie on one surface."""
    rows, columns = share.shape
    for v in range(first, last):
        top, bottom = max(v - 1, 0), min(v + 3, rows)
        for u in range(columns):
            if not live[v // TILE_PX, u // TILE_PX]:
                out[v, u] = 255
                continue
            w = abs(inverse[v, u])
            off = SAME_SURFACE * w
            total, count = np.int32(0), np.int32(0)
            for i in range(top, bottom):
                if abs(abs(inverse[i, u]) - w) <= off:
                    total += share[i, u]
                    count += 1
            out[v, u] = (total + (count >> 1)) // count
