"""Everything that assets come from on this machine: solids, families of pieces, packs."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Mapping, Sequence
from importlib import import_module
from types import MappingProxyType

from sailenv_ros.assets.asset_library import AssetSource
from sailenv_ros.assets.folders import pack_folders, standard_pack_folder
from sailenv_ros.assets.pack import BUILD_COMMAND, PACK_FILE, AssetPack
from sailenv_ros.assets.primitives import Primitives
from sailenv_ros.assets.recipe import standard_recipe
from sailenv_ros.errors import AssetError
from sailenv_ros.types.model import Asset

__all__ = ["BUILD_COMMAND", "UnbuiltPack", "installed_packs", "installed_sources"]

OPEN_SOURCES = (
    "sailenv_content.families.source:FamilySource",
    "sailenv_content.people.source:PeopleSource",
    "sailenv_content.animals.source:AnimalSource",
)
"""Sources that make what a name describes, as ``module:name``: content knows this package."""

_log = logging.getLogger(__name__)


class UnbuiltPack:
    """Objects of the standard pack that are not built yet; their names alone are known.

    Parameters
    ----------
    names : iterable of str or None
        Catalogue names; None means all of the pack.
    """

    def __init__(self, names: Iterable[str] | None = None) -> None:
        self._names = names if names is None else tuple(names)

    @property
    def display_names(self) -> Mapping[str, str]:
        """Display name of each catalogue name."""
        if self._names == ():
            return MappingProxyType({})  # to read the recipe takes a while
        recipe = standard_recipe()
        names = recipe.assets if self._names is None else self._names
        return MappingProxyType({name: recipe.display_name(name) for name in names})

    def load(self, name: str) -> Asset:
        """Return what is to be done.

        Raises
        ------
        AssetError
            Always.
        """
        raise AssetError(
            name, f"it has not been built on this machine yet; build it with: {BUILD_COMMAND}"
        )


def installed_packs() -> tuple[AssetPack, ...]:
    """Open every pack on this machine, the standard one first.

    One that cannot be opened is left out with a warning: it must not keep the others from use.
    """
    packs: list[AssetPack] = []
    names: set[str] = set()
    for folder in (standard_pack_folder(), *pack_folders()):
        if not (folder / PACK_FILE).is_file():
            continue
        try:
            pack = AssetPack(folder)
        except AssetError as problem:
            _log.warning("left out a pack: %s", problem)
            continue
        taken = names.intersection(pack.display_names)
        if taken:
            _log.warning("left out the pack %s: another has %s too", folder, min(taken))
            continue
        names.update(pack.display_names)
        packs.append(pack)
    return tuple(packs)


def installed_sources(packs: Sequence[AssetPack] | None = None) -> tuple[AssetSource, ...]:
    """Return all sources; the standard pack's names are there even where it has not been built.

    Parameters
    ----------
    packs : sequence of AssetPack or None
        What `installed_packs` gave; None opens them.
    """
    packs = installed_packs() if packs is None else packs
    built = [pack for pack in packs if pack.folder == standard_pack_folder()]
    unbuilt = UnbuiltPack(built[0].content.missing if built else None)
    return (Primitives(), unbuilt, *_open_sources(), *packs)


def _open_sources() -> tuple[AssetSource, ...]:
    named = (name.split(":") for name in OPEN_SOURCES)
    return tuple(getattr(import_module(module), name)() for module, name in named)
