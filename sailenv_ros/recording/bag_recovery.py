"""A bag with damaged or unfinished files → a whole one, and its `metadata.yaml` from its files.

What is intact of a file is restored by `mcap.recovery`; a damaged file is kept beside the new one.
"""

from __future__ import annotations

import os
from pathlib import Path

from sailenv_ros.errors import RecordingError
from sailenv_ros.recording.bag_metadata import FileSummary, write_metadata
from sailenv_ros.recording.mcap.file_index import FileIndex
from sailenv_ros.recording.mcap.recovery import Recovered, recover_file
from sailenv_ros.recording.reader import RecordingReader, files_of
from sailenv_ros.system.files import sync_folder

__all__ = ["is_whole", "recover", "restore_metadata"]

DAMAGED_SUFFIX = ".damaged"
"""Is added to the name of a file that was replaced by what was restored of it."""


def is_whole(path: Path) -> bool:
    """Return whether a file can be read as it is, each chunk of it included."""
    try:
        with RecordingReader(path) as reader:
            for _ in reader.messages():
                pass
    except RecordingError:
        return False
    return True


def recover(path: Path) -> list[Recovered]:
    """Restore a file, or each file of a bag folder that needs it, under its own name.

    Damaged files stay beside them with ``.damaged`` added to their names. `metadata.yaml` of the
    folder is written again.

    Returns
    -------
    recovered : list of Recovered
        Empty if everything was whole.

    Raises
    ------
    RecordingError
        If there is nothing to restore from, or the result cannot be written.
    """
    folder = path if path.is_dir() else path.parent
    done = [_recover_in_place(file) for file in _candidates(path) if not is_whole(file)]
    if path.is_dir() or (folder / f"{folder.resolve().name}_0.mcap").exists():
        restore_metadata(folder)
    return done


def restore_metadata(folder: Path) -> Path:
    """Write a bag folder's `metadata.yaml` from what its files hold.

    Raises
    ------
    RecordingError
        If a file of it is damaged.
    """
    files = []
    for path in _mcap_files(folder):
        index = FileIndex(path)
        times, names = index.entries["log_ns"], index.channels
        counts = {
            channel.topic: int((index.entries["channel"] == number).sum())
            for number, channel in names.items()
        }
        files.append(
            FileSummary(
                name=path.name,
                start_ns=int(times.min()) if len(times) else 0,
                end_ns=int(times.max()) if len(times) else 0,
                counts=counts,
            )
        )
        index.close()
    (folder / "metadata.yaml").unlink(missing_ok=True)
    with RecordingReader(folder) as reader:
        return write_metadata(folder, reader.topics, files)


def _candidates(path: Path) -> list[Path]:
    return _mcap_files(path) if path.is_dir() else files_of(path)


def _mcap_files(folder: Path) -> list[Path]:
    """Return the files that lie in a folder, whatever its metadata says."""
    named = {file: number for number, file in enumerate(files_of(folder))}
    found = sorted(folder.glob("*.mcap"))
    return sorted(found, key=lambda file: (named.get(file, len(named)), file.name))


def _put_in_place(draft: Path, path: Path, kept: Path) -> None:
    """Link the damaged file to its new name first: at every moment a file has the old name."""
    try:
        os.link(path, kept)
    except PermissionError:  # a file system without hard links
        os.rename(path, kept)
    os.replace(draft, path)
    sync_folder(path.parent)


def _recover_in_place(path: Path) -> Recovered:
    draft = path.with_name(f".{path.name}.recovering")
    draft.unlink(missing_ok=True)
    done = recover_file(path, draft)
    kept = path.with_name(path.name + DAMAGED_SUFFIX)
    number = 1
    while kept.exists():
        number += 1
        kept = path.with_name(f"{path.name}{DAMAGED_SUFFIX}{number}")
    try:
        _put_in_place(draft, path, kept)
    except OSError as problem:
        draft.unlink(missing_ok=True)
        raise RecordingError(f"{path} cannot be replaced: {problem.strerror}") from None
    return Recovered(
        path=path,
        kept=kept,
        messages=done.messages,
        lost_chunks=done.lost_chunks,
        unread_bytes=done.unread_bytes,
    )
