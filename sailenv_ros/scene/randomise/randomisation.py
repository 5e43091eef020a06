"""The base of everything that can be drawn at random, and the values that come of it.

A thing says in the words of a scene file what becomes of what it is about; it knows no simulation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar, Literal, TypeAlias

from pydantic import Field

from sailenv_ros.scene.field_types import Choice
from sailenv_ros.scene.fields import Name, SceneModel
from sailenv_ros.scene.randomise.drawn import Draw
from sailenv_ros.scene.randomise.selectors import Selector, is_meant

__all__ = [
    "EVERY",
    "MOST_ADDED",
    "Pick",
    "RandomTargets",
    "Randomisation",
    "EpochRandomisation",
    "Values",
]

Values: TypeAlias = dict[str, Any]
"""Drawn values as plain data: ``objects``, ``materials``, ``lights``, ``agents`` and ``behaviours``
by name, ``environment`` by its keys, ``added`` a list of objects. ``relative`` holds in the same
order the amounts by which values differ from the scene's own."""

Pick: TypeAlias = Callable[[str, str, Draw], Any]
"""``pick(target, key, draw)`` returns a value; each target and key has a generator of its own."""

EVERY = ("epoch", "frame")

MOST_ADDED = 200
"""How many objects one entry may bring; each is named by the entry and its number, from 1."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomTargets:
    """Targets of randomisation, by name.

    Attributes
    ----------
    objects, surfaces, agents : tuple of str
        Objects, parts of the room, cameras.
    lights : mapping of str to (3,) tuple of float
        Where each light is [m].
    categories : mapping of str to str
        Of objects and parts of the room, by their names.
    own : mapping
        The scene's own values, which others are drawn relative to: by the keys of `Values`, by
        names and by the keys of a file.
    """

    objects: tuple[str, ...] = ()
    surfaces: tuple[str, ...] = ()
    agents: tuple[str, ...] = ()
    lights: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    categories: Mapping[str, str] = field(default_factory=dict)
    own: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    def with_categories(self, names: Iterable[str]) -> dict[str, str]:
        """Return the category of each name; empty where it is not known."""
        return {name: self.categories.get(name, "") for name in names}

    def own_value(self, kind: str, name: str, key: str) -> Any:
        """Return the scene's own value of a key; of what has no names, `name` is empty."""
        named = self.own.get(kind, {})
        return (named.get(name, {}) if name else named).get(key)


class Randomisation(SceneModel):
    """Base of every entry of `randomise`."""

    KEY: ClassVar[str] = ""
    """The key of `Values` that it fills."""

    name: Name = Field(
        description="unique; the values depend on it and the seed, not on other entries"
    )
    every: Annotated[Literal["epoch", "frame"], Choice(EVERY)] = Field(
        default="epoch",
        description="`epoch`: when the scene begins; `frame`: at each instant",
    )

    def values(self, targets: RandomTargets, pick: Pick) -> Values:
        """Return what is drawn for all its targets."""
        raise NotImplementedError

    def may_add(self) -> tuple[str, ...]:
        """Return the names of the assets that may come to the scene by it."""
        return ()

    def draws(self, *besides: str) -> dict[str, Draw]:
        """Return what is to be drawn, by its keys."""
        given = {key: getattr(self, key) for key in type(self).model_fields if key not in besides}
        return {key: value for key, value in given.items() if isinstance(value, Draw)}

    def drawn(
        self,
        which: Iterable[Selector],
        names: Mapping[str, str] | Iterable[str],
        pick: Pick,
        *besides: str,
    ) -> dict[str, dict[str, Any]]:
        """Return what is drawn, by its keys, for the names that are meant.

        Names may be given with their categories.
        """
        draws, selectors = self.draws(*besides), tuple(which)
        of = names if isinstance(names, Mapping) else dict.fromkeys(names, "")
        meant = [n for n, kind in of.items() if any(is_meant(one, n, kind) for one in selectors)]
        return {name: {key: pick(name, key, draw) for key, draw in draws.items()} for name in meant}


class EpochRandomisation(Randomisation):
    """A thing that physics knows: it is drawn when the scene begins, and stays."""

    every: Annotated[Literal["epoch"], Choice(("epoch",))] = Field(
        default="epoch", description="when the scene begins: what physics knows stays until then"
    )
