"""Smooths the stair-steps of a picture, after the fact, where brightness has an edge.

An 8-bit picture with its luma comes in, the finished picture goes out. A pixel whose luma differs
little from its four neighbours' is copied. Otherwise the edge's direction and its two ends along
the row or column are looked for, and the pixel is mixed with the neighbour across the edge by the
share of it that the edge, were it a straight line between the ends, would cut off.

This is morphological antialiasing on the processor: most pixels cost a few comparisons, and the
conversion to three channels is done on the way.
"""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

__all__ = ["smooth_edges", "warm_up"]

LEAST_CONTRAST = 12
"""Difference of luma, of 255, below which nothing is an edge."""

REACH_PX = 12
"""How far along an edge its ends are looked for."""


def smooth_edges(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Smooth the edges of a picture.

    Parameters
    ----------
    picture : (H, W, 4) uint8
        sRGB and luma.

    Returns
    -------
    rgb : (H, W, 3) uint8
        A fresh array.
    """
    rgb = np.empty((*picture.shape[:2], 3), np.uint8)
    _walk(picture, rgb)
    return rgb


def warm_up() -> None:
    """Compile the kernel now (or load it from numba's cache), not at the first frame."""
    smooth_edges(np.zeros((4, 4, 4), np.uint8))


@numba.njit(cache=True, nogil=True)
def _walk(picture, rgb):  # type: ignore[no-untyped-def]  # compiled
    rows, columns = picture.shape[:2]
    for v in range(rows):
        for u in range(columns):
            r, g, b = picture[v, u, 0], picture[v, u, 1], picture[v, u, 2]
            rgb[v, u, 0] = r
            rgb[v, u, 1] = g
            rgb[v, u, 2] = b
            if v == 0 or u == 0 or v == rows - 1 or u == columns - 1:
                continue
            here = np.int32(picture[v, u, 3])
            up = abs(np.int32(picture[v - 1, u, 3]) - here)
            down = abs(np.int32(picture[v + 1, u, 3]) - here)
            left = abs(np.int32(picture[v, u - 1, 3]) - here)
            right = abs(np.int32(picture[v, u + 1, 3]) - here)
            vertical, horizontal = max(up, down), max(left, right)
            contrast = max(vertical, horizontal)
            if contrast < LEAST_CONTRAST:
                continue
            if vertical >= horizontal:
                dv, du = (-1 if up > down else 1), 0
            else:
                dv, du = 0, (-1 if left > right else 1)
            share = _share(picture, v, u, dv, du, contrast)
            if share <= 0.0:
                continue
            for c in range(3):
                own = np.float32(picture[v, u, c])
                across = np.float32(picture[v + dv, u + du, c])
                rgb[v, u, c] = np.uint8(own + (across - own) * share + np.float32(0.5))


@numba.njit(cache=True, nogil=True)
def _share(picture, v, u, dv, du, contrast):  # type: ignore[no-untyped-def]  # compiled
    """Share of the pixel that lies across the edge towards (dv, du), 0 to 0.5."""
    rows, columns = picture.shape[:2]
    # Along the edge: at right angles to the way across it.
    sv, su = abs(du), abs(dv)
    limit = 0.5 * contrast
    middle = 0.5 * (np.float32(picture[v, u, 3]) + np.float32(picture[v + dv, u + du, 3]))
    brighter = np.float32(picture[v, u, 3]) > middle
    before, crosses_before = REACH_PX, False
    after, crosses_after = REACH_PX, False
    for sense in (-1, 1):
        for step in range(1, REACH_PX + 1):
            pv, pu = v + sense * step * sv, u + sense * step * su
            if not (0 <= pv < rows and 0 <= pu < columns):
                break
            if not (0 <= pv + dv < rows and 0 <= pu + du < columns):
                break
            own = np.float32(picture[pv, pu, 3])
            across = np.float32(picture[pv + dv, pu + du, 3])
            if abs(own - across) >= limit and (own > middle) == brighter:
                continue
            # The edge ends here: does it step towards this pixel's side or away from it?
            crosses = (own > middle) != brighter
            if sense < 0:
                before, crosses_before = step, crosses
            else:
                after, crosses_after = step, crosses
            break
    if before == REACH_PX and after == REACH_PX:
        return 0.0
    length = before + after - 1
    near, crosses = (before, crosses_before) if before <= after else (after, crosses_after)
    if not crosses:
        return 0.0
    # A line from the step's middle to the edge's middle: half a pixel high at the step.
    return max(0.0, 0.5 - (near - 0.5) / length) if length > 1 else 0.25
