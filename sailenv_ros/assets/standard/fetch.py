"""Fetching what the standard pack is made from: two of Debian's packages, without being root.

They are taken from where they are installed, else downloaded once with apt and unpacked in the
user's cache.
"""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path

from sailenv_ros.assets.places import cache_folder
from sailenv_ros.errors import AssetError

__all__ = ["SOURCES", "fetched"]

SOURCES = {
    "sweethome3d-furniture": "usr/share/sweethome3d/furniture",
    "blender-data": "usr/share/blender/datafiles/studiolights/world",
}
"""The folder that is wanted of each package."""

DOWNLOAD_TIMEOUT_S = 900.0


def fetched(package: str, *, say: Callable[[str], None] = lambda _: None) -> Path:
    """Give the folder with a package's files, fetched if need be.

    Parameters
    ----------
    package : str
        One of `SOURCES`.
    say : callable
        Is told what takes long.

    Raises
    ------
    AssetError
        If it is neither here nor to be had; says what to do.
    """
    wanted = SOURCES[package]
    kept = cache_folder() / "sources" / package
    for root in (kept, Path("/")):
        if _is_there(root / wanted):
            return root / wanted
    say(f"downloading {package} from Debian")
    kept.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=kept.parent, prefix=f"{package}-") as scratch:
        unpacked = _unpacked(package, Path(scratch))
        if not _is_there(unpacked / wanted):
            raise AssetError(package, f"the package holds no {wanted}")
        shutil.rmtree(kept, ignore_errors=True)
        unpacked.rename(kept)
    return kept / wanted


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
            command,
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


def _remedy(package: str) -> str:
    place = cache_folder() / "sources" / package
    return (
        f"install Debian's or Ubuntu's package {package} (on apt machines after: apt-get update), "
        f"or unpack its .deb file into {place}"
    )
