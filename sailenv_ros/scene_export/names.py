"""Names that a format accepts, unique in their file."""

from __future__ import annotations

import re

__all__ = ["FreeNames", "identifier"]


def identifier(name: str) -> str:
    """Return a name of letters, digits and underscores that begins with no digit."""
    plain = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_") or "thing"
    return f"_{plain}" if plain[0].isdigit() else plain


class FreeNames:
    """Identifiers that are not taken yet, whether in upper or in lower case."""

    def __init__(self) -> None:
        self._taken: set[str] = set()

    def take(self, wanted: str) -> str:
        """Return an identifier like a name, with a number where another has it."""
        plain = identifier(wanted)
        found, number = plain, 2
        while found.lower() in self._taken:
            found, number = f"{plain}_{number}", number + 1
        self._taken.add(found.lower())
        return found
