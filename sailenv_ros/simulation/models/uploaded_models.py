"""Models that users have added to the assets of a running simulator."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.own_pack import add_to_own_pack
from sailenv_ros.errors import InvalidState
from sailenv_ros.types.model import Asset

__all__ = ["UploadedModels"]

MAX_UPLOADS = 256
"""Models that users may add, so that they cannot fill the memory without end."""


class UploadedModels:
    """The uploads of one simulator's life.

    Parameters
    ----------
    assets : AssetLibrary
        Which they are added to.
    """

    def __init__(self, assets: AssetLibrary) -> None:
        self._assets = assets
        self._names: set[str] = set()
        self._unkept: set[str] = set()

    def __contains__(self, name: object) -> bool:
        """Return whether the asset of that name was uploaded."""
        return name in self._names

    def add(self, asset: Asset, *, rename: bool) -> str:
        """Add a user's asset to the catalogue; return its name there.

        Parameters
        ----------
        rename : bool
            True appends a number to a name that is in use.

        Raises
        ------
        NameTaken
            If the name is in use and is to be kept.
        InvalidState
            If there are `MAX_UPLOADS` already.
        """
        if len(self._names) >= MAX_UPLOADS:
            raise InvalidState(
                f"{MAX_UPLOADS} models have been uploaded, which is the most in a simulator's life"
            )
        taken = {*self._assets.all_names}
        names = ((asset.name, asset.display_name), *_numbered(asset)) if rename else ()
        for name, display_name in names:
            if not taken & {name, display_name}:
                asset = replace(asset, name=name, display_name=display_name)
                break
        self._assets.add(asset)
        self._names.add(asset.name)
        self._unkept.add(asset.name)
        return asset.name

    def is_unkept(self, name: str) -> bool:
        """Return whether a model lies in no pack, so that a scene file cannot name it."""
        return name in self._unkept

    def keep(self, name: str) -> None:
        """Put a model into the user's own pack, so that scene files can name it.

        Raises
        ------
        NameTaken, AssetError
            If the pack cannot take it.
        """
        add_to_own_pack(self._assets.get(name), source="uploaded to a running simulator")
        self._unkept.discard(name)


def _numbered(asset: Asset) -> Iterator[tuple[str, str]]:
    """Yield the asset's names with 2, 3, … at their end; more than there can be uploads."""
    for number in range(2, MAX_UPLOADS + 2):
        yield f"{asset.name}_{number}", f"{asset.display_name} {number}"
