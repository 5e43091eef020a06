"""Scenes made on this machine: their folder, and writing into it and nowhere else.

A name and a text in, a file out. Knows no scene's content.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

from sailenv_ros.errors import DeadlineExceeded, InvalidRequest
from sailenv_ros.system.files import file_lock, make_folder, remove_unfinished, write_file

__all__ = ["SCENE_NAME", "checked_scene_name", "user_scene_folder", "write_scene"]

SCENE_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9 _-]{0,61}[A-Za-z0-9_-]|[A-Za-z0-9]")
"""Names of scene files: no separators of folders, nothing hidden, no ending."""

ACCEPTED = "letters, digits, spaces, '_' or '-', at most 63, without .yaml"


def user_scene_folder() -> Path:
    """Return the folder of the user's scenes: ``$SAILENV_SCENES``, else in the user's data."""
    given = os.environ.get("SAILENV_SCENES")
    if given:
        return Path(given).expanduser()
    data = os.environ.get("XDG_DATA_HOME", "")
    # The XDG specification wants relative paths ignored.
    base = Path(data) if data.startswith("/") else Path.home() / ".local" / "share"
    return base / "sailenv_ros" / "scenes"


def write_scene(folder: Path, name: str, text: str, *, overwrite: bool) -> Path:
    """Write a scene file, all of it or nothing; return its path.

    Parameters
    ----------
    folder : Path
        Made if it is not there.
    name : str
        Of the file without its ending; see `SCENE_NAME`.
    overwrite : bool
        False refuses a name that is in use; where two want it at once, one is refused.

    Raises
    ------
    InvalidRequest
        If the name cannot be a scene's or is in use, or nothing can be written there.
    DeadlineExceeded
        If another process kept writing there.
    """
    path = folder / f"{checked_scene_name(name)}.yaml"
    try:
        make_folder(folder)
        with file_lock(folder / ".lock", f"the folder of scenes {folder}"):
            remove_unfinished(folder)
            write_file(path, text.encode(), overwrite=overwrite)
    except DeadlineExceeded:
        raise
    except FileExistsError:
        accepted = "one that no file has yet, unless it shall be overwritten"
        raise InvalidRequest("scene name", name, accepted) from None
    except OSError as problem:
        accepted = f"one that can be written in {folder} ({problem.strerror})"
        raise InvalidRequest("scene name", name, accepted) from None
    return path


def checked_scene_name(name: object) -> str:
    """Return the name, or raise `InvalidRequest`."""
    if not isinstance(name, str) or not SCENE_NAME.fullmatch(name):
        raise InvalidRequest("scene name", name, ACCEPTED)
    return name
