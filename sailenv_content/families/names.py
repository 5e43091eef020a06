"""Names of pieces: ``FAMILY~STYLE:SEED``, and ``FAMILY~STYLE:SEED#PART`` of a door or drawer."""

from __future__ import annotations

import re
from dataclasses import dataclass

__all__ = ["FORM", "MAX_SEED", "PieceName", "has_form", "parsed"]

FORM = "FAMILY~STYLE:SEED"
MAX_SEED = 2**31 - 1

_MARK = "~"
_PART_MARK = "#"
"""Not that of parts of a model, which are no assets: a door is an object with parts of its own."""

_NAME = re.compile(r"([a-z][a-z0-9_]*)~([a-z][a-z0-9_]*):(0|[1-9][0-9]{0,9})(?:#(.+))?")


@dataclass(frozen=True, slots=True)
class PieceName:
    """A name in its parts; `part` is empty for the whole piece."""

    family: str
    style: str
    seed: int
    part: str = ""

    @property
    def whole(self) -> str:
        """The name of the piece that it is, or is a part of."""
        return f"{self.family}{_MARK}{self.style}:{self.seed}"

    def of_part(self, part: str) -> str:
        """Return the name of a part of the piece."""
        return f"{self.whole}{_PART_MARK}{part}"


def has_form(name: str) -> bool:
    """Return whether a name is meant to be one of a piece: no other asset's has the mark."""
    return _MARK in name


def parsed(name: str) -> PieceName | None:
    """Return a name in its parts; None if it is none of a piece."""
    found = _NAME.fullmatch(name)
    if found is None or int(found[3]) > MAX_SEED:
        return None
    return PieceName(found[1], found[2], int(found[3]), found[4] or "")
