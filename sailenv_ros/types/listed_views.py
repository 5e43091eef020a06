"""Names of views as callers may give them: several, or one."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias

__all__ = ["Views", "listed_views"]

Views: TypeAlias = str | Iterable[str]
"""Names of views, or the name of one."""


def listed_views(names: Views) -> tuple[str, ...]:
    """Return names of views, or the name of one, as a tuple; none is checked."""
    return (names,) if isinstance(names, str) else tuple(names)
