"""A written export → disk, all of it or nothing."""

from __future__ import annotations

import os
from pathlib import Path

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.scene_export.contents import Written
from sailenv_ros.system.files import replaced_folder, storage_errors, written_file

__all__ = ["require_free", "save"]


def require_free(path: Path, beside: Path, *, overwrite: bool) -> None:
    """Refuse places that are taken.

    Parameters
    ----------
    path, beside : Path
        The file, and the folder beside it.

    Raises
    ------
    InvalidRequest
    """
    for what, place in (("file", path), ("folder of its meshes and pictures", beside)):
        if place.exists() and not overwrite:
            accepted = "one that does not exist, or to be overwritten"
            raise InvalidRequest(what, str(place), accepted)


def save(written: Written, path: Path, beside: Path) -> None:
    """Write a file and the folder beside it; what was there is replaced.

    Raises
    ------
    StorageError
        If they cannot be written; what was there is there.
    """
    with storage_errors("the export", path), written_file(path) as file:
        file.write(written.data)
        if written.beside:
            # The file is on the disk, and takes its place once the folder has.
            file.flush()
            os.fsync(file.fileno())
            with replaced_folder(beside) as draft:
                for name, data in written.beside.items():
                    (draft / name).write_bytes(data)
