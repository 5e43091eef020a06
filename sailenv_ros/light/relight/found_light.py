"""Light on and by what can move, as it was found where a baked scene began; for its next begin."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol, TypeAlias

from sailenv_ros.types.baked_light import ObjectLight

__all__ = ["MOST", "FoundLight", "FoundShadows", "KnownLight"]

MOST = 3
"""Number of shadows that are kept: a scene begins, and what was put into it comes to rest."""

KnownLight: TypeAlias = tuple[tuple[object, ...], ObjectLight]
"""Light on an object, after all that it depends on."""


class FoundShadows(Protocol):
    """Shadows, see `ObjectShadows`."""

    def copy(self) -> FoundShadows:
        """Return the same, which change apart from these."""


@dataclass(eq=False, slots=True)
class FoundLight:
    """Light in one scene as it was baked. Each entry follows from its key and the scene alone.

    Attributes
    ----------
    objects : dict of int to KnownLight
        Light on objects, by instance id.
    shadows : dict of tuple to FoundShadows
        Shadows, which nobody changes, by the places of the objects that rested at first, and then
        after each change: it counts from where shadows were found. The last `MOST` are kept.
    """

    objects: dict[int, KnownLight] = field(default_factory=dict)
    shadows: dict[tuple[object, ...], FoundShadows] = field(default_factory=dict)

    def keep(self, places: tuple[object, ...], shadows: FoundShadows) -> None:
        """Keep shadows by places."""
        for oldest in list(self.shadows)[: len(self.shadows) + 1 - MOST]:
            self.shadows.pop(oldest, None)
        self.shadows[places] = shadows.copy()
