"""Families by name, each with the module that makes it; none is imported before it is needed."""

from __future__ import annotations

from functools import cache, lru_cache
from importlib import import_module
from pathlib import Path

from sailenv_content.families.family import Family

__all__ = ["family_named", "family_names"]


@lru_cache(maxsize=1)
def family_names() -> tuple[str, ...]:
    """Return the names of all families: those of the modules in `kinds`."""
    folder = Path(__file__).parent / "kinds"
    return tuple(sorted(path.stem for path in folder.glob("[a-z]*.py")))


@cache
def family_named(name: str) -> Family:
    """Return a family by a name of `family_names`."""
    family: Family = import_module(f"sailenv_content.families.kinds.{name}").FAMILY
    return family
