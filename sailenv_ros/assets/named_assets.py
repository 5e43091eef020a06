"""Sources that make an asset of each of a few names, when it is asked for."""

from __future__ import annotations

import threading
from abc import ABC, abstractmethod
from collections import OrderedDict
from collections.abc import Mapping
from types import MappingProxyType
from typing import ClassVar

from sailenv_ros.errors import UnknownName
from sailenv_ros.types.model import Asset

__all__ = ["NamedAssets"]

MAX_KEPT = 64
"""Most assets that are kept; the one that was not asked for for longest is dropped first."""


class NamedAssets(ABC):
    """An `OpenSource` whose assets all instances of a class share."""

    _made: ClassVar[OrderedDict[str, Asset]]
    _lock: ClassVar[threading.Lock]

    def __init_subclass__(cls) -> None:
        cls._made, cls._lock = OrderedDict(), threading.Lock()

    @property
    def display_names(self) -> Mapping[str, str]:
        """Nothing: who looks through a catalogue would have to make them all."""
        return MappingProxyType({})

    @abstractmethod
    def problem(self, name: str) -> UnknownName | None:
        """Return why there is none of a name; None if there is one."""

    def sibling(self, name: str, seed: int) -> str | None:
        """Return nothing: no seed makes another of a kind."""
        return None

    def load(self, name: str) -> Asset:
        """Make the asset of a name.

        Raises
        ------
        UnknownName
            If there is none of that name.
        AssetError
            If it cannot be made.
        """
        problem = self.problem(name)
        if problem is not None:
            raise problem
        self._prepare(name)
        with self._lock:
            found = self._made.get(name)
            if found is None:
                found = self._made[name] = self._make(name)
                while len(self._made) > MAX_KEPT:
                    self._made.popitem(last=False)
            self._made.move_to_end(name)
            return found

    def _prepare(self, name: str) -> None:  # noqa: B027  # few need anything
        """Raise an AssetError if what they are made of is not here."""

    @abstractmethod
    def _make(self, name: str) -> Asset:
        """Make the asset of a name that there is."""
