"""What a scene file's names may refer to; given to the loader by whoever knows it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

__all__ = ["SceneKnowledge"]


@dataclass(frozen=True, kw_only=True)
class SceneKnowledge:
    """Names of assets, categories and behaviours.

    Attributes
    ----------
    assets : iterable of str
        Every name that an object's `asset` may have.
    categories : iterable of str
        Names of the fixed table.
    behaviour_faults : callable
        ``behaviour_faults(type, parameters)`` yields what is wrong with a behaviour: the path
        inside it, and a sentence.
    """

    assets: tuple[str, ...]
    categories: tuple[str, ...]
    behaviour_faults: Callable[
        [str, Mapping[str, Any]], Iterable[tuple[tuple[str | int, ...], str]]
    ]
