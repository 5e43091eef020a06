"""The compressed text in which COCO's files hold the run lengths of masks."""

from __future__ import annotations

from collections.abc import Iterable

__all__ = ["run_lengths_text"]


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
