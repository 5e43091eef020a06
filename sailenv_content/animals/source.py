"""The source of animals for the `AssetLibrary`: a name in, a cat or a dog out, kept for later."""

from __future__ import annotations

import re
import threading
from collections.abc import Mapping
from types import MappingProxyType

from sailenv_content.animals.looks import animals
from sailenv_ros.errors import UnknownName
from sailenv_ros.types.model import Asset

__all__ = ["AnimalSource"]

_NAME = re.compile(r"(cat|dog)_\d\d")

_made: dict[str, Asset] = {}
_lock = threading.Lock()


class AnimalSource:
    """Animals by their names, ``cat_01`` and ``dog_01``."""

    @property
    def display_names(self) -> Mapping[str, str]:
        """Nothing: who looks through a catalogue would have to make them all."""
        return MappingProxyType({})

    def speaks_of(self, name: str) -> bool:
        """Return whether a name is meant to be one of an animal."""
        return _NAME.fullmatch(name) is not None

    def problem(self, name: str) -> UnknownName | None:
        """Return why there is no animal of a name; None if there is one."""
        return None if name in animals() else UnknownName("animal", name, animals())

    def sibling(self, name: str, seed: int) -> str | None:
        """Return nothing: an animal is no other one."""
        return None

    def load(self, name: str) -> Asset:
        """Make an animal.

        Raises
        ------
        UnknownName
            If there is none of that name.
        """
        problem = self.problem(name)
        if problem is not None:
            raise problem
        from sailenv_content.animals.making import make_animal  # imports SciPy

        with _lock:
            if name not in _made:
                _made[name] = make_animal(name, animals()[name])
            return _made[name]
