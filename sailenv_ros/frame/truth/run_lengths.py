"""Masks as lengths of runs: column by column, as COCO counts them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest

__all__ = ["crop_runs", "mask_of_runs", "run_lengths"]


def run_lengths(mask: NDArray[np.bool_]) -> list[int]:
    """Return lengths of runs of a mask, column by column: first of False, which may be 0."""
    flat = mask.ravel(order="F")
    changes = np.flatnonzero(flat[1:] != flat[:-1]) + 1
    lengths = np.diff(np.concatenate([[0], changes, [flat.size]])).tolist()
    return [0, *lengths] if flat.size and flat[0] else lengths


def crop_runs(
    crop: NDArray[np.bool_], left: int, top: int, height: int, width: int
) -> NDArray[np.uint32]:
    """Return the run lengths of a mask of a picture of which all that is True lies in a crop.

    Parameters
    ----------
    crop : (h, w) bool
    left, top : int
        Where it lies in the picture [px].
    height, width : int
        Of the picture [px].
    """
    rows, columns = crop.shape
    padded = np.zeros((rows + 2, columns), np.int8)
    padded[1:-1] = crop
    # +1 where a run begins in its column, -1 behind its end.
    steps = np.diff(padded, axis=0).T
    column, row = np.nonzero(steps == 1)
    begins = (left + column) * height + top + row
    column, row = np.nonzero(steps == -1)
    ends = (left + column) * height + top + row
    # What ends at the foot of a column may go on at the head of the next one.
    apart = np.ones(len(begins) + 1, bool)
    apart[1:-1] = begins[1:] != ends[:-1]
    bounds = np.stack([begins[apart[:-1]], ends[apart[1:]]], axis=-1).reshape(-1)
    lengths = np.diff(np.concatenate([[0], bounds, [height * width]]))
    return (lengths[:-1] if lengths[-1] == 0 else lengths).astype(np.uint32)


def mask_of_runs(counts: Sequence[int], height: int, width: int) -> NDArray[np.bool_]:
    """Return the mask (H, W) of run lengths.

    Raises
    ------
    InvalidRequest
        If they do not add up to its size.
    """
    lengths = np.asarray(counts, np.int64)
    if lengths.sum() != height * width or (lengths < 0).any():
        accepted = f"lengths that add up to {height * width}"
        raise InvalidRequest("run lengths", f"a sum of {lengths.sum()}", accepted)
    values = np.arange(len(lengths)) % 2 == 1
    return np.repeat(values, lengths).reshape(width, height).T
