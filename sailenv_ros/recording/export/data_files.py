"""Arrays and texts → files of a data set, with errors that name the file."""

from __future__ import annotations

import contextlib
import json
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest, RecordingError
from sailenv_ros.system.files import make_folder as make_folder_of_files
from sailenv_ros.system.files import sync_file_system, write_file

__all__ = [
    "discard_drafts",
    "finish",
    "make_folder",
    "png_bytes",
    "write_bytes",
    "write_json",
    "write_png",
]

_COMPRESSION = [cv2.IMWRITE_PNG_COMPRESSION, 3]
_FASTEST = [cv2.IMWRITE_PNG_COMPRESSION, 1]


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


def write_bytes(path: Path, data: bytes) -> None:
    """Write a file, whole or not at all, and the folder that it is in.

    `finish` brings it to the disk.

    Raises
    ------
    RecordingError
        If it cannot be written.
    """
    try:
        make_folder_of_files(path.parent)
        write_file(path, data, durable=False)
    except OSError as problem:
        raise RecordingError(f"{path} cannot be written: {problem.strerror}") from None


def finish(folder: Path) -> None:
    """Bring all files of a data set to the disk.

    Raises
    ------
    RecordingError
        If the disk refuses it.
    """
    try:
        sync_file_system(folder)
    except OSError as problem:
        raise RecordingError(f"{folder} cannot be written: {problem.strerror}") from None


class _BrokenOff(Exception):
    pass


def discard_drafts(drafts: ExitStack) -> None:
    """Close files that `written_file` opened so that they do not take their places."""
    with contextlib.suppress(_BrokenOff), drafts:
        raise _BrokenOff


def write_json(path: Path, value: Any) -> None:
    """Write a value as JSON."""
    write_bytes(path, (json.dumps(value, indent=1) + "\n").encode())


def write_png(path: Path, picture: NDArray[Any]) -> None:
    """Write a picture of one channel, or of red, green and blue, 8 or 16 bits deep."""
    write_bytes(path, _encoded(picture, _COMPRESSION))


def png_bytes(picture: NDArray[Any]) -> bytes:
    """Return the PNG of a picture as `write_png` takes it, made fast rather than small."""
    return _encoded(picture, _FASTEST)


def _encoded(picture: NDArray[Any], options: list[int]) -> bytes:
    if picture.dtype not in (np.uint8, np.uint16):
        raise InvalidRequest("picture", str(picture.dtype), "8 or 16 bits deep")
    ordered = picture if picture.ndim == 2 else np.ascontiguousarray(picture[..., ::-1])
    _, data = cv2.imencode(".png", ordered, options)
    return bytes(data)
