"""Arrays and texts → files of a data set, with errors that name the file."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any, BinaryIO

from numpy.typing import NDArray

from sailenv_ros.errors import RecordingError, WriteFailed
from sailenv_ros.pictures.codecs import encode_png
from sailenv_ros.system.files import make_folder as make_folder_of_files
from sailenv_ros.system.files import sync_file_system, write_file, written_file

__all__ = [
    "discard_drafts",
    "finish",
    "make_folder",
    "open_draft",
    "write_bytes",
    "write_errors",
    "write_json",
    "write_png",
]


def make_folder(folder: Path) -> None:
    """Make the folder of a data set, which must not exist or be empty.

    Raises
    ------
    RecordingError
        If something is in it, or it cannot be made.
    """
    try:
        make_folder_of_files(folder)
        filled = any(folder.iterdir())
    except (OSError, ValueError) as problem:  # a NUL in the name is no OSError
        why = getattr(problem, "strerror", None) or str(problem)
        raise RecordingError(f"{str(folder)!r} cannot be made: {why}") from None
    if filled:
        raise RecordingError(f"{folder} is not empty; nothing is overwritten, choose another")


@contextlib.contextmanager
def write_errors(path: Path) -> Iterator[None]:
    """Turn an `OSError` of the block into a `WriteFailed` that names what was being written."""
    try:
        yield
    except OSError as problem:
        raise WriteFailed(path, problem) from None


def write_bytes(path: Path, data: bytes) -> None:
    """Write a file, whole or not at all, and the folder that it is in.

    `finish` brings it to the disk.

    Raises
    ------
    RecordingError
        If it cannot be written.
    """
    with write_errors(path):
        make_folder_of_files(path.parent)
        write_file(path, data, durable=False)


def finish(folder: Path) -> None:
    """Bring all files of a data set to the disk.

    Raises
    ------
    RecordingError
        If the disk refuses it.
    """
    with write_errors(folder):
        sync_file_system(folder)


def open_draft(drafts: ExitStack, path: Path) -> BinaryIO:
    """Open a file of a data set, which takes its place when `drafts` is closed well.

    Its folder is made. `discard_drafts` gives all of them up.

    Raises
    ------
    RecordingError
        If it cannot be written.
    """
    with write_errors(path):
        make_folder_of_files(path.parent)
        return drafts.enter_context(written_file(path, durable=False))


class _BrokenOff(Exception):
    pass


def discard_drafts(drafts: ExitStack) -> None:
    """Close files that `open_draft` opened so that they do not take their places."""
    with contextlib.suppress(_BrokenOff), drafts:
        raise _BrokenOff


def write_json(path: Path, value: Any) -> None:
    """Write a value as JSON.

    An iterator in it, or in a mapping in it, becomes a list that is never in memory as a whole.

    Raises
    ------
    RecordingError
        If it cannot be written.
    """
    drafts = ExitStack()
    file = open_draft(drafts, path)
    try:
        with write_errors(path):
            for piece in json_pieces(value):
                file.write(piece.encode())
            file.write(b"\n")
            drafts.close()
    finally:
        discard_drafts(drafts)


def json_pieces(value: Any) -> Iterator[str]:
    """Yield what `json.dumps` with an indent of 1 makes of a value, iterators being lists."""
    if isinstance(value, Mapping) and value:
        opening = "{\n "
        for name, one in value.items():
            yield f"{opening}{json.dumps(str(name))}: "
            opening = ",\n "
            yield from map(_indented, json_pieces(one))
        yield "\n}"
    elif isinstance(value, Iterator):
        empty = True
        for one in value:
            yield "[\n " if empty else ",\n "
            yield _indented(json.dumps(one, indent=1))
            empty = False
        yield "[]" if empty else "\n]"
    else:
        yield json.dumps(value, indent=1)


def _indented(text: str) -> str:
    return text.replace("\n", "\n ")


def write_png(path: Path, picture: NDArray[Any]) -> None:
    """Write a picture of one channel, or of red, green and blue.

    Parameters
    ----------
    path : Path
    picture : (H, W) or (H, W, 3) uint8, uint16 or bool
        Truth values become 0 and 255.
    """
    write_bytes(path, encode_png(picture, "small"))
