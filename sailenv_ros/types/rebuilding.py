"""Copies and pickles of frozen data: made by the constructor, of the values of its fields.

Pickle forgets that an array is read-only and keeps what was cached; a constructor does neither.
"""

from __future__ import annotations

from dataclasses import fields
from typing import Any

__all__ = ["RebuiltByFields"]


class RebuiltByFields:
    """Base of dataclasses whose copies, also in other processes, are made by their constructor."""

    __slots__ = ()

    def field_values(self) -> dict[str, Any]:
        """Return the arguments of the constructor that make an equal object."""
        return {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]

    def __reduce__(self) -> Any:
        return _rebuilt, (type(self), self.field_values())


def _rebuilt(kind: Any, values: dict[str, Any]) -> Any:
    return kind(**values)
