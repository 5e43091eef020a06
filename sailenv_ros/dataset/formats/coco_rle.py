"""Masks as COCO's files hold them: run lengths in a compressed text."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.frame.truth.object_table import ObjectTable
from sailenv_ros.frame.truth.run_lengths import crop_runs

__all__ = ["amodal_segmentation", "run_lengths_text", "segmentation"]


def segmentation(
    crop: NDArray[np.bool_], left: int, top: int, size: tuple[int, int]
) -> dict[str, Any]:
    """Return a mask as COCO's ``segmentation``.

    Parameters
    ----------
    crop : (h, w) bool
        The part of the mask that is not empty.
    left, top : int
        Its place in the picture [px].
    size : (2,) tuple of int
        Height and width of the picture [px].
    """
    counts = crop_runs(crop, left, top, *size).tolist()
    return {"size": list(size), "counts": run_lengths_text(counts)}


def amodal_segmentation(
    masks: AmodalMasks, table: ObjectTable, row: int, size: tuple[int, int]
) -> dict[str, Any]:
    """Return the amodal mask of the object in a row of the table."""
    left, top, *_ = table.amodal_boxes[row].tolist()
    return segmentation(masks.crops[masks.row(int(table.ids[row]))], left, top, size)


def run_lengths_text(counts: Iterable[int]) -> str:
    """Write run lengths as COCO does: five bits a letter, from the third on as differences.

    P. Dollár, T.-Y. Lin, common/maskApi.c of the COCO API: rleToString.
    """
    lengths, text = [int(count) for count in counts], []
    for number, length in enumerate(lengths):
        value = length - lengths[number - 2] if number > 2 else length
        more = True
        while more:
            bits = value & 0x1F
            value >>= 5
            # Ends where the rest is but the sign that the last of the five bits says.
            more = value != (-1 if bits & 0x10 else 0)
            text.append(chr((bits | 0x20 if more else bits) + 48))
    return "".join(text)
