"""Light on and by what can move, as it was found where a baked scene began; for its next begin."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol, TypeAlias

from sailenv_ros.types.baked_light import ObjectLight

__all__ = ["MOST", "MOST_PLACES", "FoundLight", "FoundShadows", "KnownLight"]

MOST_PLACES = 3
"""Changes of what rests after which nothing is kept: a scene begins, what moves at first has no
shadow, and it comes to rest."""

MOST = 4
"""Number of shadows that are kept."""

Places: TypeAlias = tuple[object, ...]

KnownLight: TypeAlias = tuple[Places, ObjectLight]
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
    objects : dict of tuple to tuple of KnownLight
        Light on what rests, by instance id and number of the part: the first and the newest.
    shadows : dict of tuple to FoundShadows
        Shadows, which nobody changes, by the places of the objects that rested at first, and then
        after each change: it counts from where shadows were found.
    asked : set of tuple
        Places whose shadows were asked for again. Where `MOST` are kept, others go first, and of
        these the ones after most changes.
    """

    objects: dict[tuple[int, int], tuple[KnownLight, ...]] = field(default_factory=dict)
    shadows: dict[Places, FoundShadows] = field(default_factory=dict)
    asked: set[Places] = field(default_factory=set)

    def keep(self, places: Places, shadows: FoundShadows) -> None:
        """Keep shadows by places."""
        while len(self.shadows) >= MOST:
            others = [one for one in list(self.shadows) if one not in self.asked]
            dropped = max(others or list(self.shadows), key=len)
            self.shadows.pop(dropped, None)
            self.asked.discard(dropped)
        self.shadows[places] = shadows.copy()
