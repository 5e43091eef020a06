"""The source of animals for the `AssetLibrary`: a name in, a cat or a dog out, kept for later."""

from __future__ import annotations

import re

from sailenv_content.animals.looks import animals
from sailenv_ros.assets.named_assets import NamedAssets
from sailenv_ros.errors import UnknownName
from sailenv_ros.types.model import Asset

__all__ = ["AnimalSource"]

_NAME = re.compile(r"(cat|dog)_\d\d")


class AnimalSource(NamedAssets):
    """Animals by their names, ``cat_01`` and ``dog_01``."""

    def speaks_of(self, name: str) -> bool:
        """Return whether a name is meant to be one of an animal."""
        return _NAME.fullmatch(name) is not None

    def problem(self, name: str) -> UnknownName | None:
        """Return why there is no animal of a name; None if there is one."""
        return None if name in animals() else UnknownName("animal", name, animals())

    def _make(self, name: str) -> Asset:
        from sailenv_content.animals.making import make_animal  # imports SciPy

        return make_animal(name, animals()[name])
