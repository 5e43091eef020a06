"""Horn and Schunck's flow, and the metrics of CoLLAs 2022: Motion-F1 and reconstruction accuracy.

Source: Horn and Schunck, "Determining optical flow", 1981, with its estimates of derivatives over
2×2×2 pixels and its weights of neighbours; a weight of smoothness and a number of iterations.
"""

from __future__ import annotations

from typing import Any

import cv2 as typed_cv2
import numpy as np
from numpy.typing import NDArray

__all__ = ["MotionScore", "horn_schunck_flow"]

cv2: Any = typed_cv2  # OpenCV's annotations lack functions of its own

Floats = NDArray[np.float32]

MOVING_PX = 0.5
"""Faster pixels count as moving [px a frame]."""

TOLERANCES = (0.05, 0.025)
"""A pixel is reconstructed that differs by less, of white."""

_NEIGHBOURS = np.array([[1, 2, 1], [2, 0, 2], [1, 2, 1]], np.float32) / 12.0


def horn_schunck_flow(
    before: Floats, now: Floats, *, smoothness: float = 0.5, iterations: int = 200
) -> Floats:
    """Estimate flow from a picture to the next.

    Parameters
    ----------
    before, now : (H, W) float32
        Grey, 0 to 1.
    smoothness : float
        Lambda; large for smooth flow.
    iterations : int

    Returns
    -------
    flow : (H, W, 2) float32
        Displacement from `before` to `now` [px], u right, v down.
    """
    both = before + now
    across, down = (
        np.array([[-1, 1], [-1, 1]], np.float32),
        np.array([[-1, -1], [1, 1]], np.float32),
    )
    x, y = (_filtered(both, kernel / 4.0) for kernel in (across, down))
    t = _filtered(now - before, np.full((2, 2), 0.25, np.float32))
    u, v = np.zeros_like(now), np.zeros_like(now)
    scale = 1.0 / (smoothness**2 + x * x + y * y)
    for _ in range(iterations):
        mean_u, mean_v = (cv2.filter2D(part, -1, _NEIGHBOURS) for part in (u, v))
        change = (x * mean_u + y * mean_v + t) * scale
        u, v = mean_u - x * change, mean_v - y * change
    return np.dstack([u, v])


class MotionScore:
    """Gathers estimates beside the truth."""

    def __init__(self) -> None:
        self._right = self._claimed = self._true = 0
        self._frames = 0
        self._accuracies = np.zeros(len(TOLERANCES))

    def add(self, before: Floats, now: Floats, flow: Floats, moves: NDArray[np.bool_]) -> None:
        """Take a pair.

        Parameters
        ----------
        before, now : (H, W) float32
            Grey, 0 to 1.
        flow : (H, W, 2) float32
            Estimated, from `before` to `now` [px].
        moves : (H, W) bool
            What truly moves, see `MOVING_PX`.
        """
        claimed = np.abs(flow).max(axis=-1) > MOVING_PX
        self._right += int((claimed & moves).sum())
        self._claimed += int(claimed.sum())
        self._true += int(moves.sum())
        self._frames += 1
        if not moves.any():
            self._accuracies += 1.0
            return
        rows, columns = np.mgrid[: now.shape[0], : now.shape[1]].astype(np.float32)
        warped = cv2.remap(
            now, columns + flow[..., 0], rows + flow[..., 1], cv2.INTER_LINEAR,
            borderMode=cv2.BORDER_REPLICATE,
        )  # fmt: skip
        differences = np.abs(warped - before)[moves]
        self._accuracies += [(differences < tolerance).mean() for tolerance in TOLERANCES]

    @property
    def motion_f1(self) -> float:
        """F1 of what moves, over all pixels of all pairs."""
        both = self._claimed + self._true
        return 2.0 * self._right / both if both else float("nan")

    @property
    def accuracies(self) -> tuple[float, ...]:
        """Share of moving pixels that are reconstructed, mean over the pairs, by `TOLERANCES`."""
        return tuple(float(one) / max(self._frames, 1) for one in self._accuracies)


def _filtered(picture: Floats, kernel: Floats) -> Floats:
    """Correlate with the pixel itself and those to its right and below."""
    return np.asarray(
        cv2.filter2D(picture, -1, kernel, anchor=(0, 0), borderType=cv2.BORDER_REPLICATE)
    )
