"""Paths of the packs on this machine; nothing is read here."""

from __future__ import annotations

import os
from pathlib import Path

from sailenv_ros.system.user_folders import cache_folder, data_folder

__all__ = ["cache_folder", "own_pack_folder", "pack_folders", "standard_pack_folder"]


def standard_pack_folder() -> Path:
    """Return the folder that `sailenv assets build` fills."""
    return cache_folder() / "packs" / "standard"


def own_pack_folder() -> Path:
    """Return the user's own pack, which `sailenv assets add` adds to."""
    return _user_packs() / "own"


def pack_folders() -> tuple[Path, ...]:
    """Return the folders of the user's packs that exist: in ``$SAILENV_PACKS``, then in their home.

    ``$SAILENV_PACKS`` lists folders of packs, separated as in ``$PATH``.
    """
    listed = [
        Path(p).expanduser() for p in os.environ.get("SAILENV_PACKS", "").split(os.pathsep) if p
    ]
    home = _user_packs()
    found = sorted(home.iterdir()) if home.is_dir() else []
    return tuple(folder for folder in (*listed, *found) if folder.is_dir())


def _user_packs() -> Path:
    return data_folder() / "packs"
