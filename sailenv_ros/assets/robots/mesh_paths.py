"""Paths of the files that a robot's description names; only files of its own package are read."""

from __future__ import annotations

import os
import re
from pathlib import Path

from sailenv_ros.assets.archives import MAX_ARCHIVE_BYTES
from sailenv_ros.errors import AssetError, AssetMissing

__all__ = ["PACKAGE", "mesh_path", "package_path"]

HIGHEST = 6
"""Folders above a description among which its package is looked for."""

PACKAGE, FILE = "package://", "file://"


def mesh_path(named: str, description: Path, place: str = "") -> Path:
    """Return the file that a description names.

    Parameters
    ----------
    named : str
        A path from the description's folder, or ``package://NAME/path``.
    description : Path
        The file that names it.
    place : str
        Where that does so, for errors; its name without.

    Raises
    ------
    AssetError
        If it lies elsewhere, is missing or too large.
    """
    shown, place = f"mesh {named[:80]!r}", place or description.name
    if "\0" in named:
        raise AssetError(place, f"{shown} has a NUL in its path")
    homes = _homes(named, description.resolve().parent)
    for home, inside in homes:
        path = (home / inside).resolve()
        if path.is_relative_to(home) and path.is_file():
            if path.stat().st_size > MAX_ARCHIVE_BYTES:
                raise AssetError(path.name, f"it is larger than {MAX_ARCHIVE_BYTES // 2**20} MB")
            return path
    accepted = "a file beside the description or in the package that it names is accepted"
    raise AssetMissing(place, f"{shown} is not there; {accepted}")


def package_path(named: str) -> Path:
    """Return the file ``package://NAME/path`` of a package of ROS.

    Raises
    ------
    AssetMissing
        If it is in none that is installed.
    """
    package, _, inside = named.removeprefix(PACKAGE).partition("/")
    for home, name in _shares(package, inside) if re.fullmatch(r"[\w-]+", package) else ():
        path = (home / name).resolve() if "\0" not in name else home
        if path.is_relative_to(home) and path.is_file():
            return path
    raise AssetMissing(named[:200], f"no package {package[:80]!r} of ROS that is installed has it")


def _homes(named: str, folder: Path) -> list[tuple[Path, str]]:
    """Return the folders that may hold a file, each with its path there."""
    if not named.startswith(PACKAGE):
        return [(folder, named.removeprefix(FILE))]
    package, _, inside = named.removeprefix(PACKAGE).partition("/")
    # Some descriptions leave the package's name out: package://meshes/arm.obj.
    found = [(folder, f"{package}/{inside}")]
    if package in ("", ".", ".."):
        return found
    for above in (folder, *folder.parents[:HIGHEST]):
        if above.name == package:
            found.append((above, inside))
        if (above / package).is_dir():
            found.append((above / package, inside))
    return [*found, *_shares(package, inside)]


def _shares(package: str, inside: str) -> list[tuple[Path, str]]:
    prefixes = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    return [(Path(one).resolve() / "share" / package, inside) for one in prefixes if one]
