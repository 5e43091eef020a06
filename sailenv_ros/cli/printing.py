"""Signs that a terminal's encoding lacks, as the nearest ones that it has."""

from __future__ import annotations

import codecs
import io
import unicodedata
from typing import TextIO

__all__ = ["make_printable"]

_HANDLER = "sailenv_nearest"

_NEAREST = {"×": "x", "–": "-", "—": "-", "…": "...", "·": "*", "→": "->", "≤": "<=", "≥": ">="}


def make_printable(*streams: TextIO) -> None:
    """Have streams print every text, whatever their encoding.

    What an encoding lacks is replaced by the nearest that ASCII has, else by "?"; names of files
    that are not valid in it are written as the bytes that they are.
    """
    codecs.register_error(_HANDLER, _nearest)
    for stream in streams:
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors=_HANDLER)


def _nearest(problem: UnicodeError) -> tuple[str | bytes, int]:
    if not isinstance(problem, UnicodeEncodeError):
        raise problem
    sign = problem.object[problem.start]
    if "\udc80" <= sign <= "\udcff":  # a byte that Python could not decode
        return bytes([ord(sign) - 0xDC00]), problem.start + 1
    plain = _NEAREST.get(sign) or unicodedata.normalize("NFKD", sign)
    return plain.encode("ascii", "ignore").decode() or "?", problem.start + 1
