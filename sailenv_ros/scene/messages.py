"""Parts of error messages: what a user wrote, and the nearest name that exists.

Takes values and names, gives pieces of sentences. Knows no pydantic, no YAML, no scene.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable

__all__ = ["nearest", "shown", "suggestion"]

_MAX_SHOWN = 60
_MAX_LISTED = 10


def shown(value: object) -> str:
    """Show a value of a scene file on one short line, in the file's own words."""
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return f"a mapping with {', '.join(map(str, value))[:_MAX_SHOWN]}" if value else "{}"
    if isinstance(value, list | tuple):
        return _shortened("[" + ", ".join(shown(entry) for entry in value[:8]) + "]")
    return _shortened(" ".join(repr(value).split()))


def nearest(name: str, known: Iterable[str]) -> str | None:
    """Find the known name that is spelt most alike; ``None`` if none is near."""
    by_folded: dict[str, str] = {}
    for entry in known:
        by_folded.setdefault(entry.casefold(), entry)
    near = difflib.get_close_matches(name.casefold()[:200], by_folded, n=1, cutoff=0.6)
    return by_folded[near[0]] if near else None


def suggestion(name: str, known: Iterable[str], *, listing: str = "known") -> str:
    """Return a sentence: which known name was meant, or what is known.

    Parameters
    ----------
    name : str
        The unknown name.
    known : iterable of str
    listing : str
        The words before the list.
    """
    names = list(known)
    near = nearest(name, names)
    if near is not None:
        return f"did you mean {near!r}?"
    if not names:
        return "there is none to choose from"
    more = f" and {len(names) - _MAX_LISTED} more" if len(names) > _MAX_LISTED else ""
    return f"{listing}: {', '.join(names[:_MAX_LISTED])}{more}"


def _shortened(text: str) -> str:
    return text if len(text) <= _MAX_SHOWN else text[: _MAX_SHOWN - 3] + "..."
