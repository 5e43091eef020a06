"""Results of the importers: models, and the entries of a scene that places them.

Plain data; `writing` makes a pack and a scene file of it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any

from sailenv_ros.errors import AssetError
from sailenv_ros.types.model import ConvexShape, ModelPart

__all__ = ["ImportedAsset", "ImportedScene", "Names"]

Entry = dict[str, Any]

MOST_OBJECTS = 5000


@dataclass(frozen=True, eq=False, kw_only=True)
class ImportedAsset:
    """A model for the pack.

    Attributes
    ----------
    name, display_name, category : str
    parts : tuple of ModelPart
        In the body frame: x forward, y left, z up.
    hulls : tuple of ConvexShape
        What it collides as; none: nothing collides with it.
    mass_kg : float
    author, licence, source : str
    """

    name: str
    display_name: str
    category: str
    parts: tuple[ModelPart, ...]
    hulls: tuple[ConvexShape, ...]
    mass_kg: float = 10.0
    author: str = ""
    licence: str = ""
    source: str = ""


@dataclass(eq=False, kw_only=True)
class ImportedScene:
    """A scene for a file, by the keys of scene files.

    Attributes
    ----------
    title, description : str
    assets : list of ImportedAsset
    objects, lights, agents : list of dict
    environment, mover : dict
    notes : list of str
        What was left out or changed, in a sentence each.
    """

    title: str
    description: str = ""
    assets: list[ImportedAsset] = field(default_factory=list)
    objects: list[Entry] = field(default_factory=list)
    lights: list[Entry] = field(default_factory=list)
    agents: list[Entry] = field(default_factory=list)
    environment: Entry = field(default_factory=dict)
    mover: Entry = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def add_object(self, entry: Entry) -> None:
        """Add an object.

        Raises
        ------
        AssetError
            If there are too many.
        """
        if len(self.objects) >= MOST_OBJECTS:
            raise AssetError(self.title, f"it has more than {MOST_OBJECTS} objects")
        self.objects.append(entry)


class Names:
    """Names that are not taken yet.

    Parameters
    ----------
    prefix : str
        Of the names of assets, so that two imported scenes do not share any.
    """

    def __init__(self, prefix: str) -> None:
        self._prefix = re.sub(r"[^a-z0-9]+", "_", prefix.lower()).strip("_")[:20] or "scene"
        if not self._prefix[0].isalpha():
            self._prefix = f"s{self._prefix}"
        self._taken: set[str] = set()

    def of_asset(self, wanted: str) -> str:
        """Return a catalogue name."""
        plain = re.sub(r"[^a-z0-9]+", "_", wanted.lower()).strip("_")[:30] or "thing"
        return self._free(f"{self._prefix}_{plain}", "_")

    def of_object(self, wanted: str) -> str:
        """Return a name for people, as scene files have them."""
        plain = re.sub(r"[^\w .()&-]+", " ", wanted, flags=re.ASCII)
        plain = " ".join(plain.split())[:40].strip(" .-") or "object"
        return self._free(plain, " ")

    def _free(self, name: str, between: str) -> str:
        found, number = name, 2
        while found.lower() in self._taken:
            found, number = f"{name}{between}{number}", number + 1
        self._taken.add(found.lower())
        return found
