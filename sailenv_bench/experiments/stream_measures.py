"""Measures of how well flow explains the pictures of a stream; no ground truth is needed.

Two pictures and a flow in, sums out. `FlowFactor` finds the number by which a flow must be
multiplied to be in true units; `warp_residual` says what is left of the difference of two pictures.
"""

from __future__ import annotations

from typing import Any

import cv2 as typed_cv2
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

__all__ = ["FACTORS", "FlowFactor", "warp_residual"]

cv2: Any = typed_cv2  # OpenCV's annotations lack functions of its own

Floats = NDArray[np.float32]
Picture = NDArray[np.uint8]

FACTORS = np.arange(0.3, 2.601, 0.025)
"""Factors that are tried."""

MARGIN_PX = 5
"""Pixels as near as this to another object are not asked: there both are mixed."""

LEAST_PX, MOST_PX = 0.3, 20.0
"""Lengths of flow that tell something: shorter ones are lost in interpolation [px]."""

BLUR_PX = 0.7
"""Standard deviation of the filter that makes interpolation between pixels accurate [px]."""

SHADING_PX = 2.5
"""Standard deviation of the mean around a pixel that is taken off it [px]: what is broader is
light and shadow, which stay where they are while what they fall on moves. With it the factor of
flow in true units came out as 0.98 to 0.995 in a furnished room."""

NOISE = 1.0
"""Grey levels up to which differences count by their squares; larger ones by their size, so that
edges of shadows and highlights do not outweigh all the rest."""

Costs = NDArray[np.float64]


class FlowFactor:
    """Gathers pairs of pictures, and finds the factor of their flow.

    The difference of the present picture and of the one before, warped by s times the flow with
    cubic splines, both less the mean around each pixel, is summed over all pairs for each s by
    the robust norm of Charbonnier (1994); the lowest point of the parabola through the least sum
    and its neighbours is the factor. Only pixels are asked that move, whose surroundings belong
    to one object in both pictures, and that were visible.
    """

    def __init__(self) -> None:
        self._costs: list[Costs] = []
        self._still = 0.0
        self.pixels = 0
        """Number of pixels that were used."""

    def add(
        self,
        before: Picture,
        now: Picture,
        backward: Floats,
        ids_before: NDArray[Any],
        ids_now: NDArray[Any],
    ) -> None:
        """Take one pair.

        Parameters
        ----------
        before, now : (H, W, 3) uint8
        backward : (H, W, 2) float32
            Displacement of each present pixel to the picture before [px], u right, v down.
        ids_before, ids_now : (H, W) integer
            Instance ids.
        """
        rows, columns = _asked(backward, ids_before, ids_now)
        if len(rows) < 30:
            return
        first, second = (_detail(picture) for picture in (before, now))
        spline = ndimage.spline_filter(first, order=3)
        way = backward[rows, columns].astype(np.float64)
        seen = second[rows, columns]
        self._still += _cost(first[rows, columns] - seen)
        costs = np.zeros(len(FACTORS))
        for place, factor in enumerate(FACTORS):
            # OpenCV would round places to 1/32 pixel.
            places = [rows + factor * way[:, 1], columns + factor * way[:, 0]]
            warped = ndimage.map_coordinates(spline, places, prefilter=False, mode="nearest")
            costs[place] = _cost(warped - seen)
        self._costs.append(costs)
        self.pixels += len(rows)

    @property
    def factor(self) -> float:
        """The factor: 1 for flow in true units; nan if nothing told anything."""
        return _lowest(np.sum(self._costs, axis=0)) if self._costs else float("nan")

    @property
    def error(self) -> float:
        """Standard error of the factor, by leaving out each pair in turn (jackknife)."""
        count = len(self._costs)
        if count < 2:
            return float("nan")
        whole = np.sum(self._costs, axis=0)
        without = np.array([_lowest(whole - one) for one in self._costs])
        return float(np.sqrt((count - 1) / count * np.square(without - without.mean()).sum()))

    @property
    def left(self) -> float:
        """Share of the difference that is left at the best factor."""
        if not self._still:
            return float("nan")
        return float(np.sum(self._costs, axis=0).min() / self._still)


def warp_residual(
    before: Picture, now: Picture, backward: Floats, moves: NDArray[np.bool_]
) -> float:
    """Return the share of the difference of two pictures that is left after warping.

    Parameters
    ----------
    before, now : (H, W, 3) uint8
    backward : (H, W, 2) float32
        Displacement of each present pixel to the picture before [px].
    moves : (H, W) bool
        What is looked at, but for its outermost pixels.

    Returns
    -------
    share : float
        1 as without a warp; nan if too little moves.
    """
    inside = cv2.erode(moves.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(bool)
    rows, columns = np.nonzero(inside)
    if len(rows) < 100:
        return float("nan")
    first, seen = before.astype(np.float32), now[rows, columns].astype(np.float32)
    u, v = np.meshgrid(*(np.arange(size, dtype=np.float32) for size in first.shape[1::-1]))
    warped = cv2.remap(first, u + backward[..., 0], v + backward[..., 1], cv2.INTER_LINEAR)
    warped = warped[rows, columns]
    unwarped = float(np.abs(first[rows, columns] - seen).mean())
    return float(np.abs(warped - seen).mean()) / unwarped if unwarped else float("nan")


def _asked(
    backward: Floats, ids_before: NDArray[Any], ids_now: NDArray[Any]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    height, width = ids_now.shape
    length = np.hypot(backward[..., 0], backward[..., 1])
    told = (length > LEAST_PX) & (length < MOST_PX) & _of_one(ids_now)
    kept = np.where(_of_one(ids_before), ids_before.astype(np.int32), -1)
    rows, columns = np.nonzero(told)
    u = np.rint(columns + backward[rows, columns, 0]).astype(np.intp)
    v = np.rint(rows + backward[rows, columns, 1]).astype(np.intp)
    edge = MARGIN_PX + 1
    inside = (u >= edge) & (u < width - edge) & (v >= edge) & (v < height - edge)
    rows, columns, u, v = rows[inside], columns[inside], u[inside], v[inside]
    same = kept[v, u] == ids_now[rows, columns]
    return rows[same], columns[same]


def _of_one(ids: NDArray[Any]) -> NDArray[np.bool_]:
    """Return where all ids around are equal."""
    around = np.ones((2 * MARGIN_PX + 1, 2 * MARGIN_PX + 1), np.uint8)
    values = ids.astype(np.float32)
    return np.asarray(cv2.erode(values, around) == cv2.dilate(values, around))


def _detail(picture: Picture) -> Costs:
    grey = cv2.cvtColor(picture.astype(np.float32), cv2.COLOR_RGB2GRAY)
    fine, broad = (cv2.GaussianBlur(grey, (0, 0), size) for size in (BLUR_PX, SHADING_PX))
    return np.asarray(fine - broad, np.float64)


def _cost(difference: Costs) -> float:
    return float((np.sqrt(NOISE**2 + np.square(difference)) - NOISE).sum())


def _lowest(costs: Costs) -> float:
    """Return the factor at the lowest point of a curve over `FACTORS`; nan at their ends."""
    place = int(np.argmin(costs))
    if not 0 < place < len(FACTORS) - 1:
        return float("nan")
    left, least, right = costs[place - 1 : place + 2]
    step = FACTORS[1] - FACTORS[0]
    return float(FACTORS[place] + step * (left - right) / (2.0 * (left - 2.0 * least + right)))
