"""The user's own pack: assets go in one by one, and replace those of the same name.

One writer at a time, and `pack.yaml` is written last: it names whole files at every moment.
"""

from __future__ import annotations

import re
import time
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.folders import own_pack_folder
from sailenv_ros.assets.pack import PACK_FILE, AssetPack, PackContent, PackEntry
from sailenv_ros.assets.pack_writer import packed, write_content
from sailenv_ros.assets.sources import installed_sources
from sailenv_ros.errors import NameTaken
from sailenv_ros.system.files import file_lock, remove_unfinished, storage_errors
from sailenv_ros.types.model import Asset, ConvexShape

__all__ = ["add_to_own_pack"]

LOCK_FILE = ".lock"

KEPT_S = 86400.0
"""Age at which a model that was replaced is removed [s]."""

_OURS = re.compile(r"\.[0-9a-f]{16}\.glb$")


def add_to_own_pack(
    asset: Asset, *, author: str = "", licence: str = "", source: str = ""
) -> PackEntry:
    """Put an asset into the user's own pack; return its entry.

    Raises
    ------
    NameTaken
        If another pack has an asset of that name, or this one has its display name.
    AssetError
        If the pack that is there cannot be read.
    StorageError
        If the pack cannot be written; it is as it was then.
    DeadlineExceeded
        If another process kept writing to it.
    """
    folder = own_pack_folder()
    with (
        storage_errors(f"asset {asset.name!r}", folder),
        file_lock(folder / LOCK_FILE, "the pack of your own objects"),
    ):
        content = _content(folder)
        entries = {entry.name: entry for entry in content.assets}
        entries.pop(asset.name, None)
        _check_names(asset, entries)
        entries[asset.name] = packed(
            folder,
            asset.name,
            asset.model.parts,
            [shape for shape in asset.collision if isinstance(shape, ConvexShape)],
            display_name=asset.display_name,
            category=asset.category,
            mass=asset.mass_kg,
            collision="hulls",
            tags=asset.tags,
            labelled=asset.parts,
            author=author,
            licence=licence,
            source=source,
            unique_file=True,
        )
        write_content(folder, content.model_copy(update={"assets": tuple(entries.values())}))
        _remove_old(folder, entries)
    return entries[asset.name]


def _remove_old(folder: Path, entries: Mapping[str, PackEntry]) -> None:
    """Remove models that no entry names any more, and what killed writers left."""
    named = {entry.file for entry in entries.values()}
    for file in folder.glob("*.glb"):
        if _OURS.search(file.name) and file.name not in named:
            with suppress(OSError):
                # A simulator that runs may not have read it yet.
                if time.time() - file.stat().st_mtime > KEPT_S:
                    file.unlink()
    remove_unfinished(folder)


def _content(folder: Path) -> PackContent:
    if (folder / PACK_FILE).is_file():
        return AssetPack(folder).content
    return PackContent(version=1, title="My own objects")


def _check_names(asset: Asset, own: Mapping[str, PackEntry]) -> None:
    others = AssetLibrary(source for source in installed_sources() if not _is_own(source)).all_names
    taken = {*others, *own, *(entry.display_name for entry in own.values())}
    for name in (asset.name, asset.display_name):
        if name in taken:
            raise NameTaken("asset", name)


def _is_own(source: object) -> bool:
    return isinstance(source, AssetPack) and source.folder == own_pack_folder()
