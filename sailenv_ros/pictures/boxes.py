"""Boxes around what is seen: an instance view in, a box and a pixel count for each id out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Boxes", "instance_boxes"]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Boxes:
    """Boxes of the instances of one view, in the order of their ids.

    Attributes
    ----------
    ids : (N,) uint16
        Instance ids, each once; the background is not among them.
    corners : (N, 4) int64
        Left, top, right, bottom column and row [px], the last ones included: a single pixel at
        (u, v) has the box u, v, u, v.
    pixels : (N,) int64
        How many pixels are seen.
    """

    ids: NDArray[np.uint16]
    corners: NDArray[np.int64]
    pixels: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.ids)

    def __iter__(self) -> Iterator[tuple[int, tuple[int, int, int, int], int]]:
        """Yield id, (left, top, right, bottom) and number of pixels of each."""
        boxes = map(tuple, self.corners.tolist())
        yield from zip(self.ids.tolist(), boxes, self.pixels.tolist(), strict=True)


def instance_boxes(instance: NDArray[np.uint16]) -> Boxes:
    """Find the box around the visible pixels of each instance.

    Parameters
    ----------
    instance : (H, W) uint16
        Instance ids, 0 for the background.
    """
    height, width = instance.shape
    counts = np.bincount(instance.reshape(-1), minlength=1)
    counts[0] = 0
    ids = np.flatnonzero(counts)
    place = np.zeros(len(counts), np.int64)
    place[ids] = np.arange(1, len(ids) + 1)
    # A number for each id from 1 on, so that one table of rows (columns) by ids stays small.
    places, slots = place[instance], len(ids) + 1
    in_row = _present(places + slots * np.arange(height)[:, None], height, slots)
    in_column = _present(places + slots * np.arange(width), width, slots)
    left, right = _ends(in_column)
    top, bottom = _ends(in_row)
    return Boxes(
        ids=ids.astype(np.uint16),
        corners=np.stack([left, top, right, bottom], axis=-1),
        pixels=counts[ids],
    )


def _present(keys: NDArray[np.int64], lines: int, slots: int) -> NDArray[np.bool_]:
    """Say in which lines each instance is: (lines, N)."""
    seen = np.zeros(lines * slots, np.bool_)
    seen[keys.reshape(-1)] = True
    return seen.reshape(lines, slots)[:, 1:]


def _ends(present: NDArray[np.bool_]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the first and the last line of each instance."""
    return present.argmax(axis=0), len(present) - 1 - present[::-1].argmax(axis=0)
