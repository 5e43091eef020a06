"""The user's folders, for what can be made again and for what cannot; how they are kept small."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

__all__ = ["cache_folder", "data_folder", "remove_oldest"]


def cache_folder() -> Path:
    """Return the folder for what can be made again: ``$SAILENV_CACHE``, else the user's cache."""
    given = os.environ.get("SAILENV_CACHE")
    if given:
        return Path(given).expanduser()
    return _base("XDG_CACHE_HOME", ".cache") / "sailenv_ros"


def data_folder() -> Path:
    """Return the folder for what the user made."""
    return _base("XDG_DATA_HOME", ".local/share") / "sailenv_ros"


def remove_oldest(
    files: Iterable[Path], *, most_bytes: float = math.inf, most_files: float = math.inf
) -> None:
    """Remove the files whose change is longest ago, beyond so many bytes or files.

    The newest remains, however large it is.
    """
    found = []
    for path in files:
        with suppress(OSError):
            status = path.stat()
            found.append((-status.st_mtime_ns, path, status.st_size))
    total = 0
    for number, (_, path, size) in enumerate(sorted(found)):
        total += size
        if number and (total > most_bytes or number >= most_files):
            with suppress(OSError):
                path.unlink(missing_ok=True)


def _base(variable: str, otherwise: str) -> Path:
    given = os.environ.get(variable, "")
    # The XDG specification wants relative paths ignored.
    return Path(given) if given.startswith("/") else Path.home() / otherwise
