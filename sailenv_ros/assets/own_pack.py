"""The user's own pack: assets go in one by one, and replace those of the same name."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from sailenv_ros.assets.library import AssetLibrary
from sailenv_ros.assets.pack import PACK_FILE, AssetPack, PackContent, PackEntry
from sailenv_ros.assets.pack_writer import packed, write_content
from sailenv_ros.assets.places import own_pack_folder
from sailenv_ros.assets.sources import installed_sources
from sailenv_ros.errors import NameTaken
from sailenv_ros.model import Asset, ConvexShape

__all__ = ["add_to_own_pack"]


def add_to_own_pack(
    asset: Asset, *, author: str = "", licence: str = "", source: str = ""
) -> PackEntry:
    """Put an asset into the user's own pack; give its entry.

    Raises
    ------
    NameTaken
        If another pack has an asset of that name, or this one has its display name.
    AssetError
        If the pack that is there cannot be read.
    """
    folder = own_pack_folder()
    entries = dict(_entries(folder))
    entries.pop(asset.name, None)
    _check_names(asset, entries)
    folder.mkdir(parents=True, exist_ok=True)
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
        author=author,
        licence=licence,
        source=source,
    )
    content = PackContent(version=1, title="My own objects", assets=tuple(entries.values()))
    write_content(folder, content)
    return entries[asset.name]


def _entries(folder: Path) -> Mapping[str, PackEntry]:
    return AssetPack(folder).entries if (folder / PACK_FILE).is_file() else {}


def _check_names(asset: Asset, own: Mapping[str, PackEntry]) -> None:
    others = AssetLibrary(source for source in installed_sources() if not _is_own(source)).all_names
    taken = {*others, *own, *(entry.display_name for entry in own.values())}
    for name in (asset.name, asset.display_name):
        if name in taken:
            raise NameTaken("asset", name)


def _is_own(source: object) -> bool:
    return isinstance(source, AssetPack) and source.folder == own_pack_folder()
