"""Sources that make an asset of each of a few names, when it is asked for."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from functools import partial
from types import MappingProxyType
from typing import ClassVar

from sailenv_ros.assets.kept_assets import KeptAssets
from sailenv_ros.errors import UnknownName
from sailenv_ros.types.model import Asset

__all__ = ["NamedAssets"]


class NamedAssets(ABC):
    """An `OpenSource` whose assets all instances of a class share."""

    _made: ClassVar[KeptAssets[str, Asset]]

    def __init_subclass__(cls) -> None:
        cls._made = KeptAssets()

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
        return self._made.get(name, partial(self._make, name))

    def _prepare(self, name: str) -> None:  # noqa: B027  # few need anything
        """Raise an AssetError if what they are made of is not here."""

    @abstractmethod
    def _make(self, name: str) -> Asset:
        """Make the asset of a name that there is."""
