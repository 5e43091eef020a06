"""Measuring of the instances of a picture, in plain NumPy: the definition of the kernel."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.truth.visible_parts import FLOW_STEPS

__all__ = ["measure_with_numpy"]

GREATEST_FLOW = 1e7
"""Flow of this magnitude or more counts as no flow [px/s]."""


def measure_with_numpy(
    instance: NDArray[np.uint16], flow: NDArray[np.float32] | None
) -> tuple[NDArray[np.uint16], NDArray[np.int32], NDArray[np.int32], NDArray[np.int64]]:
    """Measure what is seen of each instance; as `native.view_kernels.measure_instances`."""
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
