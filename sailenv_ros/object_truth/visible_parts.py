"""What is seen of each instance: an instance view in, pixels, box and mean flow of each id out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.instance_measures import measure_instances
from sailenv_ros.native.library import native_is_usable

__all__ = ["VisibleParts", "measure_with_numpy", "visible_parts"]

FLOW_STEPS = 1048576.0
"""Flow is added up in whole steps of 1 / this [px/s], so that its sum has no order."""

GREATEST_FLOW = 1e7
"""What is not less [px/s] counts as no flow."""


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
    measure = measure_instances if native_is_usable() else measure_with_numpy
    ids, pixels, corners, sums = measure(
        np.ascontiguousarray(instance), None if flow is None else np.ascontiguousarray(flow)
    )
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = sums[:, :2] / FLOW_STEPS / sums[:, 2:]
    return VisibleParts(ids=ids, corners=corners, pixels=pixels, flow=mean)


def measure_with_numpy(
    instance: NDArray[np.uint16], flow: NDArray[np.float32] | None
) -> tuple[NDArray[np.uint16], NDArray[np.int32], NDArray[np.int32], NDArray[np.int64]]:
    """Do what `native.instance_measures.measure_instances` does; what defines it."""
    height, width = instance.shape
    counts = np.bincount(instance.reshape(-1), minlength=1)
    counts[0] = 0
    ids = np.flatnonzero(counts)
    place = np.zeros(len(counts), np.int64)
    place[ids] = np.arange(1, len(ids) + 1)
    # A number for each id from 1 on, so that one table of rows (columns) by ids stays small.
    places, slots = place[instance], len(ids) + 1
    left, right = _ends(_present(places + slots * np.arange(width), width, slots))
    top, bottom = _ends(_present(places + slots * np.arange(height)[:, None], height, slots))
    sums = np.zeros((len(ids), 3), np.int64)
    if flow is not None:
        there = np.asarray((np.abs(flow) < GREATEST_FLOW).all(axis=-1), np.bool_)
        scaled = np.where(there[..., None], flow, 0.0).astype(np.float64) * FLOW_STEPS
        steps = np.trunc(scaled + np.where(scaled < 0.0, -0.5, 0.5)).astype(np.int64)
        for row, id_ in enumerate(ids):
            own = np.logical_and(there, instance == id_)
            sums[row] = (*steps[own].sum(axis=0), own.sum())
    corners = np.stack([left, top, right, bottom], axis=-1).astype(np.int32)
    return ids.astype(np.uint16), counts[ids].astype(np.int32), corners, sums


def _present(keys: NDArray[np.int64], lines: int, slots: int) -> NDArray[np.bool_]:
    """Return in which lines each instance is: (lines, N)."""
    seen = np.zeros(lines * slots, np.bool_)
    seen[keys.reshape(-1)] = True
    return seen.reshape(lines, slots)[:, 1:]


def _ends(present: NDArray[np.bool_]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the first and the last line of each instance."""
    return present.argmax(axis=0), len(present) - 1 - present[::-1].argmax(axis=0)
