"""Files of recorded motion by their names: the user's own, and those of installed packages."""

from __future__ import annotations

import functools
import os
import re
from pathlib import Path

from sailenv_ros.assets.motions.bvh import read_bvh
from sailenv_ros.assets.motions.deep_mimic import read_deep_mimic
from sailenv_ros.assets.robots import is_of_package, robot_path
from sailenv_ros.errors import AssetError, AssetMissing
from sailenv_ros.system.files import storage_errors, write_file
from sailenv_ros.system.user_folders import data_folder
from sailenv_ros.types.motion_clip import MotionClip

__all__ = ["MOST_BYTES", "add_motion", "clip_names", "find_clip", "motion_folders", "read_clip"]

MOST_BYTES = 64 * 2**20

_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_ .-]{0,79}")
_KEPT = 16
"""Clips that are kept in memory."""


def motion_folders() -> tuple[Path, ...]:
    """Return the folders of motion: those of ``$SAILENV_MOTIONS``, then the user's own."""
    listed = os.environ.get("SAILENV_MOTIONS", "").split(os.pathsep)
    return (*(Path(folder).expanduser() for folder in listed if folder), _own_folder())


def clip_names() -> tuple[str, ...]:
    """Return the names of the clips in these folders."""
    found = {file.stem for folder in motion_folders() for file in folder.glob("*.bvh")}
    return tuple(sorted(found))


def find_clip(name: str) -> MotionClip:
    """Return a clip by its name.

    Parameters
    ----------
    name : str
        Of a file of one of the `motion_folders`, with or without ``.bvh``; or ``PACKAGE:path``, a
        file of an installed Python package such as
        ``pybullet_data:data/motions/humanoid3d_walk.txt``.

    Raises
    ------
    AssetError
        If there is none, or it cannot be read.
    """
    if is_of_package(name):
        return read_clip(robot_path(name))
    if not _NAME.fullmatch(name):
        accepted = "up to 80 letters, digits, spaces, '_', '-' and '.', without a folder"
        raise AssetError(name[:80], f"it is no name of a clip: {accepted}, are accepted")
    for folder in motion_folders():
        for file in (folder / name, folder / f"{name}.bvh"):
            if file.is_file() and file.resolve().is_relative_to(folder.resolve()):
                return read_clip(file)
    known = ", ".join(clip_names()[:12]) or "none"
    raise AssetMissing(
        name, f"there is no such clip; `sailenv assets add-motion` adds files; there are: {known}"
    )


def read_clip(path: Path) -> MotionClip:
    """Return the clip of a file; the same object while the file is the same.

    Raises
    ------
    AssetError
        If it is malformed or too large: 64 MB, 30,000 frames, 400 joints.
    """
    try:
        status = path.stat()
        if status.st_size > MOST_BYTES:
            raise AssetError(path.name, f"it is larger than {MOST_BYTES // 2**20} MB")
        return _read(path, status.st_mtime_ns, status.st_size)
    except OSError as problem:
        raise AssetError(path.name, f"it cannot be read ({problem.strerror})") from None


def add_motion(path: Path, name: str = "") -> tuple[str, MotionClip]:
    """Put a BVH file into the user's own folder; return its name there, and the clip.

    Raises
    ------
    AssetError
        If it cannot be read, or the name is none.
    StorageError
        If it cannot be written.
    """
    if path.suffix.lower() != ".bvh":
        raise AssetError(path.name, "its name must end in .bvh")
    clip = read_clip(path)
    name = name or path.stem
    if not _NAME.fullmatch(name):
        accepted = "up to 80 letters, digits, spaces, '_', '-' and '.' are accepted"
        raise AssetError(path.name, f"{name[:80]!r} is no name of a clip: {accepted}")
    folder = _own_folder()
    with storage_errors(f"clip {name!r}", folder):
        folder.mkdir(parents=True, exist_ok=True)
        write_file(folder / f"{name}.bvh", path.read_bytes())
    return name, clip


def _own_folder() -> Path:
    return data_folder() / "motions"


@functools.lru_cache(maxsize=_KEPT)
def _read(path: Path, mtime_ns: int, size: int) -> MotionClip:
    del mtime_ns, size  # of the file that was read
    reader = read_bvh if path.suffix.lower() == ".bvh" else read_deep_mimic
    return reader(path.name, path.read_bytes())
