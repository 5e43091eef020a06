"""Visible part of each instance: an instance view in; pixels, box and mean flow of each id out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.view_kernels import measure_instances

__all__ = ["VisibleParts", "visible_parts"]

FLOW_STEPS = 1048576.0
"""Flow is added up in whole steps of 1 / this [px/s], so that its sum has no order."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class VisibleParts:
    """The instances of one view, in the order of their ids.

    Attributes
    ----------
    ids : (N,) uint16
        Instance ids, each once; the background is not among them.
    corners : (N, 4) int32
        Left, top, right, bottom column and row [px], the last ones included: a single pixel at
        (u, v) has the box u, v, u, v.
    pixels : (N,) int32
        How many pixels are seen.
    flow : (N, 2) float64
        Mean flow of those pixels where it exists, u right, v down [px/s]; NaN where it nowhere
        does, or was not given.
    """

    ids: NDArray[np.uint16]
    corners: NDArray[np.int32]
    pixels: NDArray[np.int32]
    flow: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.ids)

    def __iter__(self) -> Iterator[tuple[int, tuple[int, int, int, int], int]]:
        """Yield id, (left, top, right, bottom) and number of pixels of each."""
        boxes = map(tuple, self.corners.tolist())
        yield from zip(self.ids.tolist(), boxes, self.pixels.tolist(), strict=True)


def visible_parts(
    instance: NDArray[np.uint16], flow: NDArray[np.float32] | None = None
) -> VisibleParts:
    """Measure the visible pixels of each instance, in one pass.

    Parameters
    ----------
    instance : (H, W) uint16
        Instance ids, 0 for the background.
    flow : (H, W, 2) float32 or None
        [px/s]; NaN where it does not exist.
    """
    ids, pixels, corners, sums = measure_instances(
        np.ascontiguousarray(instance), None if flow is None else np.ascontiguousarray(flow)
    )
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = sums[:, :2] / FLOW_STEPS / sums[:, 2:]
    return VisibleParts(ids=ids, corners=corners, pixels=pixels, flow=mean)
