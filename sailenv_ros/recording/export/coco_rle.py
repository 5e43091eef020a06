"""Masks as COCO's run lengths, and their compressed text."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["run_lengths", "run_lengths_text"]


def run_lengths(mask: NDArray[np.bool_]) -> list[int]:
    """Return lengths of runs of a mask, column by column: first of False, which may be 0."""
    flat = mask.ravel(order="F")
    changes = np.flatnonzero(flat[1:] != flat[:-1]) + 1
    lengths = np.diff(np.concatenate([[0], changes, [flat.size]])).tolist()
    return [0, *lengths] if flat.size and flat[0] else lengths


def run_lengths_text(lengths: list[int]) -> str:
    """Write run lengths as COCO does: five bits a letter, from the third on as differences.

    P. Dollár, T.-Y. Lin, common/maskApi.c of the COCO API: rleToString.
    """
    text = []
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
