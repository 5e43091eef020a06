"""Families by name, each with the module that makes it; none is imported before it is needed."""

from __future__ import annotations

from functools import cache, lru_cache
from importlib import import_module
from pathlib import Path

import numpy as np

from sailenv_content.families.family import Family
from sailenv_ros.system.array_cache import cached_arrays, code_digest

__all__ = ["CODE", "family_named", "family_names", "family_styles", "making_code"]

CODE = (
    *(f"../sailenv_content/{folder}" for folder in ("families", "families/kinds")),
    *(f"../sailenv_content/{folder}" for folder in ("procedural", "standard")),
    *("assets", "types"),
)
"""Folders of the modules that the making of a piece goes through."""


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


@cache
def family_styles(name: str) -> tuple[str, ...]:
    """Return the styles of a family of `family_names`, which is not imported if they are kept."""
    kept = cached_arrays(
        "styles",
        [name],
        lambda: {"styles": np.array(list(family_named(name).styles))},
        code=making_code(),
    )
    return tuple(kept["styles"].tolist())


def making_code() -> str:
    """Return what changes with the code that makes pieces; see `code_digest`."""
    return code_digest(*CODE, libraries=("scipy",))
