"""The packs that are installed now: their assets, skies and categories."""

from __future__ import annotations

from pathlib import Path

from sailenv_ros.assets.asset_library import AssetSource
from sailenv_ros.assets.categories import load_categories
from sailenv_ros.assets.folders import standard_pack_folder
from sailenv_ros.assets.pack import PACK_FILE
from sailenv_ros.assets.skies import sky_files
from sailenv_ros.assets.sources import installed_packs, installed_sources
from sailenv_ros.types.labels import CategoryTable

__all__ = ["OpenPacks"]


class OpenPacks:
    """Packs that are installed as this is made.

    Attributes
    ----------
    skies : mapping of str to Path
        Pictures of skies by their names.
    """

    def __init__(self) -> None:
        self._version = _standard_pack_version()
        self._packs = installed_packs()
        self.skies = sky_files(pack.folder for pack in self._packs)

    @property
    def are_newest(self) -> bool:
        """False once the standard pack has been built again."""
        return self._version == _standard_pack_version()

    @property
    def files(self) -> tuple[Path, ...]:
        """The packs' own descriptions."""
        return tuple(pack.folder / PACK_FILE for pack in self._packs)

    def sources(self) -> tuple[AssetSource, ...]:
        """Return where assets come from."""
        return installed_sources(self._packs)

    def categories(self) -> CategoryTable:
        """Return the fixed table, and what the packs add to it."""
        added = [entry.to_category() for pack in self._packs for entry in pack.content.categories]
        return CategoryTable([*load_categories().values(), *added])


def _standard_pack_version() -> tuple[int, int]:
    """Return what changes when the standard pack is built; zeros where there is none."""
    try:
        status = (standard_pack_folder() / PACK_FILE).stat()
    except OSError:
        return 0, 0
    return status.st_mtime_ns, status.st_ino
