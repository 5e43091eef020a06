"""Smooths the stair-steps of a picture, after the fact, where brightness has an edge.

An 8-bit picture with its luma comes in, the finished picture goes out. A pixel whose luma differs
little from its four neighbours' is copied. Otherwise the edge's direction and its two ends along
the row or column are looked for, and the pixel is mixed with the neighbour across the edge by the
share of it that the edge, were it a straight line between the ends, would cut off.

This is morphological antialiasing on the processor: edges are found for many pixels at once, and
only where one is are its ends looked for.
"""

from __future__ import annotations

import cv2
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
    rgb = np.asarray(cv2.cvtColor(picture, cv2.COLOR_RGBA2RGB), np.uint8)
    luma = np.asarray(cv2.extractChannel(picture, 3), np.uint8)
    _walk(picture, luma, rgb)
    return rgb


def warm_up() -> None:
    """Compile the kernel now (or load it from numba's cache), not at the first frame."""
    smooth_edges(np.zeros((4, 4, 4), np.uint8))


@numba.njit(cache=True, nogil=True)
def _walk(picture, luma, rgb):  # type: ignore[no-untyped-def]  # compiled
    rows, columns = luma.shape
    contrasts = np.empty(max(columns - 2, 0), np.int16)
    for v in range(1, rows - 1):
        _find_contrasts(luma, v, contrasts)
        for place in range(contrasts.size):
            if contrasts[place] < LEAST_CONTRAST:
                continue
            u = place + 1
            here = np.int32(luma[v, u])
            up, down = abs(luma[v - 1, u] - here), abs(luma[v + 1, u] - here)
            left, right = abs(luma[v, u - 1] - here), abs(luma[v, u + 1] - here)
            if max(up, down) >= max(left, right):
                dv, du = (-1 if up > down else 1), 0
            else:
                dv, du = 0, (-1 if left > right else 1)
            share = _share(luma, v, u, dv, du, contrasts[place])
            if share <= 0.0:
                continue
            for c in range(3):
                own = np.float32(picture[v, u, c])
                across = np.float32(picture[v + dv, u + du, c])
                rgb[v, u, c] = np.uint8(own + (across - own) * share + np.float32(0.5))


@numba.njit(cache=True, nogil=True)
def _find_contrasts(luma, v, contrasts):  # type: ignore[no-untyped-def]  # compiled
    """Greatest difference to the four neighbours, of a row's inner pixels."""
    # Slices that begin where they are read: the compiler takes many pixels at once.
    here, up, down = luma[v, 1:-1], luma[v - 1, 1:-1], luma[v + 1, 1:-1]
    left, right = luma[v, :-2], luma[v, 2:]
    for u in range(contrasts.size):
        own = np.int16(here[u])
        across = max(abs(np.int16(up[u]) - own), abs(np.int16(down[u]) - own))
        along = max(abs(np.int16(left[u]) - own), abs(np.int16(right[u]) - own))
        contrasts[u] = max(across, along)


@numba.njit(cache=True, nogil=True)
def _share(luma, v, u, dv, du, contrast):  # type: ignore[no-untyped-def]  # compiled
    """Share of the pixel that lies across the edge towards (dv, du), 0 to 0.5."""
    rows, columns = luma.shape
    # Along the edge: at right angles to the way across it.
    sv, su = abs(du), abs(dv)
    limit = 0.5 * contrast
    middle = 0.5 * (np.float32(luma[v, u]) + np.float32(luma[v + dv, u + du]))
    brighter = np.float32(luma[v, u]) > middle
    before, crosses_before = REACH_PX, False
    after, crosses_after = REACH_PX, False
    for sense in (-1, 1):
        for step in range(1, REACH_PX + 1):
            pv, pu = v + sense * step * sv, u + sense * step * su
            if not (0 <= pv < rows and 0 <= pu < columns):
                break
            if not (0 <= pv + dv < rows and 0 <= pu + du < columns):
                break
            own = np.float32(luma[pv, pu])
            across = np.float32(luma[pv + dv, pu + du])
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
